"""What tasks share cannot be changed, and is a value like any other."""

from __future__ import annotations

import copy
import pickle

import pytest

from prag_asp import Task, TaskSpace, load_domain
from prag_asp.task import FrozenDict

SPACE = TaskSpace(load_domain("prag"), 4)


def test_a_frozen_dictionary_equals_a_plain_one_and_refuses_changes() -> None:
    frozen = FrozenDict({"a": 1, "b": 2})
    assert frozen == {"b": 2, "a": 1} and frozen != {"a": 1}
    assert hash(frozen) == hash(FrozenDict({"b": 2, "a": 1}))
    for change in (
        lambda: frozen.__setitem__("a", 3), lambda: frozen.__delitem__("a"), lambda: frozen.update(a=3),
        lambda: frozen.pop("a"), frozen.popitem, frozen.clear,
        lambda: frozen.setdefault("c", 3), lambda: frozen.__ior__({"a": 3}),
    ):  # fmt: skip
        with pytest.raises(TypeError, match="cannot be changed"):
            change()
    assert frozen == {"a": 1, "b": 2} and dict(frozen) == {"a": 1, "b": 2}
    assert copy.deepcopy(frozen) is copy.copy(frozen) is frozen


def test_tasks_are_values_that_can_be_compared_hashed_and_pickled() -> None:
    tasks = SPACE.sample(50, seed=1)
    again: list[Task] = pickle.loads(pickle.dumps(tasks))
    assert again == tasks and set(again) == set(tasks) and len(set(tasks)) > 40
    assert hash(tasks[0]) == hash(again[0])


def test_equal_states_of_different_tasks_are_one_object() -> None:
    tasks = SPACE.sample(400, seed=1)
    by_value: dict[object, int] = {}
    states = [state for task in tasks for state in (task.initial, *task.states)]
    assert all(by_value.setdefault(state, id(state)) == id(state) for state in states)
    assert len(by_value) < len(states) / 2
