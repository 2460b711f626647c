"""The tasks apart from another part are those that a comparison with each of its plans leaves."""

from __future__ import annotations

import pytest

from prag_asp import LimitReached, Limits, QueryError, TaskSpace, load_domain
from prag_asp.analysis import nearest_task, tasks_apart
from prag_asp.analysis.distant_tasks import words_apart
from prag_asp.analysis.layered_automaton import layered_words
from tests.analysis.orbit_spaces import orbit_spaces
from tests.analysis.test_neighbours import edits
from tests.chance import Chance

PRAG = TaskSpace(load_domain("prag"), 15)


def test_the_tasks_that_remain_are_those_that_a_list_leaves(chance: Chance) -> None:
    remaining = 0
    for case, space, _ in orbit_spaces(chance, 6, 3):
        action = chance.generator(5).choice(sorted({plan[1] for plan in space.enumerate("plan")}))
        name = action.partition("(")[0]
        training, test = space.hold_out(name)
        plans, tasks = list(training.enumerate("plan")), list(test.enumerate("task"))
        for distance in (1, 2, 3, 4):
            found = tasks_apart(test, training, distance)
            expected = [task for task in tasks if all(edits(task, plan) >= distance for plan in plans)]
            assert [tuple(map(str, task.actions)) for task in found] == expected, (name, distance, case.text())
            assert found.count() == len(expected)
            remaining += 0 < len(expected) < len(tasks)
    assert remaining


def test_tasks_are_certified_to_be_apart() -> None:
    training, test = PRAG.hold_out("can_1")
    apart = tasks_apart(test, training, 3)
    assert 0 < apart.count() < test.count()
    task = apart[10**9]
    assert apart.index(task) == 10**9 and nearest_task(training, task).distance >= 3
    near = next(task for task in test.sample(300, seed=1) if nearest_task(training, task).distance < 3)
    assert near not in apart
    with pytest.raises(QueryError, match="too near to the other part"):
        apart.index(near)
    assert tasks_apart(test, training, 1).count() == test.count()
    assert tasks_apart(test, test, 1).count() == 0


def test_wrong_requests_are_refused() -> None:
    training, test = PRAG.at(3).hold_out("can_1")
    with pytest.raises(QueryError, match="give one from 1 to 100"):
        tasks_apart(test, training, 0)
    with pytest.raises(QueryError, match="different interchangeable entities"):
        tasks_apart(test, PRAG.at(3).where("uses apple_1"), 2)
    words, plans = layered_words(test, "task"), layered_words(training, "plan")
    with pytest.raises(LimitReached, match="the time limit of 0 s was reached with 1 rows"):
        words_apart(words, plans, 2, Limits(seconds=0, since=0).begin())
