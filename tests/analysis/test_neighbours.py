"""Neighbours are counted, and the nearest task is found, as a comparison with every task does."""

from __future__ import annotations

import pytest

from prag_asp import LimitReached, Limits, QueryError, TaskSpace, load_domain
from prag_asp.analysis import count_neighbours, nearest_task
from prag_asp.analysis.neighbours import METRICS
from tests.analysis.orbit_spaces import Orbits, orbit_spaces
from tests.chance import Chance
from tests.orbits.case import Case, Plan

LENGTHS = (1, 2, 3, 4)


def edits(one: Plan, other: Plan) -> int:
    """Return the Levenshtein distance by its definition."""
    row = list(range(len(other) + 1))
    for i, a in enumerate(one, 1):
        before, row = row, [i]
        for j, b in enumerate(other, 1):
            row.append(min(before[j] + 1, row[-1] + 1, before[j - 1] + (a != b)))
    return row[-1]


def differing(one: Plan, other: Plan) -> int | None:
    return sum(a != b for a, b in zip(one, other, strict=True)) if len(one) == len(other) else None


def distances(metric: str, plan: Plan, orbits: Orbits) -> list[int]:
    """Return the distance of a plan from each orbit that has one."""
    measure = edits if metric == "levenshtein" else differing
    found = ([measure(plan, each) for each in orbit] for orbit in orbits)
    return [min(each for each in own if each is not None) for own in found if None not in own]


def nearly(plans: list[Plan], case: Case, space: TaskSpace, chance: Chance) -> list[Plan]:
    """Return a plan, one with an action replaced and some left out, and none."""
    draw = chance.generator(len(plans))
    plan, actions = draw.choice(plans), [str(action) for action in space.domain.facts.actions]
    assert {*actions} <= {*case.actions}
    return [plan, (*plan[:1], draw.choice(actions), *plan[2:]), plan[1:], ()]


@pytest.mark.parametrize("metric", METRICS)
def test_neighbours_are_those_that_a_list_gives(metric: str, chance: Chance) -> None:
    for case, space, _ in orbit_spaces(chance, 7, 3):
        some = TaskSpace(space.domain, LENGTHS).where(space.condition)
        plans = [plan for length in LENGTHS for plan in case.plans(length)]
        orbits = list(case.orbits(plans))
        for plan in nearly(plans, case, space, chance):
            expected = distances(metric, plan, orbits)
            for radius in (0, 1, 2, 4):
                found = count_neighbours(some, plan, radius, metric)  # type: ignore[arg-type]
                assert found == tuple(expected.count(each) for each in range(radius + 1)), (plan, case.text())
            if not expected:
                with pytest.raises(QueryError, match="there is no task"):
                    nearest_task(some, plan, metric)  # type: ignore[arg-type]
                continue
            nearest = nearest_task(some, plan, metric)  # type: ignore[arg-type]
            assert nearest.distance == min(expected), (plan, case.text())
            (orbit,) = (orbit for orbit in orbits if nearest.plan in orbit)
            assert distances(metric, plan, [orbit]) == [nearest.distance]


def test_the_neighbours_of_all_radii_are_the_whole_space() -> None:
    space = TaskSpace(load_domain("prag"), 8)
    task = space[10**7]
    numbers = count_neighbours(space, task, 8)
    assert sum(numbers) == space.count() and numbers[0] == 1
    assert count_neighbours(space, task) == numbers[:4]
    assert all(ham <= lev for ham, lev in zip(count_neighbours(space, task, 7, "hamming"), numbers, strict=False))


def test_the_nearest_task_of_a_part_certifies_its_distance() -> None:
    training, test = TaskSpace(load_domain("prag"), 15).hold_out("can_1")
    task = test[10**13]
    nearest = nearest_task(training, task)
    uses = sum("can_1" in str(action) for action in task.actions)
    assert nearest.distance >= uses > 0 and nearest.plan in training
    assert sum(count_neighbours(training, task, nearest.distance)[:-1]) == 0
    assert nearest_task(test, task).distance == 0


def test_requests_without_an_answer_are_refused() -> None:
    space = TaskSpace(load_domain("blocks"), 2)
    plan = ["pick_up(a)", "stack(a,b)"]
    with pytest.raises(QueryError, match="give levenshtein or hamming"):
        count_neighbours(space, plan, metric="cosine")  # type: ignore[arg-type]
    with pytest.raises(QueryError, match="with 0 to 100 edits"):
        count_neighbours(space, plan, -1)
    with pytest.raises(QueryError, match="no action"):
        nearest_task(space, ["fly(a)"])
    with pytest.raises(QueryError, match="no task of blocks of length 2 to compare with a task of 1 actions"):
        nearest_task(space, plan[:1], "hamming")
    limited = TaskSpace(space.domain, 2)
    limited.count()
    object.__setattr__(limited.engines, "limits", Limits(seconds=0, since=0))
    with pytest.raises(LimitReached, match="take a smaller radius"):
        count_neighbours(limited, plan)
