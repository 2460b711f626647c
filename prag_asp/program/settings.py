"""The optional settings of a domain in domain.toml."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from decimal import Decimal
from fractions import Fraction
from pathlib import Path
from typing import Any

from prag_asp.exact_numbers import MAX_EXPONENT
from prag_asp.program.sources import Source, read_text
from prag_asp.tables.toml_text import key_line, parse_toml, without_blanks

KEYS = ("title", "description", "weights", "language", "scene")


@dataclass(frozen=True)
class Settings:
    """The tables of a domain.toml; `path` is its path even if the file does not exist, and `text` its contents.

    The keys of `weights` are names of actions (``grasp``), pairs of consecutive names (``grasp>move``), ground actions,
    classes and entities. `language` maps names of actions and fluents to their first sentences. `grammar` is the whole
    table ``[language]``, including the tables of languages. `scene` is the table that physics reads.
    """

    path: Path
    title: str = ""
    description: str = ""
    weights: Mapping[str, Fraction] = field(default_factory=dict)
    language: Mapping[str, str] = field(default_factory=dict)
    grammar: Mapping[str, Any] = field(default_factory=dict)
    scene: Mapping[str, Any] = field(default_factory=dict)
    text: str = field(default="", repr=False, compare=False)

    def line_of(self, *keys: str | int) -> int:
        """Return the line that sets the key with the path `keys`, or 1 if there is none."""
        return key_line(self.text, keys)


def read_table(path: Path) -> dict[str, Any]:
    """Read a TOML file, with exact decimal numbers, and return it as a table.

    Raises:
        DomainError: the file is missing, unreadable or not TOML.
    """
    return parse_toml(path, read_text(path))


def settings_of(table: Mapping[str, Any], source: Source) -> Settings:
    """Return the settings in a TOML table; values of a wrong type are ignored, because the linter reports them."""
    weights = {key: weight_of(value) for key, value in _table(table, "weights").items()}
    grammar = _table(table, "language")
    language: dict[str, str] = {}
    for key, value in grammar.items():  # tables belong to languages
        sentences = [each for each in (value if isinstance(value, list) else [value]) if isinstance(each, str)]
        if sentences:
            language[key] = sentences[0]
    return Settings(
        source.path,
        title=str(table.get("title", "")),
        description=str(table.get("description", "")),
        weights={without_blanks(key): weight for key, weight in weights.items() if weight is not None},
        language=language,
        grammar=grammar,
        scene=_rounded(_table(table, "scene")),
        text=source.text,
    )


def weight_of(value: object) -> Fraction | None:
    """Return the exact value of a weight, or None if it is not a finite nonnegative number."""
    if isinstance(value, bool) or not isinstance(value, int | Decimal):
        return None
    if isinstance(value, Decimal) and (not value.is_finite() or abs(value.adjusted()) > MAX_EXPONENT):
        return None
    return Fraction(value) if value >= 0 else None


def _table(table: Mapping[str, Any], name: str) -> Mapping[str, Any]:
    value = table.get(name, {})
    return value if isinstance(value, Mapping) else {}


def _rounded(value: Any) -> Any:
    """Return a value with decimals converted to floats, for physics."""
    if isinstance(value, Mapping):
        return {key: _rounded(each) for key, each in value.items()}
    if isinstance(value, list):
        return [_rounded(each) for each in value]
    return float(value) if isinstance(value, Decimal) else value
