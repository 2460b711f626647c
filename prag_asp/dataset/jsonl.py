"""Tasks as lines of JSON."""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from fractions import Fraction
from functools import lru_cache
from pathlib import Path
from typing import Annotated, Any

import msgspec

from prag_asp.atom import Atom, parse_atom
from prag_asp.errors import QueryError
from prag_asp.safe_reading import LONGEST_LINE, lines_of, open_text
from prag_asp.tables.json_fields import Number, decoded, read
from prag_asp.task import FrozenDict, Task


@dataclass(frozen=True)
class Record:
    """A task with its verdict and witness as plain values; without physics, both are None.

    In a stratified sample, a record has the name of the `stratum` and the `weight` of the task. `place` is the source
    of the record as ``file:line``.
    """

    task: Task
    verdict: Mapping[str, Any] | None = None
    witness: Mapping[str, Any] | None = None
    place: str = field(default="", compare=False)
    stratum: str = ""
    weight: Fraction | None = None


def write_line(record: Record) -> str:
    """Return a record as one line of JSON, without the newline."""
    task = record.task
    fields = {
        "domain": _json(task.domain),
        **({"constants": _json(dict(task.constants))} if task.constants else {}),
        "actions": _listed(map(_shared_json, task.actions)),
        "entities": _mapping_json(task.entities),
        "initial": _mapping_json(task.initial),
        "subgoals": _listed(map(_mapping_json, task.subgoals)),
        "states": _listed(map(_mapping_json, task.states)),
        "goal": _mapping_json(task.goal),
        "log_probability": _json(task.log_probability),
        "verdict": _json(record.verdict),
        "witness": _json(record.witness),
    }
    if record.weight is not None:
        weight = {"stratum": record.stratum, "weight": str(record.weight), "weight_value": float(record.weight)}
        fields |= {name: _json(value) for name, value in weight.items()}
    return "{" + ",".join([f'"{name}":{text}' for name, text in fields.items()]) + "}"


def _listed(texts: Iterable[str]) -> str:
    return "[" + ",".join(texts) + "]"


_json = json.JSONEncoder(allow_nan=False, separators=(",", ":")).encode


def _mapping_json(values: Mapping[Any, Any]) -> str:
    return _shared_json(values) if isinstance(values, FrozenDict) else _shared_json.__wrapped__(values)


@lru_cache(maxsize=1 << 14)
def _shared_json(value: Atom | Mapping[Any, Any]) -> str:
    """Return an action or a mapping in a task as JSON, cached because tasks share most of these values."""
    return _json(str(value) if isinstance(value, Atom) else {str(key): each for key, each in value.items()})


def read_tasks(file: str | Path) -> Iterator[Record]:
    """Yield the records in a file of JSON lines.

    Raises:
        OSError: the file cannot be read.
        QueryError: a line is not a record or not valid UTF-8; the message gives the line.
    """
    with open_text(file) as stream:
        yield from read_lines(lines_of(stream), str(file))


class _Line(msgspec.Struct):
    """The fields of a line in a file, and their types."""

    domain: str
    actions: list[str]
    entities: dict[str, str]
    initial: dict[str, bool]
    subgoals: list[dict[str, bool]]
    states: list[dict[str, bool]]
    goal: dict[str, bool]
    log_probability: Number | None = None
    verdict: dict[str, Any] | None = None
    witness: dict[str, Any] | None = None
    constants: dict[str, str] = {}
    stratum: str = ""
    weight: Annotated[str, msgspec.Meta(pattern="^[0-9]{1,4000}(/[1-9][0-9]{0,3999})?$")] | None = None
    weight_value: Number | None = None


def read_lines(lines: Iterable[str], name: str) -> Iterator[Record]:
    """Yield the records in lines of JSON; `name` is the name of the file in errors.

    Raises:
        QueryError: a line is not a record; the message gives the line.
    """
    for number, line in enumerate(lines, 1):
        if len(line) > LONGEST_LINE:
            raise QueryError(f"{name}:{number}: not a task: the line is longer than {LONGEST_LINE:,} characters")
        if line.strip():
            try:
                values = read(decoded(line), _Line, "")
                task = Task(
                    domain=values.domain,
                    actions=tuple(map(parse_atom, values.actions)),
                    entities=FrozenDict(values.entities),
                    initial=_state(values.initial),
                    states=tuple(map(_state, values.states)),
                    subgoals=tuple(map(_state, values.subgoals)),
                    goal=_state(values.goal),
                    log_probability=values.log_probability,
                    constants=FrozenDict(values.constants),
                )
                if not len(task.actions) == len(task.states) == len(task.subgoals):
                    raise QueryError("it needs one state and one subgoal for each action")
            except QueryError as error:
                what = f"not a task: {error}; write tasks with --format jsonl"
                raise QueryError(f"{name}:{number}: {what}") from None
            weight = None if values.weight is None else Fraction(values.weight)
            yield Record(task, values.verdict, values.witness, f"{name}:{number}", values.stratum, weight)


def _state(values: Mapping[str, bool]) -> FrozenDict[Atom, bool]:
    return FrozenDict({parse_atom(fluent): value for fluent, value in values.items()})
