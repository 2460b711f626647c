"""Tasks as lines of JSON."""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from prag_asp.domain.atom import Atom, parse_atom
from prag_asp.errors import QueryError
from prag_asp.space.task import State, Task


@dataclass(frozen=True)
class Record:
    """A task with what physics said of it, as plain values; None where it was not asked."""

    task: Task
    verdict: Mapping[str, Any] | None = None
    witness: Mapping[str, Any] | None = None


def write_line(record: Record) -> str:
    """Return a record as one line of JSON, without the newline."""
    task = record.task
    return json.dumps(
        {
            "domain": task.domain,
            "actions": [str(action) for action in task.actions],
            "entities": dict(task.entities),
            "initial": _spelled(task.initial),
            "subgoals": [_spelled(state) for state in task.subgoals],
            "states": [_spelled(state) for state in task.states],
            "goal": _spelled(task.goal),
            "log_probability": task.log_probability,
            "verdict": record.verdict,
            "witness": record.witness,
        },
        allow_nan=False,
        separators=(",", ":"),
    )


def read_lines(lines: Iterable[str], name: str) -> Iterator[Record]:
    """Yield the records of lines of JSON; `name` is how errors call the file.

    Raises:
        QueryError: a line is no record; the message names it.
    """
    for number, line in enumerate(lines, 1):
        if line.strip():
            try:
                yield _record(json.loads(line))
            except (ValueError, KeyError, TypeError, AttributeError, RecursionError, QueryError) as error:
                what = f"{type(error).__name__}: {error}" if isinstance(error, KeyError) else str(error)
                raise QueryError(f"{name}:{number}: not a task: {what}; write tasks with --format jsonl") from None


def _record(values: Mapping[str, Any]) -> Record:
    task = Task(
        domain=str(values["domain"]),
        actions=tuple(map(parse_atom, values["actions"])),
        entities={str(entity): str(name) for entity, name in values["entities"].items()},
        initial=_parsed(values["initial"]),
        states=tuple(map(_parsed, values["states"])),
        subgoals=tuple(map(_parsed, values["subgoals"])),
        goal=_parsed(values["goal"]),
        log_probability=values.get("log_probability"),
    )
    if not len(task.actions) == len(task.states) == len(task.subgoals):
        raise QueryError("it needs one state and one subgoal for each action")
    return Record(task, values.get("verdict"), values.get("witness"))


def _spelled(state: State) -> dict[str, bool]:
    return {str(fluent): value for fluent, value in state.items()}


def _parsed(values: Mapping[str, bool]) -> dict[Atom, bool]:
    if not all(isinstance(value, bool) for value in values.values()):
        raise QueryError("a fluent is true or false")
    return {parse_atom(fluent): value for fluent, value in values.items()}
