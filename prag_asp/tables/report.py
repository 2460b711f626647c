"""Collect the problems of a table, each with its keys, a description and a remedy.

A reader goes through the entries of a table. An entry is a value with its keys. If the value is wrong, the entry
reports it, and the reader continues, so that a single run finds every problem.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from decimal import Decimal
from pathlib import Path
from typing import Any, NamedTuple

from prag_asp.errors import PragError, QueryError
from prag_asp.tables.toml_text import key_line
from prag_asp.wording import did_you_mean, nearest

Keys = tuple[str | int, ...]
"""The path to a value: names of keys, and indices in lists, from 0."""

LARGEST = 1e9
"""The largest number allowed in a table; it is far above any length in metres, angle in degrees or density."""

LONGEST = 40
"""The maximum number of characters of a wrong value in a message."""

CONSTANTS: Mapping[str, bool | None] = {"null": None, "true": True, "false": False}
"""The constants that TOML and JSON spell differently from Python."""


class TableProblem(NamedTuple):
    """One problem: the keys that lead to it, ``what is wrong; what to do``, and the name of a warning, if it is one."""

    keys: Keys
    text: str
    warning: str = ""

    def __str__(self) -> str:
        return f"{path_text(self.keys)}: {self.text}" if self.keys else self.text


@dataclass
class TableReport:
    """The problems of a table.

    `doubtful` holds names whose entries are wrong, so that nothing else is reported about them. `misspelt` holds keys
    that the table has under a similar name, so that they are not also reported as missing.
    """

    problems: list[TableProblem] = field(default_factory=list)
    doubtful: set[str] = field(default_factory=set)
    misspelt: set[Keys] = field(default_factory=set)

    def add(self, keys: Keys, text: str, warning: str = "") -> None:
        """Report a problem, unless its key is misspelt."""
        if keys not in self.misspelt:
            self.problems.append(TableProblem(keys, text, warning))

    def is_sound(self, keys: Keys) -> bool:
        """Return whether no problem has been reported for a value or anything in it."""
        return not any(problem.keys[: len(keys)] == keys for problem in self.problems)

    @contextmanager
    def errors_at(self, *keys: str | int) -> Iterator[None]:
        """Catch a `QueryError` in the block, and report each of its lines as a problem with the value at `keys`."""
        try:
            yield
        except QueryError as error:
            for line in error.lines:
                self.add(keys, line)

    def raise_problems(self, error: Callable[..., PragError], path: Path, text: str) -> None:
        """Raise all problems as one error, each with the line of its key in the file.

        Raises:
            PragError: there are problems; the error is of the given type.
        """
        if self.problems:
            raise error(*dict.fromkeys(f"{path}:{key_line(text, each.keys)}: {each}" for each in self.problems))


_NONE = object()
"""The marker for a missing default, because None is a possible default."""


@dataclass(frozen=True)
class TableEntry:
    """A value of a table with the keys that lead to it, and the report of its problems."""

    report: TableReport
    keys: Keys
    value: Any = None
    missing: bool = False

    def at(self, key: str | int, default: object = _NONE) -> TableEntry:
        """Return the entry at a key or index; for a missing key, the entry holds the `default`, if there is one."""
        keys = (*self.keys, key)
        if isinstance(self.value, Mapping) and key in self.value:
            return TableEntry(self.report, keys, self.value[key])
        if isinstance(self.value, list) and isinstance(key, int):
            return TableEntry(self.report, keys, self.value[key])
        return (
            TableEntry(self.report, keys, missing=True) if default is _NONE else TableEntry(self.report, keys, default)
        )

    def entries(self) -> Iterator[tuple[str, TableEntry]]:
        """Yield the name and the entry of each key of a table, or nothing if the value is not a table."""
        for name in self.value if isinstance(self.value, Mapping) else ():
            yield name, self.at(name)

    def items(self) -> Iterator[TableEntry]:
        """Yield the entry of each item of a list, or nothing if the value is not a list."""
        for place in range(len(self.value)) if isinstance(self.value, list) else ():
            yield self.at(place)

    @property
    def is_sound(self) -> bool:
        """Whether no problem has been reported for the value or anything in it."""
        return self.report.is_sound(self.keys)

    def add(self, text: str, warning: str = "") -> None:
        """Report a problem with this value."""
        self.report.add(self.keys, text, warning)

    def needs(self, what: str) -> None:
        """Report that the value is missing or wrong; `what` describes a correct value."""
        self.add(f"missing; write {what}" if self.missing else f"needs {what}; got {shown(self.value)}")

    def is_table(self, example: str, known: Collection[str] | None = None) -> bool:
        """Return whether the value is a table; report any other value, and keys that are not `known`."""
        if not isinstance(self.value, Mapping):
            self.needs(f"a table{f' {example}' if example else ''}")
            return False
        if known is not None:
            self.require_known(known)
        return True

    def section(self, key: str) -> TableEntry:
        """Return the entry of a subtable, or of an empty table if the value is missing or not a table."""
        entry = self.at(key, {})
        return entry if entry.is_table("") else TableEntry(self.report, entry.keys, {})

    def require_known(self, known: Collection[str]) -> None:
        """Report the keys of a table that are not in `known`."""
        for name, entry in self.entries():
            if name not in known:
                entry.add(f"unknown key; {did_you_mean(name, known)}")
                meant = nearest(name, known)
                if meant is not None and meant not in self.value:
                    self.report.misspelt.add((*self.keys, meant))

    def choice(self, options: Sequence[str], meaning: str = "") -> str | None:
        """Return the value if it is one of the options; report any other value, and return None."""
        if self.value in options:
            return str(self.value)
        self.needs(f"one of {', '.join(options)}{f' ({meaning})' if meaning else ''}")
        return None

    def number(self, low: float, high: float, unit: str) -> float | None:
        """Return the value if it is a number within limits; report any other value, and return None."""
        if is_number(self.value) and low <= self.value <= high:
            return float(self.value)
        self.needs(f"a number from {low:g} to {high:g} ({unit})")
        return None

    def numbers(self, count: int, what: str, low: float = -LARGEST, high: float = LARGEST) -> tuple[float, ...] | None:
        """Return the value if it consists of `count` numbers within limits, or report that it must be `what`."""
        value = self.value
        listed = isinstance(value, list) and len(value) == count
        if listed and all(is_number(each) and low <= each <= high for each in value):
            return tuple(map(float, value))
        self.needs(what)
        return None

    def matching(self, pattern: str, example: str) -> str | None:
        """Return the value if it is a string that the pattern matches entirely; report any other, and return None."""
        if isinstance(self.value, str) and re.fullmatch(pattern, self.value):
            return self.value
        self.needs(example)
        return None


def is_number(value: object) -> bool:
    """Return whether a value is a number that can be a length or an angle: finite, and at most `LARGEST`."""
    return isinstance(value, int | float) and not isinstance(value, bool) and abs(value) <= LARGEST


def path_text(keys: Keys) -> str:
    """Return the path to a value as text, such as ``parts.train.where[2]``; a blank key is in quotes."""
    steps = (f"[{key}]" if isinstance(key, int) else f".{key}" if key.strip() else f'."{key}"' for key in keys)
    return "".join(steps).removeprefix(".")


def shown(value: object) -> str:
    """Return a value as one short line, with a long list replaced by its length."""
    text = next((word for word, each in CONSTANTS.items() if value is each), None)
    if text is None:
        text = str(value) if isinstance(value, Decimal) else repr(value)
    if len(text) <= LONGEST:
        return text
    if isinstance(value, list):
        return f"a list of {len(value)}"
    return "an object" if isinstance(value, Mapping) else f"{text[:LONGEST]}..."
