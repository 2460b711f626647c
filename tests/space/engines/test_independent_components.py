"""Parts of a domain that have nothing in common are counted apart, and shuffled to what the whole counts."""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from math import exp, factorial, prod

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from prag_asp import LimitReached, Limits, TaskSpace
from prag_asp.logic.domain_logic import DomainLogic
from prag_asp.logic.step import independent
from prag_asp.logic.step.independent import independent_parts
from prag_asp.program.entity_names import action_name
from prag_asp.space.automaton import exploration as exploring
from prag_asp.space.automaton.shuffle_product import ShuffledWords
from prag_asp.space.engines import LEVELS, Level
from prag_asp.space.engines.automaton_engine import AutomatonEngine
from prag_asp.space.engines.independent_components import count_shuffles
from prag_asp.space.engines.reachability import Reach, TooManyStates
from prag_asp.space.weights.weights import Weights, parse_weights
from tests.brute_force import Action, Toy
from tests.chance import examples
from tests.domains import domain_of
from tests.spaces import draws_of
from tests.strategies import toys


@contextmanager
def wherever_possible() -> Iterator[None]:
    """Count apart wherever there are parts, however small."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(independent, "FEWEST_VARIABLES", 0)
        patch.setattr("prag_asp.space.engines.independent_components.FEW_STATES", 0)
        patch.setattr("prag_asp.space.engines.independent_components.MANY_EDGES", 0)
        patch.setattr(exploring, "MANY", 0)
        yield


def beside(first: Toy, second: Toy, other_names: bool) -> Toy:
    """Return the domain that has both domains side by side, the second with other names of actions or the same."""
    actions, fluents = len(first.actions), first.fluents

    def moved(values: dict[int, bool | None]) -> dict[int, bool | None]:
        return {f + fluents: value for f, value in values.items()}

    def pairs(given: tuple[tuple[int, int], ...], by: int) -> tuple[tuple[int, int], ...]:
        return tuple((a + by, b + by) for a, b in given)

    called = {name: f"{name}_too" if other_names else name for name in "abc"}
    return Toy(
        fluents + second.fluents,
        (*first.actions, *(Action(called[a.name], moved(a.before), moved(a.after)) for a in second.actions)),
        {**first.initially, **moved(second.initially)},
        (*first.exclusive, *pairs(second.exclusive, fluents)),
        (*first.implies, *pairs(second.implies, fluents)),
        {**first.goal, **moved(second.goal)},
        (*first.never_after, *pairs(second.never_after, actions)),
        {**first.at_most, **{called[name]: k for name, k in second.at_most.items()}},
        (*first.blocked, *((i + actions, f + fluents, g + fluents) for i, f, g in second.blocked)),
        impossible=(*first.impossible, *pairs(second.impossible, fluents)),
    )


def small(toy: Toy) -> Toy:
    """Return a domain with two actions at most: brute force has to count those beside others."""
    return replace(
        toy, actions=toy.actions[:2], never_after=tuple(p for p in toy.never_after if max(p) < 2),
        blocked=tuple(b for b in toy.blocked if b[0] < 2),
    )  # fmt: skip


@settings(max_examples=examples(20), suppress_health_check=list(HealthCheck))
@given(
    st.booleans().flatmap(lambda closed: st.tuples(toys(closed=closed), toys(closed=closed))),
    st.booleans(),
    st.booleans(),
)
def test_two_domains_side_by_side_have_the_plans_of_brute_force(
    both: tuple[Toy, Toy], other_names: bool, over_time: bool
) -> None:
    toy = beside(small(both[0]), small(both[1]), other_names)
    if not over_time:
        toy = replace(toy, never_after=(), at_most={})
    model = DomainLogic(domain_of(toy.text(), "at_most"))
    engines = {level: AutomatonEngine(model, level) for level in LEVELS}
    with wherever_possible():
        for length in range(5):
            plans = list(toy.plans(length))
            names = {tuple(toy.actions[i].name for i in plan) for plan in plans}
            expected: dict[Level, int] = {"plan": len(plans), "task": len(plans), "skeleton": len(names)}
            for level, engine in engines.items():
                assert engine.count(length) == expected[level]


ROOMS = """
class(kind(1..K)). entity(room(R),kind(R)) :- R=1..K. own(room(1..K)).
fluent((lit(R);open(R);swept(R))) :- own(R). initially(F,false) :- fluent(F).
action((light(R);shut(R);enter(R);sweep(R))) :- own(R).
precondition(light(R),lit(R),false) :- own(R). postcondition(light(R),lit(R),true) :- own(R).
precondition(enter(R),lit(R),true) :- own(R). postcondition(enter(R),open(R),true) :- own(R).
precondition(sweep(R),open(R),true) :- own(R). postcondition(sweep(R),swept(R),true) :- own(R).
precondition(shut(R),open(R),true) :- own(R). postcondition(shut(R),(lit(R);open(R);swept(R)),false) :- own(R).
"""
SWEPT = "goal(swept(R),true) :- own(R)."


def one_room(length: int, swept: bool) -> int:
    """Count the plans of one room, by trying all sequences."""

    def valid(plan: tuple[str, ...]) -> bool:
        state: set[str] = set()
        for action in plan:
            needs, free, adds = {"light": ("", "lit", "lit"), "enter": ("lit", "", "open"),
                                 "sweep": ("open", "", "swept"), "shut": ("open", "", "")}[action]  # fmt: skip
            if (needs and needs not in state) or free in state:
                return False
            state = set() if action == "shut" else state | {adds}
        return not swept or "swept" in state

    return sum(map(valid, itertools.product(("light", "enter", "sweep", "shut"), repeat=length)))


def sums(total: int, parts: int) -> Iterator[tuple[int, ...]]:
    """Yield the ways to write a number as a sum of so many numbers from 0 on, in order."""
    if parts == 1:
        yield (total,)
        return
    for first in range(total + 1):
        yield from ((first, *rest) for rest in sums(total - first, parts - 1))


@pytest.mark.parametrize(("rooms", "length", "swept"), [(12, 6, False), (5, 8, False), (2, 9, True), (3, 11, True)])
def test_rooms_have_the_plans_of_the_formula(rooms: int, length: int, swept: bool) -> None:
    single = [one_room(k, swept) for k in range(min(length, 8) + 1)] + [0] * max(length - 8, 0)
    domain = domain_of(ROOMS.replace("K", str(rooms)) + SWEPT * swept)
    if length > 8:  # a room that is swept takes three steps: the others have eight at most
        assert swept and length - 3 * (rooms - 1) <= 8
    expected = sum(
        factorial(length) // prod(map(factorial, ways)) * prod(single[k] for k in ways) for ways in sums(length, rooms)
    )
    told: list[str] = []
    with wherever_possible():
        space = TaskSpace(domain, length, progress=told.append)
        assert space.count("plan") == space.count("task") == expected
    assert any(f"counted in {rooms} independent parts" in words for words in told)


def test_twelve_rooms_are_counted_apart_without_being_asked() -> None:
    told: list[str] = []
    space = TaskSpace(domain_of(ROOMS.replace("K", "12") + SWEPT), 40, progress=told.append)
    assert space.count() > factorial(36) // factorial(3) ** 12
    assert [words for words in told if "independent" in words] == ["counted in 12 independent parts with 48 states"]


def test_few_states_are_explored_together_as_they_always_were() -> None:
    told: list[str] = []
    space = TaskSpace(domain_of(ROOMS.replace("K", "4")), 12, progress=told.append)
    assert space.count("plan") and not any("independent" in words for words in told)


@settings(max_examples=examples(15), suppress_health_check=list(HealthCheck))
@given(
    st.booleans().flatmap(lambda closed: st.tuples(toys(closed=closed), toys(closed=closed))),
    st.booleans(),
    st.lists(st.sampled_from(["a", "b", "c"]), max_size=2),
    st.integers(0, 2**32),
)
def test_words_of_two_domains_side_by_side_are_those_of_the_whole(
    both: tuple[Toy, Toy], other_names: bool, prefix: list[str], seed: int
) -> None:
    model = DomainLogic(domain_of(beside(small(both[0]), small(both[1]), other_names).text(), "at_most"))
    weights = parse_weights(
        {name: f"{number}/3" for number, name in enumerate(sorted(names_of(model)))}, model.domain.facts
    )
    for level in LEVELS:
        whole, apart = AutomatonEngine(model, level, merge=False), AutomatonEngine(model, level)
        with wherever_possible():
            for length in (4, 0):
                words = list(whole.words(length))
                assert list(apart.words(length)) == words
                assert [apart.unrank(length, rank) for rank in range(len(words))] == words
                assert [apart.rank(word) for word in words] == list(range(len(words)))
                assert all(map(apart.contains, words))
                begun = [name for name in prefix if name in names_of(model)]
                assert apart.count(length, begun) == whole.count(length, begun) == len(list(apart.words(length, begun)))
                for weigh in [Weights()] if level == "skeleton" else [Weights(), weights]:
                    if whole.weighed(length, weigh).total(length):
                        assert draws_of(apart, length, weigh, seed) == draws_of(whole, length, weigh, seed)
                    else:
                        assert not apart.weighed(length, weigh).total(length)


def names_of(model: DomainLogic) -> set[str]:
    return set(map(action_name, model.domain.facts.declared_actions))


def test_words_that_differ_in_one_action_are_told_from_words_of_the_whole() -> None:
    model = DomainLogic(domain_of(ROOMS.replace("K", "3")))
    whole = AutomatonEngine(model, "plan", merge=False)
    with wherever_possible():
        apart = AutomatonEngine(model, "plan")
        words = set(whole.words(3))
        assert isinstance(apart.known(3), ShuffledWords)
        for word in itertools.product(whole.letters, repeat=3):
            assert apart.contains(word) == (apart.rank(word) is not None) == (word in words)


@pytest.mark.parametrize("weights", [{}, {"shut": "1/4", "light(room(3))": 5}])
def test_plans_of_twelve_rooms_are_drawn_each_with_its_probability(
    weights: dict[str, str | int], monkeypatch: pytest.MonkeyPatch
) -> None:
    """What is listed before the parts are found is dropped: nothing of it is weighed."""
    monkeypatch.delattr("prag_asp.space.engines.reachability.weigh")
    monkeypatch.setattr("prag_asp.space.engines.independent_components.MANY_EDGES", 100_000)
    domain = domain_of(ROOMS.replace("K", "12") + SWEPT)
    told: list[str] = []
    space = TaskSpace(domain, 40, progress=told.append)
    tasks = space.sample(3, seed=3, weights=weights)
    assert "found in 12 independent parts with 48 states" in told
    shares = {round(exp(task.log_probability) * space.count(), 6) for task in tasks}
    assert (shares == {1}) == (not weights)
    for task in tasks:
        assert space.plan_at(space.index(task)) == tuple(map(str, task.actions))


def test_a_part_that_is_large_itself_is_found_in_the_whole() -> None:
    model = DomainLogic(domain_of(ROOMS.replace("K", "3")))
    with wherever_possible(), pytest.MonkeyPatch.context() as patch:
        patch.setattr("prag_asp.space.engines.independent_components.LARGE_PART", 0)
        assert isinstance(AutomatonEngine(model, "plan").known(4), Reach)


def test_a_limit_ends_the_finding_of_words_with_a_line() -> None:
    limits = Limits(seconds=1e-9, cached=False)
    with wherever_possible(), pytest.raises(LimitReached, match=r"time limit .* was reached"):
        list(TaskSpace(domain_of(ROOMS.replace("K", "12")), 30, limits=limits).enumerate("plan"))


JOINED = {
    "a rule that reads both": "#program step(t). :- occurs(enter(room(1)),t), holds(open(room(2)),true,t-1).",
    "a state of both": "#program step(t). :- holds(open(room(1)),true,t), holds(open(room(2)),true,t).",
    "an invariant": "exclusive(open(room(1)),open(room(2))).",
    "the last action": "#program step(t). :- occurs(light(room(1)),t-1), not occurs(enter(room(1)),t).",
    "a clock": "day(0,0). #program step(t). day(1-X,t) :- day(X,t-1). :- occurs(enter(room(1)),t), day(1,t-1).",
    "a last state of both": "#program check(t). :- not holds(open(room(1)),true,t), not holds(open(room(2)),true,t).",
    "a number of actions": "at_most(light,2).",
    "an action that has to follow": "#program step(t). :- holds(open(room(1)),true,t-1), not occurs(shut(room(1)),t).",
}


@pytest.mark.parametrize("what", JOINED)
@pytest.mark.parametrize("level", LEVELS)
def test_what_joins_parts_is_obeyed(what: str, level: Level) -> None:
    model = DomainLogic(domain_of(ROOMS.replace("K", "3") + JOINED[what], "at_most"))
    whole = AutomatonEngine(model, level, merge=False)
    with wherever_possible():
        engine = AutomatonEngine(model, level)
        lengths = (1, 3, 5, 6)
        assert [engine.count(length) for length in lengths] == [whole.count(length) for length in lengths]


def test_parts_are_those_that_nothing_joins() -> None:
    rooms = ROOMS.replace("K", "5")
    parts = independent_parts(DomainLogic(domain_of(rooms)).transition(tasks=False))
    assert sorted(len(part.actions) for part in parts) == [4] * 5
    joined = DomainLogic(domain_of(rooms + JOINED["an invariant"])).transition(tasks=False)
    assert sorted(len(part.actions) for part in independent_parts(joined)) == [4, 4, 4, 8]
    assert independent_parts(DomainLogic(domain_of(rooms)).transition(tasks=False), by_name=True) == ()


@given(st.lists(st.lists(st.integers(0, 5), min_size=5, max_size=5), min_size=1, max_size=4))
def test_shuffles_are_counted_as_one_by_one(counts: list[list[int]]) -> None:
    length = 4
    expected = 0
    for owners in itertools.product(range(len(counts)), repeat=length):
        expected += prod(part[owners.count(number)] for number, part in enumerate(counts))
    assert count_shuffles(counts) == (expected, None)


def test_a_limit_leaves_words_out_and_says_so() -> None:
    domain = domain_of(ROOMS.replace("K", "12"))
    whole = TaskSpace(domain, 100).count("plan")
    with pytest.raises(LimitReached, match="at least") as caught:
        TaskSpace(domain, 100, limits=Limits(seconds=1e-9, cached=False)).count("plan")
    assert 0 <= caught.value.at_least <= whole


def test_both_engines_agree_on_rooms() -> None:
    domain = domain_of(ROOMS.replace("K", "4"))
    with wherever_possible():
        for level in LEVELS:
            spaces = [TaskSpace(domain, 3, engine=engine) for engine in ("automaton", "clingo", "sat")]
            assert len({space.count(level) for space in spaces}) == 1
            assert spaces[0].count(level) == len(list(spaces[0].enumerate(level)))


BOOKS = """
class(book). entity(book(1..9),book). b(X) :- entity(X,book).
fluent((taken(X);read(X))) :- b(X). action((take(X);study(X);back(X))) :- b(X).
precondition(take(X),taken(X),false) :- b(X). postcondition(take(X),taken(X),true) :- b(X).
precondition(study(X),taken(X),true) :- b(X). postcondition(study(X),read(X),true) :- b(X).
precondition(back(X),read(X),true) :- b(X). postcondition(back(X),(taken(X);read(X)),false) :- b(X).
exclusive(read(X),read(Y)) :- b(X), b(Y), X < Y.
"""


def test_states_of_a_part_are_merged_as_those_of_a_whole(monkeypatch: pytest.MonkeyPatch) -> None:
    model = DomainLogic(domain_of(BOOKS + ROOMS.replace("K", "2")))
    whole = AutomatonEngine(model, "plan", merge=False).count(7)
    told: list[str] = []
    monkeypatch.setattr("prag_asp.space.engines.reachability.PATIENCE", 0)
    monkeypatch.setattr("prag_asp.space.engines.reachability.LARGE", 1)
    with wherever_possible():
        assert AutomatonEngine(model, "plan", told.append).count(7) == whole
    (counted,) = [words for words in told if "independent" in words]
    # Three states of each room; of the books up to 7 are taken, one of which may be read where that is step by step.
    assert counted == f"counted in 3 independent parts with {2 * 3 + 8 + 6} states"


@pytest.mark.parametrize("level", ["plan", "skeleton"])
def test_parts_answer_where_the_whole_would_not_fit_into_memory(level: Level, monkeypatch: pytest.MonkeyPatch) -> None:
    domain = domain_of(ROOMS.replace("K", "4"))
    whole = AutomatonEngine(DomainLogic(domain), level, merge=False)
    counts, ranks = whole.count(7), range(0, whole.count(7), 101)
    monkeypatch.setattr("prag_asp.space.engines.reachability.PATIENCE", 0)
    engine = AutomatonEngine(DomainLogic(domain), level, hopeless=lambda extent, length: extent.depth > 3)
    if level == "skeleton":
        with pytest.raises(TooManyStates):
            engine.count(7)
    else:
        assert engine.count(7) == counts
        assert [engine.unrank(7, rank) for rank in ranks] == [whole.unrank(7, rank) for rank in ranks]
