"""Costs that a user gives make a metric or a dissimilarity with a reason, and treat interchangeable entities alike."""

from __future__ import annotations

import itertools
from fractions import Fraction

import pytest

from prag_asp import Atom, QueryError
from prag_asp.similarity import compare, metric_with_costs
from tests.chance import Chance
from tests.similarity.random_tasks import BACKGROUND, random_task

ACTIONS = [Atom(name, (one, other)) for name in ("put", "push") for one, other in itertools.permutations("abclt", 2)]


def by_name(one: Atom | None, other: Atom | None) -> Fraction:
    """Return 2 for another name, 1/2 for other objects, 1 for insertions."""
    if one is None or other is None:
        return Fraction(int(one is not other))
    return Fraction(2) if one.name != other.name else Fraction(int(one != other), 2)


def test_given_costs_are_used(chance: Chance) -> None:
    metric = metric_with_costs(by_name, ACTIONS, BACKGROUND)
    assert metric.axioms and metric.summary == "Edit distance with given costs"
    generator = chance.generator(1)
    one, other = (random_task(generator, 4) for _ in range(2))
    found = compare(one, other, metric, BACKGROUND)
    assert found.distance == sum(edit.cost for edit in found.edits) > 0
    assert compare(one, one, metric, BACKGROUND).distance == 0


def test_costs_that_are_no_metric_make_a_dissimilarity() -> None:
    metric = metric_with_costs(lambda one, other: 3 * by_name(one, other) if None not in (one, other) else 1, ACTIONS)
    assert not metric.axioms and metric.summary.startswith("Dissimilarity, because ")
    assert "costs more than by way of" in metric.summary or "by itself costs" in metric.summary


def test_costs_that_distinguish_interchangeable_entities_are_refused() -> None:
    def partial(one: Atom | None, other: Atom | None) -> int:
        return int(one != other) * (2 if one is not None and "a" in one.arguments else 1)

    with pytest.raises(QueryError, match="has another cost with a as b, though they are interchangeable"):
        metric_with_costs(partial, ACTIONS, BACKGROUND)
