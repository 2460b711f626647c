"""Tasks as lines of JSON."""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from functools import lru_cache
from pathlib import Path
from typing import Any

from prag_asp.atom import Atom, parse_atom
from prag_asp.errors import QueryError
from prag_asp.task import FrozenDict, Task


@dataclass(frozen=True)
class Record:
    """A task with what physics said of it, as plain values; None where it was not asked.

    `place` is the ``file:line`` that it was read from.
    """

    task: Task
    verdict: Mapping[str, Any] | None = None
    witness: Mapping[str, Any] | None = None
    place: str = field(default="", compare=False)


def write_line(record: Record) -> str:
    """Return a record as one line of JSON, without the newline."""
    task = record.task
    fields = {
        "domain": _json(task.domain),
        **({"constants": _json(dict(task.constants))} if task.constants else {}),
        "actions": _listed(map(_action_json, task.actions)),
        "entities": _mapping_json(task.entities),
        "initial": _mapping_json(task.initial),
        "subgoals": _listed(map(_mapping_json, task.subgoals)),
        "states": _listed(map(_mapping_json, task.states)),
        "goal": _mapping_json(task.goal),
        "log_probability": _json(task.log_probability),
        "verdict": _json(record.verdict),
        "witness": _json(record.witness),
    }
    return "{" + ",".join([f'"{name}":{text}' for name, text in fields.items()]) + "}"


def _listed(texts: Iterable[str]) -> str:
    return "[" + ",".join(texts) + "]"


_json = json.JSONEncoder(allow_nan=False, separators=(",", ":")).encode


@lru_cache(maxsize=1 << 14)
def _action_json(action: Atom) -> str:
    return _json(str(action))


def _mapping_json(values: Mapping[Any, Any]) -> str:
    """Return what a task knows as JSON; its own mappings are shared with other tasks, so their texts are kept."""
    return _frozen_json(values) if isinstance(values, FrozenDict) else _json(_spelled(values))


@lru_cache(maxsize=1 << 14)
def _frozen_json(values: FrozenDict[Any, Any]) -> str:
    return _json(_spelled(values))


def _spelled(values: Mapping[Any, Any]) -> dict[str, Any]:
    return {str(key): value for key, value in values.items()}


def read_tasks(file: str | Path) -> Iterator[Record]:
    """Yield the records of a file of JSON lines; what is not UTF-8 in it is told as any other mistake.

    Raises:
        OSError: the file cannot be read.
        QueryError: a line is no record; the message names it.
    """
    with Path(file).open(encoding="utf-8", errors="replace") as lines:
        yield from read_lines(lines, str(file))


def read_lines(lines: Iterable[str], name: str) -> Iterator[Record]:
    """Yield the records of lines of JSON; `name` is how errors call the file.

    Raises:
        QueryError: a line is no record; the message names it.
    """
    for number, line in enumerate(lines, 1):
        if line.strip():
            try:
                yield replace(_record(json.loads(line)), place=f"{name}:{number}")
            except json.JSONDecodeError as error:
                what = f"it is not JSON: {error.msg} at column {error.colno}"
            except RecursionError:
                what = "its values are nested too deeply"
            except (ValueError, QueryError) as error:
                what = str(error)
            else:
                continue
            raise QueryError(f"{name}:{number}: not a task: {what}; write tasks with --format jsonl") from None


def _record(values: Any) -> Record:
    if not isinstance(values, dict):
        raise QueryError(f"the line is {_kind(values)}, not an object")
    log_probability = _field(values, "log_probability", (int, float, type(None)), None)
    task = Task(
        domain=_field(values, "domain", str),
        actions=tuple(map(parse_atom, _items(values, "actions", str))),
        entities=FrozenDict(_strings(values, "entities")),
        initial=_known("initial", _field(values, "initial", dict)),
        states=tuple(_known("states", state) for state in _items(values, "states", dict)),
        subgoals=tuple(_known("subgoals", state) for state in _items(values, "subgoals", dict)),
        goal=_known("goal", _field(values, "goal", dict)),
        log_probability=log_probability,
        constants=FrozenDict(_strings(values, "constants", {})),
    )
    if not len(task.actions) == len(task.states) == len(task.subgoals):
        raise QueryError("it needs one state and one subgoal for each action")
    verdict, witness = (_field(values, key, (dict, type(None)), None) for key in ("verdict", "witness"))
    return Record(task, verdict, witness)


_NEEDED = object()


def _field(values: Mapping[str, Any], key: str, kind: type | tuple[type, ...], default: Any = _NEEDED) -> Any:
    """Return a field of one of some types.

    Raises:
        QueryError: it is missing and has no default, or has another type.
    """
    value = values.get(key, default)
    if value is _NEEDED:
        raise QueryError(f"it has no field {key!r}")
    kinds = kind if isinstance(kind, tuple) else (kind,)
    if not isinstance(value, kinds) or (isinstance(value, bool) and bool not in kinds):
        raise QueryError(f"{key!r} is {_kind(value)}, not {' or '.join(dict.fromkeys(map(_KINDS.__getitem__, kinds)))}")
    return value


def _items(values: Mapping[str, Any], key: str, kind: type) -> list[Any]:
    """Return the items of a list, all of one type.

    Raises:
        QueryError: it is missing or no list, or an item has another type.
    """
    items: list[Any] = _field(values, key, list)
    for place, item in enumerate(items, 1):
        if not isinstance(item, kind):
            raise QueryError(f"item {place} of {key!r} is {_kind(item)}, not {_KINDS[kind]}")
    return items


def _strings(values: Mapping[str, Any], key: str, default: Any = _NEEDED) -> dict[str, str]:
    found: dict[str, str] = _field(values, key, dict, default)
    for name, value in found.items():
        if not isinstance(value, str):
            raise QueryError(f"{name!r} in {key!r} is {_kind(value)}, not a string")
    return found


def _known(key: str, values: Mapping[str, Any]) -> FrozenDict[Atom, bool]:
    for fluent, value in values.items():
        if not isinstance(value, bool):
            raise QueryError(f"{fluent!r} in {key!r} is {_kind(value)}; a fluent is true or false")
    return FrozenDict({parse_atom(fluent): value for fluent, value in values.items()})


_KINDS: Mapping[type, str] = {
    dict: "an object",
    list: "a list",
    str: "a string",
    bool: "true or false",
    int: "a number",
    float: "a number",
    type(None): "null",
}


def _kind(value: object) -> str:
    return _KINDS[type(value)]
