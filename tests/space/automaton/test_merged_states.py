"""Merging states up to renaming changes no count, no word, no rank and no draw."""

from __future__ import annotations

import random
from functools import cache
from itertools import islice

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from prag_asp import TaskSpace, load_domain
from prag_asp.logic.domain_logic import DomainLogic
from prag_asp.space.engines import LEVELS, Level
from prag_asp.space.engines.automaton_engine import AutomatonEngine
from prag_asp.space.engines.reachability import equal_groups
from prag_asp.space.weights.weights import Weights, parse_weights
from tests.chance import Chance, examples
from tests.domains import domain_of
from tests.orbits.units import draw_units
from tests.spaces import draws_of
from tests.strategies import symmetric_texts

SHOWN, UNITS = 300, 24
"""Words that are compared, and how many domains are drawn whose entities belong to each other."""


@cache
def shipped(name: str) -> DomainLogic:
    return DomainLogic(load_domain(name))


def states_of(engine: AutomatonEngine, length: int) -> int:
    return engine.explored(length).completions.automaton.states


def check_that_merging_changes_nothing(
    model: DomainLogic, level: Level, length: int, seed: int, weights: Weights
) -> None:
    plain, merged = (AutomatonEngine(model, level, merge=merge) for merge in (False, True))
    assert [merged.count(k) for k in range(length + 1)] == [plain.count(k) for k in range(length + 1)]
    assert states_of(merged, length) <= states_of(plain, length) or level == "skeleton"
    assert list(islice(merged.words(length), SHOWN)) == list(islice(plain.words(length), SHOWN))
    total, generator = plain.count(length), random.Random(seed)
    for _ in range(8 if total else 0):
        rank = generator.randrange(total)
        word = plain.unrank(length, rank)
        assert merged.unrank(length, rank) == word
        assert merged.rank(word) == rank and merged.contains(word)
        other = list(word)
        other[generator.randrange(length)] = generator.choice(plain.letters)
        assert merged.contains(tuple(other)) == plain.contains(tuple(other))
        assert merged.rank(tuple(other)) == plain.rank(tuple(other))
        mixed = tuple(a.partition("(")[0] if generator.random() < 0.5 else a for a in word[: generator.randrange(4)])
        assert merged.count(length, mixed) == plain.count(length, mixed) > 0
        assert list(islice(merged.words(length, mixed), 20)) == list(islice(plain.words(length, mixed), 20))
    if total and level != "skeleton":
        for weighed in (Weights(), weights):
            if plain.weighed(length, weighed).total(length):
                assert draws_of(merged, length, weighed, seed) == draws_of(plain, length, weighed, seed)


@pytest.mark.parametrize("level", LEVELS)
@pytest.mark.parametrize(
    ("name", "length", "weights"),
    [
        ("prag", 4, {"apple": 2, "grasp>move": "1/3", "can_1": 5}),
        ("blocks", 6, {"block": 3, "stack": "1/2", "stack>unstack": 7}),
        ("hanoi", 4, {}),
        ("tabletop", 2, {"cube": 2, "brick": "0.5", "pick>place": 3}),
        ("two_arms", 2, {"arm": 3}),
    ],
)
def test_shipped_domains_are_the_same_merged_or_not(
    name: str, length: int, level: Level, weights: dict[str, str], chance: Chance
) -> None:
    model = shipped(name)
    check_that_merging_changes_nothing(model, level, length, chance.seed(1), parse_weights(weights, model.domain.facts))


@pytest.mark.slow
@settings(max_examples=examples(20), suppress_health_check=list(HealthCheck))
@given(symmetric_texts(), st.sampled_from(LEVELS), st.integers(0, 99))
def test_random_symmetric_domains_are_the_same_merged_or_not(text: str, level: Level, seed: int) -> None:
    model = DomainLogic(domain_of(text))
    names = sorted({str(action).partition("(")[0] for action in model.domain.facts.actions})
    given = {"c": "2/3", names[0]: 3, f"{names[0]}>{names[-1]}": 5}
    check_that_merging_changes_nothing(model, level, 3, seed, parse_weights(given, model.domain.facts))


@pytest.mark.parametrize("weights", [{"block": 2}, {"a": 2}, {"a": 2, "b": 2, "c": "1/2"}, {"pick_up(a)": 3, "d": 7}])
def test_weights_split_the_entities_that_they_tell_apart(weights: dict[str, str], chance: Chance) -> None:
    model = shipped("blocks")
    check_that_merging_changes_nothing(model, "plan", 6, chance.seed(5), parse_weights(weights, model.domain.facts))


def test_entities_that_weigh_the_same_and_are_in_no_weighed_action_stay_together() -> None:
    model = shipped("blocks")
    weights = parse_weights({"a": 2, "b": 2, "pick_up(d)": 3}, model.domain.facts)
    found = equal_groups(model.symmetries(0).innermost, weights)
    assert [[str(entity) for (entity,) in group] for group in found] == [["a", "b"]]


LAMPS = """
class(lamp). entity(lamp(1..K),lamp). fluent((lit(L);warm(L))) :- entity(L,lamp).
initially(lit(L),false) :- entity(L,lamp). initially(warm(L),false) :- entity(L,lamp).
action((on(L);heat(L);off(L))) :- entity(L,lamp).
precondition(on(L),lit(L),false) :- entity(L,lamp). postcondition(on(L),lit(L),true) :- entity(L,lamp).
precondition(heat(L),(lit(L)),true) :- entity(L,lamp). precondition(heat(L),warm(L),false) :- entity(L,lamp).
postcondition(heat(L),warm(L),true) :- entity(L,lamp). precondition(off(L),warm(L),true) :- entity(L,lamp).
postcondition(off(L),(lit(L);warm(L)),false) :- entity(L,lamp).
"""


def stirling(n: int, k: int) -> int:
    """The number of partitions of n steps into k lamps that were used: a lamp allows one action at a time."""
    return int(n == k) if n == 0 or k == 0 else k * stirling(n - 1, k) + stirling(n - 1, k - 1)


@pytest.mark.parametrize("lamps", [2, 5, 100])
def test_a_hundred_interchangeable_lamps_have_the_counts_of_the_formulas(lamps: int) -> None:
    model = DomainLogic(domain_of(LAMPS.replace("K", str(lamps))))
    plans, tasks = (AutomatonEngine(model, level, merge=True) for level in ("plan", "task"))
    for length in (1, 3, 15):
        assert plans.count(length) == lamps**length
        assert tasks.count(length) == sum(stirling(length, k) for k in range(min(lamps, length) + 1))
    # A lamp is off, lit, or lit and warm: what counts is how many are which, after at most 15 steps.
    assert states_of(plans, 15) == sum(a + 2 * b <= 15 and a + b <= lamps for a in range(16) for b in range(16))


def test_a_space_that_outgrows_plain_arrays_is_merged_by_itself() -> None:
    model = DomainLogic(domain_of(LAMPS.replace("K", "12")))
    engine = AutomatonEngine(model, "plan")
    assert engine.explored(4).merged is None
    assert engine.count(15) == 12**15
    assert engine.explored(15).merged is not None
    rank = 12**15 // 7
    word = engine.unrank(15, rank)
    assert engine.rank(word) == rank


STACKS = """
class(b). entity(b(1..K),b). fluent(on(X,Y)) :- entity(X,b), entity(Y,b), X != Y. fluent(top(X)) :- entity(X,b).
fluent(base(X)) :- entity(X,b). initially(F,false) :- fluent(F), not initially(F,true).
initially((top(X);base(X)),true) :- entity(X,b). action(put(X,Y)) :- fluent(on(X,Y)).
precondition(put(X,Y),(top(X);base(X);top(Y)),true) :- fluent(on(X,Y)).
precondition(put(X,Y),on(Y,X),false) :- fluent(on(X,Y)).
postcondition(put(X,Y),on(X,Y),true) :- fluent(on(X,Y)).
postcondition(put(X,Y),(top(Y);base(X)),false) :- fluent(on(X,Y)).
"""


def partitions(n: int, k: int) -> int:
    """The number of partitions of n into k parts."""
    return int(n == k) if n == 0 or k == 0 or n < k else partitions(n - 1, k - 1) + partitions(n - k, k)


def test_states_that_relate_entities_of_one_class_are_merged_to_their_shapes() -> None:
    # Single blocks are put on towers: what a state is up to renaming is a partition of the blocks into towers.
    engine = AutomatonEngine(DomainLogic(domain_of(STACKS.replace("K", "12"))), "plan", merge=True)
    plain = AutomatonEngine(DomainLogic(domain_of(STACKS.replace("K", "5"))), "plan", merge=False)
    small = AutomatonEngine(DomainLogic(domain_of(STACKS.replace("K", "5"))), "plan", merge=True)
    assert states_of(engine, 11) == sum(partitions(12, k) for k in range(1, 13))
    assert [small.count(n) for n in range(6)] == [plain.count(n) for n in range(6)]
    assert engine.count(1) == 12 * 11 and engine.count(12) == 0


SETS = """
class((cup; saucer; cube)). entity(cup(1..K),cup). entity(saucer(1..K),saucer). entity((k1;k2),cube).
of(cup(I),saucer(I)) :- entity(cup(I),cup). fluent(on(C)) :- of(C,_). fluent(up(B)) :- entity(B,cube).
initially(F,false) :- fluent(F). action((serve(C);clear(S))) :- of(C,S). action((lift(B);drop(B))) :- entity(B,cube).
precondition(serve(C),on(C),false) :- of(C,_). postcondition(serve(C),on(C),true) :- of(C,_).
precondition(clear(S),on(C),true) :- of(C,S). postcondition(clear(S),on(C),false) :- of(C,S).
precondition(lift(B),up(B),false) :- entity(B,cube). postcondition(lift(B),up(B),true) :- entity(B,cube).
precondition(drop(B),up(B),true) :- entity(B,cube). postcondition(drop(B),up(B),false) :- entity(B,cube).
"""


def test_states_are_merged_up_to_whole_units() -> None:
    """All that is left of cups with their own saucers is how many stand there: up to 8 of 60, and 0 to 2 cubes up."""
    many, few = (DomainLogic(domain_of(SETS.replace("K", str(cups)))) for cups in (60, 8))
    merged = AutomatonEngine(many, "plan", merge=True)
    assert states_of(merged, 8) == sum(cups + cubes <= 8 for cups in range(9) for cubes in range(3))
    assert merged.count(2) == 60 * (59 + 1 + 2) + 2 * (60 + 1 + 1)
    # No plan of 3 actions needs a fourth cup, so that skeletons and tasks are those of 8 cups.
    plain = {level: AutomatonEngine(few, level, merge=False) for level in LEVELS}
    for level in ("skeleton", "task"):
        assert list(AutomatonEngine(many, level, merge=True).words(3)) == list(plain[level].words(3))
    assert plain["plan"].count(3, ("serve", "serve(cup(2))", "clear(saucer(2))")) == 7
    assert merged.count(3, ("serve", "serve(cup(2))", "clear(saucer(2))")) == 59


@pytest.mark.slow
@pytest.mark.parametrize("level", LEVELS)
def test_random_domains_with_units_are_the_same_merged_or_not(level: Level, chance: Chance) -> None:
    merged_by_units = 0
    for seed in range(chance.examples(UNITS)):
        generator = chance.generator(seed)
        case = draw_units(generator)
        space = TaskSpace(domain_of(case.text()), 0).where(*(clause.words for clause in case.clauses))
        model = space.engines.model
        if model.symmetries(0).joint and not model.obstacles:
            facts = model.domain.facts
            entity = generator.choice(["c", "d", *(map(str, facts.entities) if level == "plan" else [])])
            action = str(generator.choice(list(facts.actions))) if level == "plan" else str(facts.actions[0].name)
            weights = parse_weights({entity: 3, action: "1/2"}, facts)
            check_that_merging_changes_nothing(model, level, generator.randrange(1, 4), seed, weights)
            innermost = model.symmetries(0).innermost
            merged_by_units += any(len(unit) > 1 for units in innermost for unit in units)
    assert merged_by_units > UNITS // 8
