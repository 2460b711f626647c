"""domain.toml: what a domain says beside its logic, all of it optional."""

from __future__ import annotations

import re
import sys
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from decimal import Decimal, InvalidOperation
from fractions import Fraction
from pathlib import Path
from typing import Any

from prag_asp.errors import DomainError
from prag_asp.program.sources import Source, read_text

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

KEYS = ("title", "description", "weights", "language", "scene")
MAX_EXPONENT = 1000
HEADER = r"\s*\[{1,2}(?P<name>[^\[\]]*)\]{1,2}\s*(?:#.*)?$"
KEY = r"""\s*(?P<name>(?:"[^"]*"|'[^']*'|[\w.\- ])+?)\s*="""
INNER_KEY = r"""(?<=[{,])\s*([\w.-]+|"[^"]*")\s*="""
KEY_PART = r""""([^"]*)"|'([^']*)'|([\w-]+)"""


@dataclass(frozen=True)
class Settings:
    """The tables of a domain.toml; `path` is the file, even where there is none, and `text` what it holds.

    `weights` belong to names of actions (``grasp``), pairs of consecutive ones (``grasp>move``), single
    actions, classes and entities; `language` maps names of actions and fluents to sentences, the first where there are
    several; `grammar` is that whole table, the languages below it included; `scene` is the table as physics reads it.
    """

    path: Path
    title: str = ""
    description: str = ""
    weights: Mapping[str, Fraction] = field(default_factory=dict)
    language: Mapping[str, str] = field(default_factory=dict)
    grammar: Mapping[str, Any] = field(default_factory=dict)
    scene: Mapping[str, Any] = field(default_factory=dict)
    text: str = field(default="", repr=False, compare=False)

    def line_of(self, *keys: str) -> int:
        """Return the line that sets the key reached through `keys`, or 1 where there is none."""
        return key_line(self.text, keys)


def read_table(path: Path) -> dict[str, Any]:
    """Return a TOML file as a table, its decimal numbers unrounded.

    Raises:
        DomainError: the file is missing, unreadable or not TOML.
    """
    return parse_table(Source(path, read_text(path)))


def parse_table(source: Source) -> dict[str, Any]:
    """Return the text of a TOML file as a table, its decimal numbers unrounded.

    Raises:
        DomainError: it is not TOML.
    """
    path, text = source.path, source.text
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


def settings_of(table: Mapping[str, Any], source: Source) -> Settings:
    """Return the settings that the table of a file spells, without what has a wrong type: the linter reports it."""
    weights = {key: weight_of(value) for key, value in _table(table, "weights").items()}
    grammar = _table(table, "language")
    return Settings(
        source.path,
        title=str(table.get("title", "")),
        description=str(table.get("description", "")),
        weights={weight_key(key): weight for key, weight in weights.items() if weight is not None},
        language={key: text for key, value in grammar.items() for text in _sentences(value)[:1]},
        grammar=grammar,
        scene=_rounded(_table(table, "scene")),
        text=source.text,
    )


def weight_key(key: str) -> str:
    """Return a key of the weights without blanks around the arrow of a pair: ``grasp>move``."""
    return ">".join(part.strip() for part in key.split(">"))


def key_shown(key: str) -> str:
    """Return a key as messages name it: in quotes where nobody would see it."""
    return key if key.strip() else f'"{key}"'


def weight_of(value: object) -> Fraction | None:
    """Return the exact value of a weight, None where it is not a number that is finite and not negative."""
    if isinstance(value, bool) or not isinstance(value, int | Decimal):
        return None
    if isinstance(value, Decimal) and (not value.is_finite() or abs(value.adjusted()) > MAX_EXPONENT):
        return None
    return Fraction(value) if value >= 0 else None


def _table(table: Mapping[str, Any], name: str) -> Mapping[str, Any]:
    found = table.get(name, {})
    return found if isinstance(found, Mapping) else {}


def _sentences(value: object) -> list[str]:
    """Return the sentences of a key of [language]: one, or several; none where it is a table."""
    return [each for each in (value if isinstance(value, list) else [value]) if isinstance(each, str)]


def _rounded(value: Any) -> Any:
    """Return a value with its decimals as floats: physics computes with them."""
    if isinstance(value, Mapping):
        return {key: _rounded(each) for key, each in value.items()}
    if isinstance(value, list):
        return [_rounded(each) for each in value]
    return float(value) if isinstance(value, Decimal) else value


def key_line(text: str, keys: Sequence[str]) -> int:
    """Return the first line that sets the key reached through `keys`, or the nearest table above it."""
    wanted = tuple(map(weight_key, keys))
    best, depth = 1, 0
    for number, here in _keys(text):
        if here == wanted:
            return number
        if len(here) > depth and here == wanted[: len(here)]:
            best, depth = number, len(here)
    return best


def _keys(text: str) -> Iterator[tuple[int, tuple[str, ...]]]:
    """Yield each key of a TOML text with the number of its line; keys of an inline table are yielded too."""
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
    parts = re.findall(KEY_PART, name)
    return tuple(weight_key(_unescaped(quoted) + literal + bare) for quoted, literal, bare in parts)


def _unescaped(text: str) -> str:
    """Return what is between the quotes of a key as the key that it spells."""
    try:
        return str(tomllib.loads(f'key = "{text}"')["key"]) if "\\" in text else text
    except tomllib.TOMLDecodeError:
        return text
