"""Parse the text of a TOML file, and find the line of a key."""

from __future__ import annotations

import re
import sys
from collections.abc import Iterator, Sequence
from contextlib import suppress
from decimal import Decimal, InvalidOperation
from pathlib import Path
from typing import Any

from prag_asp.errors import DomainError

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

HEADER = r"\s*\[{1,2}(?P<name>[^\[\]]*)\]{1,2}\s*(?:#.*)?$"
KEY = r"""\s*(?P<name>(?:"[^"]*"|'[^']*'|[\w.\- ])+?)\s*="""
INNER_KEY = r"""(?<=[{,])\s*([\w.-]+|"[^"]*")\s*="""
KEY_PART = r""""([^"]*)"|'([^']*)'|([\w-]+)"""


def parse_toml(path: Path, text: str) -> dict[str, Any]:
    """Return the table of a TOML text, with decimal numbers as `Decimal`, unrounded.

    Raises:
        DomainError: the text is not TOML.
    """
    try:
        table: dict[str, Any] = tomllib.loads(text, parse_float=Decimal)
    except tomllib.TOMLDecodeError as error:
        words = str(error)
        place = re.search(r" \(at (?:line (\d+)|end of document).*\)", words)
        line = place[1] if place and place[1] else str(len(text.rstrip().split("\n")))
        raise DomainError(f"{path}:{line}: not TOML: {words.split(' (at ', maxsplit=1)[0]}; fix the line") from None
    except (ValueError, RecursionError, InvalidOperation) as error:
        raise DomainError(f"{path}:1: not TOML: {error}; shorten its numbers and nested lists") from None
    return table


def key_line(text: str, keys: Sequence[str | int]) -> int:
    """Return the number of the first line that sets the key at the path `keys`, or else its innermost enclosing table.

    Indices in lists are ignored, so the line of a list item is that of the key of the list.
    """
    target = tuple(without_blanks(key) for key in keys if isinstance(key, str))
    best, depth = 1, 0
    for number, here in _keys(text):
        if here == target:
            return number
        if len(here) > depth and here == target[: len(here)]:
            best, depth = number, len(here)
    return best


def without_blanks(key: str) -> str:
    """Return a key without spaces around the arrow in a pair of actions, such as ``grasp>move``."""
    return ">".join(part.strip() for part in key.split(">"))


def _keys(text: str) -> Iterator[tuple[int, tuple[str, ...]]]:
    """Yield each key in a TOML text with the number of its line, including keys of inline tables."""
    table: tuple[str, ...] = ()
    until = ""
    for number, line in enumerate(text.split("\n"), 1):
        if until:
            until = "" if until in line else until
            continue
        header = re.match(HEADER, line)
        if header:
            table = _parts(header["name"])
            yield number, table
            continue
        key = re.match(KEY, line)
        if key:
            name = (*table, *_parts(key["name"]))
            yield number, name
            for inner in re.finditer(INNER_KEY, line[key.end() :]):
                yield number, (*name, *_parts(inner[1]))
        for quotes in ('"""', "'''"):
            until = quotes if line.count(quotes) % 2 else until


def _parts(name: str) -> tuple[str, ...]:
    """Return the parts of a dotted key, with quotes and escapes resolved."""
    parts = list[str]()
    for quoted, literal, bare in re.findall(KEY_PART, name):
        text = quoted
        with suppress(tomllib.TOMLDecodeError):
            text = str(tomllib.loads(f'key = "{quoted}"')["key"]) if "\\" in quoted else quoted
        parts.append(without_blanks(text + literal + bare))
    return tuple(parts)
