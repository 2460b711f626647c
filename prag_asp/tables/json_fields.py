"""Read JSON values: msgspec checks their types, and its messages are turned into plain words with a path.

A path begins with the name of the outermost value: ``witness.moments[2].arms.panda.joints``.
"""

from __future__ import annotations

import math
import re
import sys
from collections.abc import Mapping, Sequence
from typing import Annotated, Any, TypeVar, get_args, get_type_hints

import msgspec

from prag_asp.errors import QueryError
from prag_asp.tables.report import Keys, TableEntry, TableProblem, shown

Kind = TypeVar("Kind")

Number = Annotated[float, msgspec.Meta(ge=-sys.float_info.max, le=sys.float_info.max)]
"""A finite number."""

Whole = Annotated[int, msgspec.Meta(ge=0)]
"""A whole number of at least 0."""

WORDS: Mapping[str, str] = {
    "array": "a list",
    "object": "an object with fields",
    "float": "a finite number",
    "int": "a whole number from 0",
    "str": "a string",
    "bool": "true or false",
    "null": "null",
}
"""The types that msgspec names, in words; here, numbers are always finite, and integers are never negative."""


def decoded(text: str) -> Any:
    """Return the value of a JSON text.

    Raises:
        QueryError: the text is not JSON (NaN and infinity are not JSON numbers); the message gives the reason.
    """
    try:
        return msgspec.json.decode(text)
    except msgspec.ValidationError:
        why = "a number is out of range"
    except msgspec.DecodeError as error:
        place = re.search(r" \(byte (\d+)\)", str(error))
        if place is None:
            why = "it ends too early"
        else:
            column = len(text.encode()[: int(place[1])].decode(errors="ignore")) + 1
            why = f"{str(error)[: place.start()].removeprefix('JSON is malformed: ')} at column {column}"
    except RecursionError:
        raise QueryError("its values are nested too deeply") from None
    raise QueryError(f"it is not JSON: {why}")


def read(data: object, kind: type[Kind], name: str) -> Kind:
    """Return a JSON value converted to a type that msgspec supports; paths begin with its `name`, which may be empty.

    Raises:
        QueryError: the value does not have the type; the message gives the path to the wrong field.
    """
    try:
        return msgspec.convert(data, kind)
    except msgspec.ValidationError as error:
        problem = _problem(data, kind, str(error))
        raise QueryError(str(problem._replace(keys=(name, *problem.keys) if name else problem.keys))) from None


def read_entry(entry: TableEntry, kind: type[Kind]) -> Kind | None:
    """Return an entry's value converted to a type that msgspec supports; if this fails, report it and return None."""
    try:
        return msgspec.convert(entry.value, kind)
    except msgspec.ValidationError as error:
        keys, text, _ = _problem(entry.value, kind, str(error))
        entry.report.add((*entry.keys, *keys), text)
        return None


def _problem(data: object, kind: type[object], message: str) -> TableProblem:
    """Return msgspec's error about a value as a problem, whose keys begin at that value."""
    what, _, place = message.partition(" - at ")
    keys = _keys(data, kind, message, re.findall(r"\.(\w+)|\[(\d+|\.\.\.)\]", place))
    missing = re.fullmatch(r"Object missing required field `(\w+)`", what)
    if missing:
        return TableProblem((*keys, missing[1]), "is missing")
    if what.startswith("Invalid enum value"):
        inner: Any = kind
        for key in keys:
            inner = get_type_hints(inner)[str(key)]
        options = get_args(inner) or tuple(member.value for member in inner)  # of a `Literal`, or of an enumeration
        return TableProblem(keys, f"needs one of {', '.join(options)}; got {shown(str(_at(data, keys)))}")
    return TableProblem(keys, f"needs {_needed(what)}; got {shown(_at(data, keys))}")


def require_complete(data: Any, written: object, name: str) -> None:
    """Check that a JSON value is complete: no field is missing, and all numbers are finite.

    `written` is the JSON value that results from reading `data` and writing it again.

    Raises:
        QueryError: something is missing or not finite; the message begins with its path.
    """
    if isinstance(written, Mapping):
        for key, value in written.items():
            if key not in data:
                raise QueryError(f"{name}.{key}: is missing")
            require_complete(data[key], value, f"{name}.{key}")
    elif isinstance(written, list):
        if len(data) != len(written):
            raise QueryError(f"{name}: needs a list of {len(written)}; got {shown(data)}")
        for i, value in enumerate(written):
            require_complete(data[i], value, f"{name}[{i}]")
    elif isinstance(written, float) and not math.isfinite(written):
        raise QueryError(f"{name}: needs {WORDS['float']}; got {shown(data)}")


def _needed(what: str) -> str:
    """Return the value that msgspec expected, in words."""
    match = re.match(r"Expected `([^`]+)`(?: of length (\d+)| >= (\d+)| <= (\d+))?", what)
    if match is None:
        return WORDS["float"] if what == "Number out of range" else what
    kinds, length, least, most = match.groups()
    if kinds == "int" and (least or most):
        return f"a whole number from {least}" if least else f"a whole number up to {most}"
    words = " or ".join(WORDS.get(name, name) for name in kinds.split(" | "))
    return words if length is None else f"{words} of {length}"


def _keys(data: Any, kind: type[object], message: str, steps: Sequence[tuple[str, str]]) -> Keys:
    """Return the keys that lead from a value to the wrong value in it.

    msgspec writes ``[...]`` for the key of a mapping; the wrong entry is found because a mapping that contains only
    that entry leads to the same message.
    """
    keys: Keys = ()
    for name, number in steps:
        if name or number != "...":
            keys = (*keys, name or int(number))
            continue
        inner = _at(data, keys)
        alone = (key for key in inner if _message(_replaced(data, keys, {key: inner[key]}), kind) == message)
        keys = (*keys, next(alone, "..."))
    return keys


def _message(data: object, kind: type[object]) -> str:
    """Return msgspec's message about a value, or "" if it has the type."""
    try:
        msgspec.convert(data, kind)
    except msgspec.ValidationError as error:
        return str(error)
    return ""


def _at(data: Any, keys: Keys) -> Any:
    """Return the value to which keys lead."""
    for key in keys:
        data = data[key]
    return data


def _replaced(data: Any, keys: Keys, value: object) -> object:
    """Return a copy of `data` in which the value to which keys lead is replaced."""
    if not keys:
        return value
    inner = _replaced(data[keys[0]], keys[1:], value)
    if isinstance(data, Mapping):
        return {**data, keys[0]: inner}
    return [inner if i == keys[0] else each for i, each in enumerate(data)]
