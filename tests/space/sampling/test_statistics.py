"""Exact figures on random tasks: those of brute force on small spaces, and known ones where nothing can enumerate."""

from __future__ import annotations

import math
from collections import Counter
from decimal import Context, Decimal, localcontext
from fractions import Fraction
from itertools import pairwise
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from prag_asp import QueryError, TaskSpace, load_domain
from prag_asp.exact_numbers import Number
from prag_asp.space.engines.engine import LEVELS, Level
from prag_asp.space.sampling.statistics import Statistics
from tests.brute_force import Toy, term
from tests.chance import Chance, examples
from tests.domains import domain_of
from tests.space.sampling.test_sampling import ENTITIES, KINDS, expected_weight, pairs, words_of_pairs
from tests.spaces import with_engine
from tests.strategies import toys

DOMAIN = load_domain("prag")


def check(found: Statistics, weighed: dict[tuple[str, ...], Fraction]) -> None:
    """Compare figures with sums over all words; those with weight 0 count for nothing."""
    total = sum(weighed.values())
    assert found.words == sum(1 for weight in weighed.values() if weight)
    assert found.total_weight == total
    expected: Counter[object] = Counter()
    contains: Counter[object] = Counter()
    entropy = 0.0
    for word, weight in weighed.items():
        names = [action.partition("(")[0] for action in word]
        for thing in (*(action for action in word if "(" in action), *names, *pairwise(names)):
            expected[thing] += weight / total  # type: ignore[assignment]
        used = {entity for action in word for entity in ENTITIES if entity in action}
        for thing in {*word, *names, *used, *(name for entity in used for name in ENTITIES[entity])}:
            contains[thing] += weight / total  # type: ignore[assignment]
        entropy -= float(weight / total) * math.log2(weight / total) if weight else 0
    told = {**found.expected_actions, **found.expected_names, **found.expected_pairs}
    assert {key: share for key, share in expected.items() if share} == {
        key: share for key, share in told.items() if share
    }
    for shares in (found.contains_action, found.contains_name, found.contains_entity, found.contains_class):
        assert all(share == contains[key] for key, share in shares.items())
    missing = {key for key, share in contains.items() if share} - {
        *found.contains_action, *found.contains_name, *found.contains_entity, *found.contains_class,
    }  # fmt: skip
    assert not missing
    assert float(found.entropy) == pytest.approx(entropy, abs=1e-9)


@pytest.mark.parametrize("engine", ["automaton", "clingo"])
@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("by", ["task", "plan"])
def test_figures_are_those_of_all_words_for_each_kind_of_weight(kind: str, by: Level, engine: str) -> None:
    space = pairs(engine)
    weighed = {word: expected_weight(word, KINDS[kind]) for word in words_of_pairs(engine, by)}
    check(space.statistics(weights=KINDS[kind], by=by), weighed)
    assert space.sampling(weights=KINDS[kind], by=by).total_weight() == sum(weighed.values())


@settings(max_examples=examples(30), suppress_health_check=list(HealthCheck))
@given(toys(closed=False), st.dictionaries(st.sampled_from(["a", "b", "a>b", "b>b"]), st.fractions(0, 9), max_size=3))
def test_figures_are_exact_on_random_domains(toy: Toy, weights: dict[str, Number]) -> None:
    names = {action.name for action in toy.actions}
    weights = {key: weight for key, weight in weights.items() if set(key.split(">")) <= names}
    plans = [tuple(term(toy, i) for i in plan) for plan in toy.plans(3)]
    weighed = {plan: expected_weight(plan, weights) for plan in plans}
    domain = domain_of(toy.text(), "at_most")
    automaton = TaskSpace(domain, 3, engine="automaton")
    for space in (automaton, with_engine(automaton, "clingo")):
        assert space.sampling(weights=weights).total_weight() == sum(weighed.values())
        if sum(weighed.values()):
            check(space.statistics(weights=weights, by="plan"), weighed)
        else:
            with pytest.raises(QueryError, match="to sample"):
                space.statistics(weights=weights, by="plan")


def test_skeletons_have_figures_too() -> None:
    space = TaskSpace(DOMAIN, 4)
    found = space.statistics(weights={}, by="skeleton")
    words = list(space.enumerate("skeleton"))
    check(found, {word: Fraction(1) for word in words})
    assert found.expected_actions == found.contains_entity == {}


def test_the_entropy_of_a_uniform_draw_is_the_logarithm_of_the_count() -> None:
    """At 1000 actions there are 10**628 skeletons, which nothing enumerates."""
    space = TaskSpace(DOMAIN, 1000)
    found = space.statistics(weights={}, by="skeleton")
    with localcontext(Context(prec=60)):
        bits = Decimal(space.count("skeleton")).ln() / Decimal(2).ln()
        assert abs(found.entropy - bits) < Decimal("1e-29")
    assert sum(found.expected_names.values()) == 1000
    assert sum(found.expected_pairs.values()) == 999


@pytest.mark.parametrize("length", [400, 10_000])
def test_where_each_draw_is_free_figures_are_known(length: int) -> None:
    """Two actions without conditions, one three times as heavy: n coins, each with the entropy of one."""
    domain = domain_of("fluent(f). action(a). action(b).")
    found = TaskSpace(domain, length).statistics(weights={"a": "3/2", "b": "1/2"})
    assert found.total_weight == 2**length
    assert found.expected_names == {"a": length * Fraction(3, 4), "b": length * Fraction(1, 4)}
    assert found.expected_pairs["a", "b"] == (length - 1) * Fraction(3, 16)
    assert found.contains_name["b"] == 1 - Fraction(3, 4) ** length
    with localcontext(Context(prec=60)):
        coin = 2 - Decimal(3).ln() / Decimal(2).ln() * 3 / 4
        assert abs(found.entropy - length * coin) < Decimal("1e-29")


@pytest.mark.parametrize("weights", [{}, {"grasp": 3, "rotate>rotate": "1/2", "drop": 0}])
def test_the_recurrence_of_long_words_gives_the_figures_of_each_step(
    monkeypatch: pytest.MonkeyPatch, weights: dict[str, Number]
) -> None:
    by_steps = TaskSpace(DOMAIN, 300).statistics(weights=weights, by="plan")
    monkeypatch.setattr("prag_asp.space.automaton.recurrence.SHORTEST", 0)
    monkeypatch.setattr("prag_asp.space.sampling.statistics.SHORTEST", 0)
    assert TaskSpace(DOMAIN, 300).statistics(weights=weights, by="plan") == by_steps


def test_draws_have_the_moments_that_the_figures_say(chance: Chance) -> None:
    """The mean number of each name in 200,000 draws is the expected one, and a five percent error would show."""
    space = TaskSpace(DOMAIN, 15)
    weights: dict[str, Number] = {"grasp": 3, "rotate>rotate": "1/2", "can": 2}
    found = space.statistics(weights=weights)
    rows = space.sampling(weights=weights).array(200_000, seed=chance.seed(6))
    letters = space.action_texts()
    for name, expected in found.expected_names.items():
        mask = [letter.partition("(")[0] == name for letter in letters]
        numbers = sum(((rows == letter).sum(axis=1) for letter, own in enumerate(mask) if own))
        error = numbers.std() / math.sqrt(len(rows))  # type: ignore[union-attr]
        assert abs(numbers.mean() - float(expected)) < 4.5 * error  # type: ignore[union-attr]
        assert 0.05 * float(expected) > 4.5 * error


def test_the_weight_without_names_and_pairs_is_that_of_a_brute_force() -> None:
    space = TaskSpace(load_domain("prag"), length=3)
    for what in ((), ("grasp",), ("move>follow", "grasp > drop"), ("rotate", "move>move", "approach>grasp")):
        left = 0
        for word in space.enumerate():
            names = [action.split("(")[0] for action in word]
            pairs = {" > ".join(pair) for pair in pairwise(names)} | {">".join(pair) for pair in pairwise(names)}
            left += 2 ** names.count("follow") * ({*names, *pairs}.isdisjoint(what))
        assert space.sampling(weights={"follow": 2}).weight_without(what) == left
    with pytest.raises(QueryError, match="grsp"):
        space.sampling().weight_without(["grsp>move"])


@settings(max_examples=examples(30), suppress_health_check=list(HealthCheck))
@given(toys(closed=False), st.dictionaries(st.sampled_from("ab"), st.fractions(0, 9), max_size=2), st.data())
def test_the_weight_without_names_and_pairs_is_exact_on_random_domains(
    toy: Toy, weights: dict[str, Number], data: st.DataObject
) -> None:
    names = sorted({action.name for action in toy.actions})
    weights = {name: weight for name, weight in weights.items() if name in names}
    without = data.draw(st.lists(st.sampled_from([*names, *(f"{a}>{b}" for a in names for b in names)]), max_size=3))
    left = Fraction(0)
    space = TaskSpace(domain_of(toy.text(), "at_most"), 3, engine="automaton")
    for word in space.enumerate():
        named = [action.partition("(")[0] for action in word]
        if {*named, *(">".join(pair) for pair in pairwise(named))}.isdisjoint(without):
            left += expected_weight(word, weights)
    for each in (space, with_engine(space, "clingo")):
        assert each.sampling(weights=weights).weight_without(without) == left


def test_names_and_actions_that_never_occur_have_no_share(tmp_path: Path) -> None:
    (tmp_path / "domain.lp").write_text(
        """
        fluent(on; odd). initially((on;odd),false).
        action(press). precondition(press,on,false). postcondition(press,on,true).
        action(release). precondition(release,on,true). postcondition(release,on,false).
        action(turn). precondition(turn,odd,true).
        action(twist). precondition(twist,odd,true). postcondition(twist,odd,true).
        """
    )
    space = TaskSpace(load_domain(tmp_path), 1)
    for by in LEVELS:
        found = space.statistics(by=by)
        assert found.contains_name == found.expected_names == {"press": 1}
        assert space.sampling(by=by).weight_without(["turn", "twist>press"]) == 1
        assert space.sampling(by=by).weight_without(["turn", "press"]) == 0
