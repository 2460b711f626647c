"""The shortest plans to the goal of a task are those that a search through all complete states finds."""

from __future__ import annotations

from dataclasses import replace

import pytest

from prag_asp import LimitReached, Limits, TaskSpace, load_domain
from prag_asp.space.limits import UNLIMITED
from prag_asp.space.plans import shortest_plans
from prag_asp.space.plans.shortest_plans import PlanSearch, ShortestPlans
from prag_asp.task import Task
from tests.brute_force import agrees
from tests.chance import Chance
from tests.domains import domain_of
from tests.orbits.case import Case, Plan, Run
from tests.orbits.domains import draw_case

MOST = 150
"""Domains with more tasks are left out."""


def common(states: list[tuple[bool, ...]]) -> dict[int, bool]:
    """Return the values that all complete states share."""
    return {i: values[0] for i, values in enumerate(zip(*states, strict=True)) if len(set(values)) == 1}


class Oracle:
    """Plans of a case with their complete runs, with what is told of states and with all that is stated."""

    def __init__(self, case: Case, longest: int) -> None:
        self._case = case
        bare = replace(case.toy, impossible=())
        self._runs = [(case._runs_of(bare, n), case._runs_of(case.toy, n)) for n in range(longest + 1)]

    def told(self, plan: Plan) -> tuple[dict[int, bool], dict[int, bool]]:
        """Return what is known of the initial state of a task, and its goal."""
        goal = self._case.toy.goal
        runs = [run for run in self._runs[len(plan)][0][plan] if agrees(run[-1], goal)]
        return common([run[0] for run in runs]), goal or common([run[-1] for run in runs])

    def solving(self, initial: dict[int, bool], goal: dict[int, bool], length: int) -> int:
        """Return how many plans of a length lead from what is known of an initial state, and no more, to a goal."""
        bare, whole = self._runs[length]

        def fitting(runs: list[Run]) -> list[Run]:
            return [run for run in runs if agrees(run[0], initial) and agrees(run[-1], goal)]

        return sum(
            any(self._case.ending(self._case.named(run[-1])) for run in fitting(runs))
            and common([run[0] for run in fitting(bare[plan])]) == initial
            for plan, runs in whole.items()
        )


def test_shortest_plans_are_those_of_a_search_through_complete_states(chance: Chance) -> None:
    compared = detours = 0
    for seed in range(chance.examples(16)):
        case = replace(draw_case(chance.generator(seed)), clauses=())
        space = TaskSpace(domain_of(case.text()), 3)
        if space.engines.model.obstacles or not 0 < space.count("plan") <= MOST:
            continue
        search, oracle = PlanSearch(space.engines.model), Oracle(case, 3)
        shortest = []
        for task in space:
            initial, goal = oracle.told(tuple(map(str, task.actions)))
            numbers = [oracle.solving(initial, goal, length) for length in range(4)]
            length = next(length for length, number in enumerate(numbers) if number)
            assert solved(search, task) == ShortestPlans(length, numbers[length]), (str(task), case.text())
            compared += 1
            detours += 0 < length < 3
            shortest += [task] if length == 3 else []
        assert list(space.where("shortest")) == shortest, case.text()
    assert compared > 60 and detours > 10


def solved(search: PlanSearch, task: Task, limits: Limits = UNLIMITED) -> ShortestPlans | None:
    return search.solve(task.initial, task.goal, len(task), limits.begin())


def test_known_numbers_of_shortest_plans() -> None:
    blocks = TaskSpace(load_domain("blocks"), 6)
    search = PlanSearch(blocks.engines.model)
    plan = "pick_up(a) put_down(a) pick_up(b) stack(b,c) pick_up(a) stack(a,d)"
    assert solved(search, blocks[blocks.index(plan.split())]) == ShortestPlans(4, 2)  # either block first
    prag = TaskSpace(load_domain("prag"), 15)
    found = [solved(PlanSearch(prag.engines.model), prag[rank]) for rank in (0, 10**14)]
    assert found == [ShortestPlans(1, 1), ShortestPlans(8, 36)]  # 2 orders, 3 ways to carry, twice


def test_searches_that_are_kept_or_forgotten_find_the_same(monkeypatch: pytest.MonkeyPatch) -> None:
    tasks = TaskSpace(load_domain("prag"), 2)
    kept, forgotten = (PlanSearch(tasks.engines.model) for _ in range(2))
    found = [solved(kept, task) for task in tasks]
    again = [solved(kept, task) for task in reversed(list(tasks))][::-1]
    monkeypatch.setattr(shortest_plans, "MOST_KEPT", 1)
    assert found == again == [solved(forgotten, task) for task in tasks]
    assert len(kept._kept) == len({frozenset(task.initial.items()) for task in tasks}) > 1 == len(forgotten._kept)


def test_a_search_stops_at_its_limits(monkeypatch: pytest.MonkeyPatch) -> None:
    blocks = TaskSpace(load_domain("blocks"), 6)
    search, task = PlanSearch(blocks.engines.model), blocks.at(8)[-1]
    with pytest.raises(LimitReached, match="the time limit of 0 s was reached with 1 states"):
        solved(search, task, Limits(seconds=0, since=0))
    monkeypatch.setattr(shortest_plans, "MOST_STATES", 3)
    with pytest.raises(LimitReached, match="states from the initial state"):
        solved(search, task)
    assert search.solve(task.initial, {}, 0, Limits().begin()) == ShortestPlans(0, 1)
