"""The lengths of a task space, as users write them: a number, several numbers, or a text such as ``2..4``."""

from __future__ import annotations

import re
from collections.abc import Iterable

from prag_asp.errors import QueryError

RANGE = re.compile(r"-[0-9]+|(?P<first>[0-9]{1,999})(\s*\.\.\s*(?P<last>[0-9]{1,999}))?")
"""A number, or a range; Python does not convert numbers of arbitrarily many digits."""

LONGEST = 1_000_000
"""The largest length: the number of its plans may have a million digits, and time grows faster than the length."""


def parse_lengths(length: int | str | Iterable[int]) -> tuple[int, ...]:
    """Return the lengths that a value specifies, in its order.

    Raises:
        QueryError: there is no length, a length is not a whole number from 0 to `LONGEST`, or a length is repeated.
    """
    if isinstance(length, str):
        length = parse_range(length, f"length {length!r}")
    if not isinstance(length, Iterable):
        return (checked_length(length),)
    lengths = tuple(map(checked_length, length))
    if not lengths or len(set(lengths)) < len(lengths):
        raise QueryError(f"lengths {lengths}: give at least one, and each once")
    return lengths


def parse_range(
    text: str,
    what: str,
    *,
    longest: int | None = None,
    remedy: str = "write a whole number, such as 4, or A..B for all from A to B",
) -> int | range:
    """Return the length in a text such as ``4``, or all lengths of a range such as ``2..4``.

    Errors begin with `what`; `remedy` says how to write lengths.

    Raises:
        QueryError: the text is neither a length nor a range, or a length is above `longest` or `LONGEST`.
    """
    match = RANGE.fullmatch(text.strip())
    if match is None:
        raise QueryError(f"{what}: {remedy}")
    if match["first"] is None:
        raise QueryError(f"{what}: a plan has at least 0 actions")
    first, last = int(match["first"]), int(match["last"] or match["first"])
    if first > last:
        raise QueryError(f"{what}: the first is above the last; write {last}..{first}")
    if longest is not None and last > longest:
        raise QueryError(f"{what}: write whole numbers, none above {longest}")
    if last > LONGEST:
        raise QueryError(f"{what}: a plan has at most {LONGEST:,} actions")
    return first if match["last"] is None else range(first, last + 1)


def checked_length(length: object) -> int:
    """Return a valid length.

    Raises:
        QueryError: the length is not a whole number from 0 to `LONGEST`.
    """
    if not isinstance(length, int) or isinstance(length, bool):
        raise QueryError(f"length {length!r}: give a whole number, such as 4")
    if length < 0:
        raise QueryError(f"length {length}: a plan has at least 0 actions")
    if length > LONGEST:
        raise QueryError(f"length {length:,}: a plan has at most {LONGEST:,} actions")
    return length


def spelled_lengths(lengths: tuple[int, ...]) -> str:
    """Return lengths as a text, such as ``2..4`` if they are consecutive."""
    if len(lengths) > 1 and lengths == tuple(range(lengths[0], lengths[0] + len(lengths))):
        return f"{lengths[0]}..{lengths[-1]}"
    return ", ".join(map(str, lengths))
