"""Tasks as lines of JSON: the text is that of a plain dictionary, and what is wrong is said in plain words."""

from __future__ import annotations

import json
import re
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
        ({"entities": "apple"}, "entities: needs an object with fields; got 'apple'"),
        ({"entities": {"apple_1": "apple", "apple_2": 3}}, "entities.apple_2: needs a string; got 3"),
        ({"initial": ["open"]}, "initial: needs an object with fields; got ['open']"),
        ({"initial": {"open(panda)": 1}}, "initial.open(panda): needs true or false; got 1"),
        ({"states": {}}, "states: needs a list; got {}"),
        ({"states": [3, 4]}, "states[0]: needs an object with fields; got 3"),
        ({"states": [{}, {"open(panda)": None}]}, "states[1].open(panda): needs true or false; got null"),
        ({"actions": [None]}, "actions[0]: needs a string; got null"),
        ({"actions": ["grasp(panda"]}, "is not a ground atom"),
        ({"actions": []}, "one state and one subgoal for each action"),
        ({"domain": True}, "domain: needs a string; got true"),
        ({"log_probability": "small"}, "log_probability: needs a finite number or null; got 'small'"),
        ({"log_probability": False}, "log_probability: needs a finite number or null; got false"),
        ({"log_probability": 10**400}, "log_probability: needs a finite number; got 1000"),
        ({"verdict": 3}, "verdict: needs an object with fields or null; got 3"),
        ({"goal": None}, "goal: needs an object with fields; got null"),
    ],
)
def test_a_field_of_the_wrong_type_is_named(change: dict[str, Any], words: str) -> None:
    lines = ["", write_line(Record(TASKS[0])), json.dumps({**as_dictionary(TASKS[0]), **change})]
    with pytest.raises(QueryError) as caught:
        list(read_lines(lines, "tasks.jsonl"))
    assert str(caught.value).startswith("tasks.jsonl:3: not a task: ") and words in str(caught.value)


@pytest.mark.parametrize(
    ("line", "words"),
    [
        ("{", "it is not JSON: it ends too early"),
        ('{"é": NaN}', "it is not JSON: invalid character at column 7"),
        ('{"domain": Infinity}', "it is not JSON: invalid character at column 12"),
        ('{"witness": [1e999]}', "it is not JSON: a number is out of range"),
        ('{"domain": "\\ud800"}', "it is not JSON: "),
        ('{"domain": "a"} {}', "it is not JSON: trailing characters at column"),
        ("[" * 100_000 + "]" * 100_000, "its values are nested too deeply"),
        ("[1]", "needs an object with fields; got [1]"),
        ("{}", "domain: is missing"),
    ],
)
def test_a_line_that_is_no_object_is_named(line: str, words: str) -> None:
    with pytest.raises(QueryError, match=rf"^x:1: not a task: {re.escape(words)}.*; write tasks with --format jsonl$"):
        list(read_lines([line], "x"))
