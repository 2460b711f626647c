"""The lengths of a task space, as users write them: a number, several numbers, or a text such as ``2..4,7``."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from itertools import chain, pairwise

from prag_asp.errors import QueryError

RANGE = re.compile(r"-[0-9]+|(?P<first>[0-9]{1,999})(\s*\.\.\s*(?P<last>[0-9]{1,999}))?")
"""The pattern of a number or a range; Python does not convert numbers with arbitrarily many digits."""

LONGEST = 1_000_000
"""The largest length: its number of plans may have a million digits, and time grows faster than the length."""


def parse_lengths(length: int | str | Iterable[int]) -> tuple[int, ...]:
    """Return the lengths that a value specifies, in the given order.

    Raises:
        QueryError: there is no length, a length is not a whole number from 0 to `LONGEST`, or a length is repeated.
    """
    if isinstance(length, str):
        length = parse_length_list(length, f"length {length!r}")
    if not isinstance(length, Iterable):
        return (checked_length(length),)
    lengths = tuple(map(checked_length, length))
    if not lengths or len(set(lengths)) < len(lengths):
        raise QueryError(f"lengths {lengths}: give at least one, and each once")
    return lengths


ADVICE = "write a whole number, such as 4, A..B for all from A to B, or several with commas between them"
"""How to write lengths."""


def parse_length_list(text: str, what: str, *, remedy: str = ADVICE) -> int | Sequence[int]:
    """Return the length in a text such as ``4``, or the lengths of a range or a list such as ``2..4,7``, ascending.

    The messages of errors begin with the text `what`; the text `remedy` tells the user how to write lengths.

    Raises:
        QueryError: an item is neither a length nor a range, a length occurs twice, or one is above `LONGEST`.
    """
    items = text.split(",")
    if len(items) == 1:
        return parse_range(text, what, remedy=remedy)
    ranges = [parse_range(item, what, remedy=remedy) for item in items]
    lengths = tuple(sorted(chain.from_iterable([each] if isinstance(each, int) else each for each in ranges)))
    repeated = next((first for first, second in pairwise(lengths) if first == second), None)
    if repeated is not None:
        raise QueryError(f"{what}: the length {repeated} occurs twice; give each length once")
    return lengths


def parse_range(text: str, what: str, *, longest: int | None = None, remedy: str = ADVICE) -> int | range:
    """Return the length in a text such as ``4``, or all lengths of a range such as ``2..4``; see `parse_length_list`.

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
