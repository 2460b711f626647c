"""What the words of a command line mean that several commands read: domains before other words, lengths."""

from __future__ import annotations

import re
from collections.abc import Sequence

from prag_asp.errors import QueryError
from prag_asp.program.paths import is_file_name

LONGEST_SIZE = 20

MOST_LENGTHS = 1_000_000
"""How many lengths are asked about at once, at most: each takes memory of its own."""

RANGE = re.compile(r"(?P<first>\d+)\.\.(?P<last>\d+)")


def domain_and_others(words: Sequence[str]) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """Return the words that give a domain, and those after it.

    A domain is one word, or all files (and standard input) that come first: they tell themselves from other words.
    """
    count = 1
    while count < len(words) and all(map(is_file_name, words[: count + 1])):
        count += 1
    return tuple(words[:count]), tuple(words[count:])


def one_or_more_lengths(text: str) -> int | range:
    """Return the number of actions that a text states, or all numbers from one to another: ``3..6``.

    Raises:
        QueryError: it states none.
    """
    found = RANGE.fullmatch(text.strip())
    if found is None:
        return _number(text, "write a whole number, such as 4, or A..B for all from A to B")
    first, last = int(found["first"]), int(found["last"])
    if first > last:
        raise QueryError(f"--length {text}: the first is above the last; write {last}..{first}")
    if last - first >= MOST_LENGTHS:
        raise QueryError(f"--length {text}: more than {MOST_LENGTHS:,} lengths; ask for fewer at once")
    return range(first, last + 1)


def one_length(text: str) -> int:
    """Return the number of actions that a text states.

    Raises:
        QueryError: it states none, or a range.
    """
    if RANGE.fullmatch(text.strip()):
        raise QueryError(f"--length {text}: a range, but one length is needed; give a number, such as 4")
    return _number(text, "write a whole number, such as 4")


def pixels(text: str) -> tuple[int, int]:
    """Return the width and height that an option states.

    Raises:
        QueryError: it is not of the form WxH.
    """
    width, _, height = text.partition("x")
    if not (width.isdecimal() and height.isdecimal() and len(text) <= LONGEST_SIZE):
        raise QueryError(f"--size {text}: write WIDTHxHEIGHT in pixels, such as 480x420")
    return int(width), int(height)


def _number(text: str, hint: str) -> int:
    try:
        number = int(text)
    except ValueError:
        raise QueryError(f"--length {text}: {hint}") from None
    if number < 0:
        raise QueryError(f"--length {text}: a plan has at least 0 actions")
    return number
