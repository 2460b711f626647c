"""Metrics keep their axioms, also up to renaming, and agree with definitions written here."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Sequence
from dataclasses import replace
from fractions import Fraction
from functools import cache
from typing import Any

import pytest

from prag_asp import Atom, QueryError, Task, TaskSpace, load_domain
from prag_asp.similarity import METRICS, Background, compare
from prag_asp.similarity.edit_costs import CostTable, class_cost, effect_cost, state_cost, unit_cost
from prag_asp.similarity.features import changes, effects, links, states
from tests.chance import Chance
from tests.similarity.random_tasks import BACKGROUND, CLASSES, PARENTS, all_renamings, random_task, renamed

STILL = replace(BACKGROUND, interchange=type(BACKGROUND.interchange)())
"""The same without renamings."""


def tasks_for(name: str, chance: Chance, count: int, number: int = 7) -> list[Task]:
    generator = chance.generator(number)
    lengths = (
        itertools.repeat(3) if name.startswith("hamming") else (generator.randint(0, 4) for _ in itertools.count())
    )
    return [random_task(generator, length) for length in itertools.islice(lengths, count)]


@pytest.mark.parametrize("name", METRICS)
def test_the_distance_is_the_least_over_all_renamings(name: str, chance: Chance) -> None:
    for number in range(7, 7 + chance.examples(1)):
        tasks = tasks_for(name, chance, 8, number)
        for one, other in itertools.pairwise(tasks):
            found = compare(one, other, name, BACKGROUND)
            least = min(compare(one, renamed(other, names), name, STILL).distance for names in all_renamings())
            assert (
                found.distance == pytest.approx(least, abs=1e-12)
                if name.startswith("jaro")
                else found.distance == least
            )
            again = compare(one, renamed(other, found.renaming), name, STILL)
            assert again.distance == found.distance and 0 <= found.normalised <= 1


@pytest.mark.parametrize("name", METRICS)
def test_a_metric_is_zero_for_renamed_tasks_symmetric_and_triangular(name: str, chance: Chance) -> None:
    for number in range(7, 7 + chance.examples(1)):
        tasks = tasks_for(name, chance, 6, number)
        between = {pair: compare(*pair, name, BACKGROUND) for pair in itertools.product(tasks, repeat=2)}
        for one, other in itertools.product(tasks, repeat=2):
            found, back = between[one, other], between[other, one]
            assert found.distance == pytest.approx(back.distance) and found.normalised == pytest.approx(back.normalised)
            assert one is not other or found.distance == 0
        names = list(all_renamings())
        for place, task in enumerate(tasks):
            assert compare(task, renamed(task, names[5 * place % len(names)]), name, BACKGROUND).distance == 0
        if METRICS[name].axioms:
            for one, middle, other in itertools.product(tasks, repeat=3):
                for value in ("distance", "normalised"):
                    way = getattr(between[one, middle], value) + getattr(between[middle, other], value)
                    assert getattr(between[one, other], value) <= way


def recursive(one: Sequence[Any], other: Sequence[Any], cost: Callable[[Any, Any], Fraction]) -> Fraction:
    """Return the edit distance by its recursive definition."""

    @cache
    def least(i: int, j: int) -> Fraction:
        ways = [least(i - 1, j) + cost(one[i - 1], None)] if i else []
        ways += [least(i, j - 1) + cost(None, other[j - 1])] if j else []
        ways += [least(i - 1, j - 1) + cost(one[i - 1], other[j - 1])] if i and j else []
        return min(ways, default=Fraction(0))

    return least(len(one), len(other))


def test_edit_distances_are_those_of_the_recursive_definition_and_the_sum_of_their_edits(chance: Chance) -> None:
    tasks = tasks_for("levenshtein", chance, 12)
    for one, other in itertools.pairwise(tasks):
        for name, cost in (("levenshtein", unit_cost), ("levenshtein-classes", class_cost)):
            found = compare(one, other, name, STILL)
            assert found.distance == recursive(one.actions, other.actions, cost(BACKGROUND))
            assert sum(edit.cost for edit in found.edits) == found.distance
        found = compare(one, other, "levenshtein-effects", STILL)
        assert found.distance == recursive(effects(one, STILL), effects(other, STILL), effect_cost(STILL))
        assert compare(one, other, "states", STILL).distance == recursive(
            states(one, STILL), states(other, STILL), state_cost
        )


def test_an_apple_is_nearer_to_a_lemon_than_to_a_table() -> None:
    tree = BACKGROUND.tree
    assert tree.diameter == 6  # an apple, its class, fruit, thing, the root, cup, a cup
    assert [tree.entity_distance("a", other) * 6 for other in "ablty"] == [0, 2, 4, 5, 6]
    pick = [Atom("pick", ("r", each)) for each in "ablt"]
    assert [tree.atom_distance(pick[0], each) * 12 for each in pick] == [0, 2, 4, 5]
    assert tree.atom_distance(pick[0], Atom("place", ("r", "a"))) == 1


def test_the_costs_are_metrics_and_do_not_change_with_a_renaming(chance: Chance) -> None:
    tasks = tasks_for("levenshtein", chance, 10)
    for feature, cost in (
        (lambda task, _: task.actions, unit_cost(BACKGROUND)), (lambda task, _: task.actions, class_cost(BACKGROUND)),
        (effects, effect_cost(BACKGROUND)), (states, state_cost),
    ):  # fmt: skip
        symbols = list(dict.fromkeys(each for task in tasks for each in feature(task, BACKGROUND)))
        table = CostTable.of(symbols, cost)
        assert table.violation() == ""
        for names in itertools.islice(all_renamings(), 3, 6):
            others = [each for task in tasks for each in feature(renamed(task, names), BACKGROUND)]
            moved = dict(zip((e for task in tasks for e in feature(task, BACKGROUND)), others, strict=True))
            assert (CostTable.of([moved[each] for each in symbols], cost).costs == table.costs).all()


@pytest.mark.parametrize(
    ("cost", "reason"),
    [
        (lambda a, b: Fraction(1), "replacing p by itself costs 1"),
        (lambda a, b: Fraction(0), "replacing p by q costs nothing"),
        (lambda a, b: Fraction(int(a != b) * (2 if a == "q" else 1)), "replacing p by q costs 1, but"),
        (lambda a, b: Fraction(int(a != b) * (5 if {a, b} == {"p", "q"} else 1)), "replacing p by q costs more than"),
    ],
)  # fmt: skip
def test_costs_that_are_no_metric_are_reported_with_a_reason(cost: Callable[[Any, Any], Fraction], reason: str) -> None:
    assert CostTable.of(["p", "q"], cost).violation().startswith(reason)


def test_the_goal_is_what_changes_and_links_are_needs_with_their_producers() -> None:
    space = TaskSpace(load_domain("blocks"), 2)
    task = next(iter(space))
    final = task.states[-1]
    expected = {(fact, value) for fact, value in final.items() if task.initial[fact] != value}
    assert {*changes(task, space.background)} == expected
    first, second = task.actions
    for producer, fact, value, consumer, _ in links(task, space.background):
        assert value == (task.initial if producer is None else task.subgoals[0])[fact] and consumer in (first, second)
    assert {link[0] for link in links(task, space.background)} == {None, first}


def test_longest_common_runs_are_those_of_all_substrings(chance: Chance) -> None:
    from prag_asp.similarity.string_distances import substring_distance

    generator = chance.generator(3)
    for _ in range(chance.examples(60)):
        one, other = ("".join(generator.choices("ab", k=generator.randint(0, 6))) for _ in range(2))
        runs = {one[i:j] for i in range(len(one) + 1) for j in range(i, len(one) + 1)}
        assert substring_distance(one, other) == len(one) + len(other) - 2 * max(len(r) for r in runs if r in other)


def test_tasks_of_a_space_are_at_distance_0_of_all_their_plans_alone() -> None:
    space = TaskSpace(load_domain("prag"), 2)
    plans = [next(space.tasks_of_plans([plan])) for plan in itertools.islice(space.enumerate("plan"), 0, 300, 60)]
    for plan in plans:
        (rank,) = [n for n, task in enumerate(space) if plan.distance(task, "levenshtein", within=space) == 0]
        assert space.index(plan) == rank


def test_tasks_without_a_domain_match_by_names_or_by_classes(chance: Chance) -> None:
    task = random_task(chance.generator(5), 3)
    other = renamed(task, {"a": "b", "b": "c", "c": "a", "l": "m", "m": "l", "x": "y", "y": "x", "u": "v", "v": "u"})
    assert task.distance(other, "levenshtein") > 0
    assert task.distance(other, "levenshtein", up_to="classes") == 0
    clash = replace(other, entities={**other.entities, "t": "chair"})
    with pytest.raises(QueryError, match="t is of class table in one task and of class chair"):
        task.distance(clash)
    with pytest.raises(QueryError, match="no metric 'levenstein'; did you mean levenshtein"):
        task.distance(other, "levenstein")
    with pytest.raises(QueryError, match="not of 0 and 3 actions"):
        task.distance(random_task(chance.generator(5), 0), "hamming")


def test_classes_without_a_hierarchy_are_half_as_far_within_a_class() -> None:
    tree = Background(CLASSES).tree
    assert [tree.entity_distance("a", other) for other in "abt"] == [0, Fraction(1, 2), 1]
    assert PARENTS["apple"] == ("fruit",)


def test_a_fact_that_changes_its_value_costs_twice_one_that_becomes_known() -> None:
    true, false = (frozenset([(Atom("lit"), value)]) for value in (True, False))
    assert [state_cost(true, other) for other in (false, frozenset(), None)] == [2, 1, 2]
