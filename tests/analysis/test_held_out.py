"""Combinations that are held out occur in test tasks only, and training covers all smaller ones, by a list of plans."""

from __future__ import annotations

import itertools
import random

import pytest

from prag_asp import QueryError, TaskSpace, load_domain
from prag_asp.analysis.covering import Combination, hold_out_combinations, reachable_combinations
from tests.analysis.orbit_spaces import domains
from tests.analysis.test_covering import combined
from tests.chance import Chance
from tests.domains import domain_of

PRAG = TaskSpace(load_domain("prag"), 15)


ENTITIES = {"x0": "c0", "x1": "c0", "x2": "c1"}


def drawn(chance: random.Random) -> tuple[str, set[tuple[str, ...]]]:
    """Return a domain of actions that may not follow each other at random, with its plans of three actions."""
    everything = [f"{name}({entity},{value})" for name in "mn" for entity in ENTITIES for value in "uvw"]
    actions = chance.sample(everything, chance.randint(6, 12))
    never = {(one, other) for one in actions for other in actions if chance.random() < 0.3}
    lines = ["class(c0). class(c1). fluent(f)."]
    lines += [f"entity({entity},{name})." for entity, name in ENTITIES.items()]
    lines += [f"action({action})." for action in actions]
    lines.append("#program step(t).")
    lines += [f":- occurs({one},t-1), occurs({other},t)." for one, other in sorted(never)]
    plans = {plan for plan in itertools.product(actions, repeat=3) if never.isdisjoint(itertools.pairwise(plan))}
    return "\n".join(lines) + "\n", plans


def test_training_covers_all_smaller_combinations_and_lacks_those_held_out(chance: Chance) -> None:
    found = 0
    for seed in range(domains(chance, 12)):
        text, plans = drawn(chance.generator(seed))
        space = TaskSpace(domain_of(text), 3)
        for strength in (1, 2):
            try:
                held = hold_out_combinations(space, strength, seed)
            except QueryError:
                continue
            training, test = held.parts(space)
            lacking = {plan for plan in plans if own(plan, strength + 1).isdisjoint(held.combinations)}
            assert set(training.enumerate("plan")) == lacking, text
            assert set(test.enumerate("plan")) == plans - lacking != set()
            assert set().union(*(own(plan, strength) for plan in lacking)) == set().union(
                *(own(plan, strength) for plan in plans)
            )
            assert training.count() + test.count() == space.count()
            found += 1
    assert found > 6


def own(plan: tuple[str, ...], strength: int) -> set[Combination]:
    return set().union(*(combined(action, ENTITIES, strength) for action in plan))


def test_long_tasks_are_split_exactly() -> None:
    held = hold_out_combinations(PRAG, 2, seed=1, at_most=2)
    training, test = held.parts(PRAG)
    assert len(held.combinations) == 2 and training.count() + test.count() == PRAG.count()
    assert reachable_combinations(training, 2) == reachable_combinations(PRAG, 2)
    assert reachable_combinations(PRAG, 3) - reachable_combinations(training, 3) == {*held.combinations}


def test_a_space_that_can_do_without_nothing_is_refused() -> None:
    with pytest.raises(QueryError, match="training needs every combination of 5 factors to cover those of 4"):
        hold_out_combinations(PRAG.at(2), 4)


def test_conditions_take_several_patterns() -> None:
    space = PRAG.at(3)
    either = space.where("has at least 2 grasp | rotate(_,box_1,_)")

    def counted(plan: tuple[str, ...]) -> int:
        return sum(each.startswith("grasp") or each.startswith("rotate(panda,box_1,") for each in plan)

    plans = list(space.enumerate("plan"))
    assert list(either.enumerate("plan")) == [plan for plan in plans if counted(plan) >= 2]
    assert str(either.condition) == "has at least 2 grasp | rotate(_,box_1,_)"
    with pytest.raises(QueryError, match="grip"):
        space.where("lacks grasp | grip").count()
