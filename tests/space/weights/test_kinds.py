"""Edges of one kind weigh the same, however many labels tell kinds apart."""

from __future__ import annotations

from fractions import Fraction
from itertools import islice, pairwise
from math import prod

import pytest

from prag_asp import TaskSpace, load_domain

PAIRS, ENTITIES = ("withdraw>approach", "approach>grasp", "rotate>rotate"), ("can_1", "crate_1")


def weigh(plan: tuple[str, ...], weights: dict[str, int]) -> int:
    """Return what a plan weighs by the definition: each pair as often as it occurs, each entity once."""
    names = [action.split("(")[0] for action in plan]
    pairs = prod(weights[f"{one}>{other}"] for one, other in pairwise(names) if f"{one}>{other}" in weights)
    return pairs * prod(weights[entity] for entity in ENTITIES if any(entity in action for action in plan))


@pytest.mark.parametrize("many", [None, 0])
def test_plans_weigh_what_their_pairs_and_entities_do(many: int | None, monkeypatch: pytest.MonkeyPatch) -> None:
    """With 0, kinds are numbered anew after every label."""
    if many is not None:
        monkeypatch.setattr("prag_asp.space.weights.weights.MANY_KINDS", many)
    weights = {name: number for number, name in enumerate((*PAIRS, *ENTITIES), 2)}
    space = TaskSpace(load_domain("prag"), 3)
    found = {plan: weigh(plan, weights) for plan in space.enumerate("plan")}
    assert len({*found.values()}) > 5
    assert space.sampling(weights=weights, by="plan").total_weight() == sum(found.values())
    for draw in islice(space.sampling(weights=weights, by="plan").draws(seed=1), 50):
        assert draw.probability == Fraction(found[draw.word], sum(found.values()))
