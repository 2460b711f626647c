"""The condition ``shortest`` keeps the tasks whose shortest plans are as long as they are, at every level."""

from __future__ import annotations

import pytest

from prag_asp import EngineError, LimitReached, QueryError, TaskSpace, load_domain
from prag_asp.space import shortest_tasks
from prag_asp.space.emptiness import why_empty
from prag_asp.space.limits import UNLIMITED
from prag_asp.space.plans.shortest_plans import PlanSearch
from tests.analysis.orbit_spaces import orbit_spaces
from tests.chance import Chance

PRAG = TaskSpace(load_domain("prag"), 3)


def test_with_other_conditions_the_tasks_are_those_of_a_list(chance: Chance) -> None:
    kept = 0
    for case, space, _ in orbit_spaces(chance, chance.examples(6), 2):
        search, shortest = PlanSearch(space.engines.model), space.where("shortest")
        found = [search.solve(task.initial, task.goal, 2, UNLIMITED.begin()) for task in space]
        expected = [task for task, plans in zip(space, found, strict=True) if plans and plans.length == 2]
        assert list(shortest) == expected, case.text()
        assert shortest.count("plan") == sum(plan in shortest for plan in space.enumerate("plan"))
        assert shortest.count("skeleton") == len({task.skeleton for task in expected})
        kept += len(expected)
    assert kept


def test_ranks_samples_and_lengths_of_shortest_tasks_agree() -> None:
    shortest = PRAG.where("shortest")
    tasks = list(shortest)
    assert [shortest.index(task) for task in tasks[::10]] == list(range(0, shortest.count(), 10)) and len(tasks) > 100
    assert {str(task) for task in shortest.sample(50, seed=1, by="plan")} <= {
        *map(" ".join, shortest.enumerate("plan"))
    }
    assert len({str(task) for task in shortest.sample(len(tasks), seed=2, distinct=True)}) == len(tasks)
    assert shortest.at(0).count() == 1
    several = TaskSpace(load_domain("prag"), "0..2").where("shortest")
    assert several.count() == sum(shortest.at(length).count() for length in range(3))
    grasps = sum("grasp" in task.skeleton for task in tasks)
    assert shortest.where("has at least 1 grasp").count() == grasps > 0


def test_what_the_program_alone_cannot_answer_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    shortest = PRAG.at(2).where("shortest")
    for ask in (lambda: next(shortest.dimacs()), shortest.estimate, lambda: why_empty(shortest)):
        with pytest.raises(QueryError, match="does not state the condition shortest"):
            ask()
    with pytest.raises(EngineError, match="needs the engine automaton; got sat"):
        TaskSpace(load_domain("prag"), 2, engine="sat").where("shortest").count()
    monkeypatch.setattr(shortest_tasks, "MOST_STARTS", 2)
    with pytest.raises(LimitReached, match="different initial states, more than 2"):
        shortest.count()
