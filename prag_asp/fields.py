"""Read values of JSON: msgspec checks their kinds; what is wrong is told in plain words with the path to it.

A path begins with a name for the outermost value: ``witness.moments[2].arms.panda.joints``.
"""

from __future__ import annotations

import re
import sys
from collections.abc import Mapping, Sequence
from decimal import Decimal
from typing import Annotated, Any, TypeVar

import msgspec

from prag_asp.errors import QueryError

Kind = TypeVar("Kind")
Option = TypeVar("Option", bound=str)
Trail = tuple[str | int, ...]

Number = Annotated[float, msgspec.Meta(ge=-sys.float_info.max, le=sys.float_info.max)]
"""A finite number."""

Whole = Annotated[int, msgspec.Meta(ge=0)]
"""A whole number from 0."""

WORDS: Mapping[str, str] = {
    "array": "a list",
    "object": "an object with fields",
    "float": "a finite number",
    "int": "a whole number from 0",
    "str": "a string",
    "bool": "true or false",
    "null": "null",
}
"""What msgspec's names of kinds are called; a number is always finite here, and a whole one never negative."""

CONSTANTS: Mapping[str, bool | None] = {"null": None, "true": True, "false": False}
"""The words of JSON for what Python calls otherwise."""

LONGEST = 40
"""Characters of a wrong value that are shown."""


class FieldError(QueryError):
    """A value of JSON is of the wrong kind; `trail` leads to it: keys and positions from the outermost value."""

    def __init__(self, message: str, trail: Trail = ()) -> None:
        super().__init__(message)
        self.trail = trail


def decoded(text: str) -> Any:
    """Return the value that a text of JSON spells.

    Raises:
        QueryError: it is none, and why; NaN and infinity are no numbers of JSON.
    """
    try:
        return msgspec.json.decode(text)
    except msgspec.ValidationError:
        why = "a number is out of range"
    except msgspec.DecodeError as error:
        why = _with_column(str(error), text)
    except RecursionError:
        raise QueryError("its values are nested too deeply") from None
    raise QueryError(f"it is not JSON: {why}")


def read(data: object, kind: type[Kind], name: str) -> Kind:
    """Return a value of JSON as one of a kind that msgspec knows; paths begin with its `name`, which may be empty.

    Raises:
        FieldError: it is of another kind; the message names the field by its path.
    """
    try:
        return msgspec.convert(data, kind)
    except msgspec.ValidationError as error:
        what, _, place = str(error).partition(" - at ")
        trail = _trail(data, kind, str(error), re.findall(r"\.(\w+)|\[(\d+|\.\.\.)\]", place))
        missing = re.fullmatch(r"Object missing required field `(\w+)`", what)
        if missing:
            trail = (*trail, missing[1])
            raise FieldError(f"{_path(name, trail)}: is missing", trail) from None
        where = _path(name, trail)
        wrong = f"needs {_needed(what)}; got {shown(_at(data, trail))}"
        raise FieldError(f"{where}: {wrong}" if where else wrong, trail) from None


def one_of(options: Sequence[Option], value: str, name: str) -> Option:
    """Return one of some strings.

    Raises:
        QueryError: the value is none of them; the message begins with its path, which is `name`.
    """
    for option in options:
        if value == option:
            return option
    raise QueryError(f"{name}: needs one of {', '.join(options)}; got {shown(value)}")


def shown(value: object) -> str:
    """Return a value as one short line, a list by its length where it is long."""
    text = next((word for word, each in CONSTANTS.items() if value is each), None)
    if text is None:
        text = str(value) if isinstance(value, Decimal) else repr(value)
    if len(text) <= LONGEST:
        return text
    if isinstance(value, list):
        return f"a list of {len(value)}"
    return "an object" if isinstance(value, Mapping) else f"{text[:LONGEST]}..."


def _path(name: str, trail: Trail) -> str:
    """Return where a value stands: the `name` of the outermost one, then keys and positions."""
    steps = (f"[{step}]" if isinstance(step, int) else f".{step}" for step in trail)
    return f"{name}{''.join(steps)}".removeprefix(".")


def _with_column(why: str, text: str) -> str:
    """Return why a text is not JSON, with the column in place of the byte."""
    found = re.search(r" \(byte (\d+)\)", why)
    if found is None:
        return "it ends too early"
    column = len(text.encode()[: int(found[1])].decode(errors="ignore")) + 1
    return f"{why[: found.start()].removeprefix('JSON is malformed: ')} at column {column}"


def _needed(what: str) -> str:
    """Return in words what msgspec expected."""
    found = re.match(r"Expected `([^`]+)`(?: of length (\d+)| >= (\d+)| <= (\d+))?", what)
    if found is None:
        return WORDS["float"] if what == "Number out of range" else what
    kinds, length, least, most = found.groups()
    if kinds == "int" and (least or most):
        return f"a whole number from {least}" if least else f"a whole number up to {most}"
    words = " or ".join(WORDS.get(name, name) for name in kinds.split(" | "))
    return words if length is None else f"{words} of {length}"


def _trail(data: Any, kind: type[object], told: str, steps: Sequence[tuple[str, str]]) -> Trail:
    """Return the way from a value to the wrong one in it.

    msgspec says ``[...]`` for the key of a mapping: it is the one that is as wrong where it is alone.
    """
    trail: Trail = ()
    for name, number in steps:
        if name or number != "...":
            trail = (*trail, name or int(number))
            continue
        inner = _at(data, trail)
        alone = (key for key in inner if _told(_replaced(data, trail, {key: inner[key]}), kind) == told)
        trail = (*trail, next(alone, "..."))
    return trail


def _told(data: object, kind: type[object]) -> str:
    """Return what msgspec says is wrong with a value, nothing where it is of a kind."""
    try:
        msgspec.convert(data, kind)
    except msgspec.ValidationError as error:
        return str(error)
    return ""


def _at(data: Any, trail: Trail) -> Any:
    """Return what stands at the end of a way into a value."""
    for step in trail:
        data = data[step]
    return data


def _replaced(data: Any, trail: Trail, value: object) -> object:
    """Return a value in which what stands at the end of a way is another."""
    if not trail:
        return value
    inner = _replaced(data[trail[0]], trail[1:], value)
    if isinstance(data, Mapping):
        return {**data, trail[0]: inner}
    return [inner if i == trail[0] else each for i, each in enumerate(data)]
