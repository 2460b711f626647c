"""Read values of JSON, each with its path, so that a wrong one can be named: ``witness.moments[2].joints``."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, TypeVar

from prag_asp.errors import QueryError

Option = TypeVar("Option", bound=str)

LONGEST = 40
"""Characters of a wrong value that are shown."""


@dataclass(frozen=True)
class Field:
    """A value of JSON, and the path to it from the outermost value."""

    value: Any
    path: str

    def wrong(self, needed: str) -> QueryError:
        """Return the error that a value is not what is needed."""
        return QueryError(f"{self.path}: needs {needed}; got {shown(self.value)}")

    def field(self, name: str) -> Field:
        """Return a field of an object.

        Raises:
            QueryError: this is no object, or has no such field.
        """
        fields = self._members()
        if name not in fields:
            raise QueryError(f"{self.path}.{name}: is missing")
        return Field(fields[name], f"{self.path}.{name}")

    def optional(self, name: str) -> Field | None:
        """Return a field of an object, None where it is missing or null.

        Raises:
            QueryError: this is no object.
        """
        value = self._members().get(name)
        return None if value is None else Field(value, f"{self.path}.{name}")

    def known(self, name: str) -> Field | None:
        """Return a field of an object, None where it is null.

        Raises:
            QueryError: this is no object, or has no such field.
        """
        found = self.field(name)
        return None if found.value is None else found

    def items(self) -> Iterator[tuple[str, Field]]:
        """Yield the names and the fields of an object.

        Raises:
            QueryError: this is no object.
        """
        for name, value in self._members().items():
            yield str(name), Field(value, f"{self.path}.{name}")

    def entries(self, needed: str, count: int | None = None) -> list[Field]:
        """Return the entries of a list, of `count` where that is given; `needed` says in words what that is.

        Raises:
            QueryError: this is no list, or one of another length.
        """
        if not isinstance(self.value, list) or count not in (None, len(self.value)):
            raise self.wrong(needed)
        return [Field(value, f"{self.path}[{i}]") for i, value in enumerate(self.value)]

    def numbers(self, count: int) -> tuple[float, ...]:
        """Return a list of finite numbers.

        Raises:
            QueryError: this is none, or one of another length.
        """
        return tuple(entry.number() for entry in self.entries(f"{count} numbers", count))

    def number(self) -> float:
        """Return a finite number.

        Raises:
            QueryError: this is none.
        """
        if not is_finite(self.value):
            raise self.wrong("a finite number")
        return float(self.value)

    def whole(self) -> int:
        """Return a whole number that is not negative.

        Raises:
            QueryError: this is none.
        """
        if not isinstance(self.value, int) or isinstance(self.value, bool) or self.value < 0:
            raise self.wrong("a whole number from 0")
        return self.value

    def text(self) -> str:
        """Return a string.

        Raises:
            QueryError: this is none.
        """
        if not isinstance(self.value, str):
            raise self.wrong("a string")
        return self.value

    def choice(self, options: Sequence[Option]) -> Option:
        """Return one of some strings.

        Raises:
            QueryError: this is none of them.
        """
        for option in options:
            if self.value == option:
                return option
        raise self.wrong(f"one of {', '.join(options)}")

    def _members(self) -> Mapping[str, Any]:
        """Return an object.

        Raises:
            QueryError: this is none.
        """
        if not isinstance(self.value, Mapping):
            raise self.wrong("an object with fields")
        return self.value


def is_finite(value: object) -> bool:
    """Tell whether a value is a finite number that a float can hold."""
    if isinstance(value, bool) or not isinstance(value, int | float):
        return False
    try:
        return math.isfinite(value)
    except OverflowError:
        return False


def shown(value: object) -> str:
    """Return a value as one short line, a list by its length where it is long."""
    text = "null" if value is None else repr(value)
    if len(text) <= LONGEST:
        return text
    if isinstance(value, list):
        return f"a list of {len(value)}"
    return "an object" if isinstance(value, Mapping) else f"{text[:LONGEST]}..."
