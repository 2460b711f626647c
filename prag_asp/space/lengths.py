"""The lengths of a task space, as users write them: a number, several numbers, or a text such as ``2..4``."""

from __future__ import annotations

import re
from collections.abc import Iterable

from prag_asp.errors import QueryError

RANGE = re.compile(r"\s*(?P<first>[0-9]{1,9})\s*(\.\.\s*(?P<last>[0-9]{1,9})\s*)?", re.ASCII)

MOST = 100_000
"""Maximum number of lengths of one space, on the command line and in suite tables as well."""


def parse_lengths(length: int | str | Iterable[int]) -> tuple[int, ...]:
    """Return the lengths that a value states, in its order.

    Raises:
        QueryError: there is none, one is no whole number of at least 0, or one is repeated.
    """
    if isinstance(length, int):
        return (checked_length(length),)
    if isinstance(length, str):
        parts = RANGE.fullmatch(length)
        if parts is None:
            raise QueryError(f"length {length!r}: write a whole number, such as 4, or a range, such as 2..4")
        first = int(parts["first"])
        length = range(first, int(parts["last"] or first) + 1)
        if len(length) > MOST:
            raise QueryError(f"length {first}..{length[-1]}: more than {MOST:,} lengths; give fewer")
    if not isinstance(length, Iterable):
        return (checked_length(length),)
    lengths = tuple(map(checked_length, length))
    if not lengths or len(set(lengths)) < len(lengths):
        raise QueryError(f"lengths {lengths}: give at least one, and each once")
    return lengths


def checked_length(length: object) -> int:
    """Return a length.

    Raises:
        QueryError: it is no whole number of at least 0.
    """
    if not isinstance(length, int) or isinstance(length, bool):
        raise QueryError(f"length {length!r}: give a whole number, such as 4")
    if length < 0:
        raise QueryError(f"length {length}: a plan has at least 0 actions")
    return length


def spelled_lengths(lengths: tuple[int, ...]) -> str:
    """Return lengths as a text, ``2..4`` where they are consecutive."""
    if len(lengths) > 1 and lengths == tuple(range(lengths[0], lengths[0] + len(lengths))):
        return f"{lengths[0]}..{lengths[-1]}"
    return ", ".join(map(str, lengths))
