"""Parse the words of a command line: domains and the words after them, lengths, and constants."""

from __future__ import annotations

from collections.abc import Sequence

from prag_asp.errors import QueryError
from prag_asp.program.paths import is_file_name
from prag_asp.space.lengths import parse_length_list


def domain_and_others(words: Sequence[str]) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """Return the words that name a domain, and the words after them.

    A domain is a single word, or all files (and standard input) that come first.
    """
    count = 1
    while count < len(words) and all(map(is_file_name, words[: count + 1])):
        count += 1
    return tuple(words[:count]), tuple(words[count:])


def parse_lengths(text: str) -> int | Sequence[int]:
    """Return the length that a text gives, or all lengths of a range or a list such as ``3..6`` or ``2,4``.

    Raises:
        QueryError: the text is none of these.
    """
    return parse_length_list(text, f"--length {text}")


def parse_length(text: str) -> int:
    """Return the length that a text gives, which is a number of actions.

    Raises:
        QueryError: the text is not a number.
    """
    length = parse_length_list(text, f"--length {text}", remedy="write a whole number, such as 4")
    if not isinstance(length, int):
        raise QueryError(f"--length {text}: several lengths, but one is needed; give a number, such as 4")
    return length


def parse_constant_options(options: Sequence[str]) -> dict[str, str]:
    """Return the constants set by options of the form NAME=VALUE.

    Raises:
        QueryError: an option does not have this form, or a constant is set twice.
    """
    constants: dict[str, str] = {}
    for option in options:
        name, equals, value = option.partition("=")
        if not equals or not name.strip():
            raise QueryError(f"--const {option}: write NAME=VALUE, such as discs=4")
        if name.strip() in constants:
            raise QueryError(f"--const {name.strip()}: it is set twice; give it once")
        constants[name.strip()] = value.strip()
    return constants
