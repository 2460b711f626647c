"""Tasks as lines of JSON: the text is that of a plain dictionary, and what is wrong is said in plain words."""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import Any

import pytest

from prag_asp import QueryError, Task, TaskSpace, load_domain
from prag_asp.dataset.jsonl import Record, read_lines, write_line

TASKS = TaskSpace(load_domain("prag"), 4).sample(30, seed=2, weights={"grasp": "1/3"})


def plain(values: Mapping[Any, Any]) -> dict[str, Any]:
    return {str(key): value for key, value in values.items()}


def as_dictionary(task: Task) -> dict[str, Any]:
    return {
        "domain": task.domain, "actions": list(map(str, task.actions)), "entities": plain(task.entities),
        "initial": plain(task.initial), "subgoals": list(map(plain, task.subgoals)),
        "states": list(map(plain, task.states)), "goal": plain(task.goal), "log_probability": task.log_probability,
        "verdict": {"status": "feasible"}, "witness": None,
    }  # fmt: skip


def test_a_line_is_the_json_of_the_task_and_reads_back_as_the_task() -> None:
    for task in TASKS:
        line = write_line(Record(task, {"status": "feasible"}))
        assert line == json.dumps(as_dictionary(task), separators=(",", ":"))
        (record,) = read_lines([line], "x")
        assert record.task == task and record.verdict == {"status": "feasible"} and record.witness is None


def test_a_task_with_plain_dictionaries_is_written_alike() -> None:
    task = TASKS[0]
    states = tuple(map(dict, task.states))
    own = Task(task.domain, task.actions, dict(task.entities), dict(task.initial), states, task.subgoals, task.goal)
    assert json.loads(write_line(Record(own)))["states"] == as_dictionary(task)["states"]


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"entities": "apple"}, "'entities' is a string, not an object"),
        ({"entities": {"apple_1": 3}}, "'apple_1' in 'entities' is a number, not a string"),
        ({"initial": ["open"]}, "'initial' is a list, not an object"),
        ({"initial": {"open(panda)": 1}}, "'open(panda)' in 'initial' is a number; a fluent is true or false"),
        ({"states": {}}, "'states' is an object, not a list"),
        ({"states": [3, 4]}, "item 1 of 'states' is a number, not an object"),
        ({"actions": [None]}, "item 1 of 'actions' is null, not a string"),
        ({"actions": ["grasp(panda"]}, "is not a ground atom"),
        ({"actions": []}, "one state and one subgoal for each action"),
        ({"domain": True}, "'domain' is true or false, not a string"),
        ({"log_probability": "small"}, "'log_probability' is a string, not a number or null"),
        ({"log_probability": False}, "'log_probability' is true or false, not a number or null"),
        ({"verdict": 3}, "'verdict' is a number, not an object or null"),
        ({"goal": None}, "'goal' is null, not an object"),
    ],
)
def test_a_field_of_the_wrong_type_is_named(change: dict[str, Any], words: str) -> None:
    lines = ["", write_line(Record(TASKS[0])), json.dumps({**as_dictionary(TASKS[0]), **change})]
    with pytest.raises(QueryError) as caught:
        list(read_lines(lines, "tasks.jsonl"))
    assert str(caught.value).startswith("tasks.jsonl:3: not a task: ") and words in str(caught.value)


@pytest.mark.parametrize(
    ("line", "words"),
    [("{", "it is not JSON"), ("[1]", "the line is a list, not an object"), ("{}", "it has no field 'domain'")],
)
def test_a_line_that_is_no_object_is_named(line: str, words: str) -> None:
    with pytest.raises(QueryError, match=rf"x:1: not a task: .*{words}"):
        list(read_lines([line], "x"))
