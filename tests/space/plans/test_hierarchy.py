"""Plans of a domain with composites are concatenations of whole composites and of free actions."""

from __future__ import annotations

from fractions import Fraction
from itertools import islice, pairwise
from math import prod
from pathlib import Path

import pytest
from hypothesis import HealthCheck, assume, given, settings
from hypothesis import strategies as st

from prag_asp import DomainError, TaskSpace, load_domain
from prag_asp.atom import parse_atom
from prag_asp.logic.domain_logic import DomainLogic
from prag_asp.space.automaton.exploration import explore
from prag_asp.space.plans.readings import Composite, Readings, hierarchy_of
from tests.brute_force import Toy, part, term
from tests.chance import examples
from tests.domains import domain_of
from tests.spaces import with_engine
from tests.strategies import hierarchies


@settings(max_examples=examples(60), suppress_health_check=list(HealthCheck))
@given(hierarchies(closed=False))
def test_the_readings_of_a_plan_are_those_of_brute_force_each_once(toy: Toy) -> None:
    space = TaskSpace(domain_of(toy.text(), "at_most"), 4)
    for plan in toy.plans(4):
        task = next(space.tasks_of_plans(iter([tuple(term(toy, i) for i in plan)])))
        readings = space.readings(task)
        found = [" ".join(map(str, reading)) for reading in readings]
        expected = [" ".join(nested(toy, number) for number in reading) for reading in toy.readings(plan)]
        assert sorted(found) == sorted(expected)
        assert readings.count() == len(expected) == len(set(expected)) > 0


def nested(toy: Toy, number: int) -> str:
    if number < len(toy.actions):
        return part(toy, number)
    inside = " ".join(nested(toy, p) for p in toy.composites[number - len(toy.actions)])
    return f"{part(toy, number)}[{inside}]"


@settings(max_examples=examples(30), suppress_health_check=list(HealthCheck))
@given(hierarchies(closed=False), st.dictionaries(st.sampled_from(["a", "b", "a>b", "b>a"]), st.integers(0, 3)))
def test_plans_are_drawn_by_weight_from_those_of_the_hierarchy(toy: Toy, given_weights: dict[str, int]) -> None:
    names = {action.name for action in toy.actions}
    weights = {key: weight for key, weight in given_weights.items() if set(key.split(">")) <= names}
    plans = {tuple(term(toy, i) for i in plan): weight_of(toy, plan, weights) for plan in toy.plans(3)}
    total = sum(plans.values())
    assume(total)
    automaton = TaskSpace(domain_of(toy.text(), "at_most"), 3, engine="automaton")
    for space in (automaton, with_engine(automaton, "clingo")):
        drawn = list(islice(space.sampling(weights=weights, by="plan").draws(seed=1), 30))
        assert all(draw.probability == Fraction(plans[draw.word], total) for draw in drawn)


def weight_of(toy: Toy, plan: tuple[int, ...], weights: dict[str, int]) -> int:
    names = [toy.actions[i].name for i in plan]
    return prod(weights.get(key, 1) for key in (*names, *(f"{a}>{b}" for a, b in pairwise(names))))


TOYS = """
class(toy). entity((ball; cube; duck), toy). fluent(shown(T)) :- is_a(T,toy).
action((lift(T); show(T); drop(T))) :- is_a(T,toy).
postcondition(show(T), shown(T), true) :- is_a(T,toy).
composite(once(T)) :- is_a(T,toy).
stage(once(T), 1, lift(T)) :- is_a(T,toy).
stage(once(T), 2, show(T)) :- is_a(T,toy).
stage(once(T), 3, drop(T)) :- is_a(T,toy).
composite(both(S,T)) :- is_a(S,toy), is_a(T,toy), S != T.
stage(both(S,T), 1, once(S)) :- composite(both(S,T)).
stage(both(S,T), 2, once(T)) :- composite(both(S,T)).
free(show(T)) :- is_a(T,toy).
"""


def toys_written(folder: Path, more: str = "") -> Path:
    (folder / "domain.lp").write_text(TOYS + more, encoding="utf-8")
    return folder


def test_a_plan_with_several_readings_is_one_plan(tmp_path: Path) -> None:
    space = TaskSpace(load_domain(toys_written(tmp_path)), 6)
    plan = [f"{name}({toy})" for toy in ("ball", "cube") for name in ("lift", "show", "drop")]
    assert list(space.enumerate("plan", ["lift(ball)", "show", "drop", "lift(cube)"])) == [tuple(plan)]
    task = next(space.tasks_of_plans(iter([tuple(plan)])))
    first, second = space.readings(task)
    assert " ".join(map(str, first)) == (
        "once(ball)[lift(ball) show(ball) drop(ball)] once(cube)[lift(cube) show(cube) drop(cube)]"
    )
    (both,) = second
    assert isinstance(both, Composite)
    assert both.term == parse_atom("both(ball,cube)") and both.parts == first
    assert tuple(both.actions()) == task.actions


def test_interchangeable_entities_stay_interchangeable_within_composites(tmp_path: Path) -> None:
    domain = load_domain(toys_written(tmp_path))
    for engine in ("automaton", "clingo"):
        space = TaskSpace(domain, 6, engine=engine)
        # Plans are words over 3 free actions and 3 composites of 3 actions: 3^6 + 4 * 3^3 * 3 + 3^2.
        assert space.count("plan") == 3**6 + 4 * 3**4 + 3**2
        # Up to renaming of 3 toys: set partitions of 6, 4 and 2 places into at most 3 parts.
        assert space.count("task") == (1 + 31 + 90) + 4 * (1 + 7 + 6) + (1 + 1)
        assert space.count("skeleton") == 1 + 4 + 1


def test_a_composite_whose_parts_are_all_free_changes_nothing_and_needs_no_state(tmp_path: Path) -> None:
    free = "free((lift(T); drop(T))) :- is_a(T,toy)."
    folder = toys_written(tmp_path, free)
    for length in range(5):
        whole, flat = (TaskSpace(load_domain(folder, flat=flat), length) for flat in (False, True))
        assert whole.count("plan") == flat.count("plan") == 9**length
    automata = [
        explore(DomainLogic(load_domain(folder, flat=flat)).transition(tasks=False), 9) for flat in (False, True)
    ]
    assert automata[0].automaton.states == automata[1].automaton.states


def test_without_the_hierarchy_any_sequence_of_actions_is_a_plan_with_one_reading(tmp_path: Path) -> None:
    domain = load_domain(toys_written(tmp_path), flat=True)
    assert not domain.facts.composites and not domain.facts.free
    for engine in ("automaton", "clingo"):
        space = TaskSpace(domain, 3, engine=engine)
        assert space.count("plan") == 9**3
    task = space[0]
    assert [task.actions] == list(space.readings(task)) and space.readings(task).count() == 1


def test_the_empty_plan_has_one_reading_and_a_plan_cut_short_none(tmp_path: Path) -> None:
    space = TaskSpace(load_domain(toys_written(tmp_path)), 0)
    assert list(space.readings(space[0])) == [()]
    cut = Readings((parse_atom("lift(ball)"),), hierarchy_of(space.domain.facts))
    assert (list(cut), cut.count()) == ([], 0)


def test_readings_are_counted_without_being_enumerated(tmp_path: Path) -> None:
    space = TaskSpace(load_domain(toys_written(tmp_path)), 600)
    plan = [parse_atom(f"{name}({toy})") for toy in ("ball", "cube") * 100 for name in ("lift", "show", "drop")]
    readings = Readings(tuple(plan), hierarchy_of(space.domain.facts))
    fibonacci = [1, 1]
    while len(fibonacci) <= 200:
        fibonacci.append(fibonacci[-1] + fibonacci[-2])
    assert readings.count() == fibonacci[200]
    assert len(next(iter(readings))) == 200


def test_a_composite_may_be_as_long_as_the_linter_allows(tmp_path: Path) -> None:
    text = "composite(long). stage(long,1..99,show(ball)). stage(long,100,lift(ball))."
    space = TaskSpace(load_domain(toys_written(tmp_path, text)), 100)
    shorter = [1, 3, 9]
    while len(shorter) <= 100:
        shorter.append(3 * shorter[-1] + 3 * shorter[-3])
    assert space.count("plan") == shorter[100] + 1
    with pytest.raises(DomainError, match="long has 101 actions, more than 100; split it"):
        load_domain(toys_written(tmp_path, f"{text} stage(long,101,drop(ball))."))
