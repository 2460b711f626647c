"""The words of a language that no domain has to say: articles, pronouns, colours, numbers, and how sentences join."""

from __future__ import annotations

import re
import sys
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache
from pathlib import Path
from typing import Any

from prag_asp.errors import QueryError

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

FOLDER = Path(__file__).parent
Forms = str | Mapping[str, Any]
"""A word that is always the same, or its forms."""


@dataclass(frozen=True)
class Words:
    """The table of a language; its `code` is what it is asked for by, such as ``en``."""

    code: str
    table: Mapping[str, Any]

    @property
    def name(self) -> str:
        """What the language is called in English."""
        return str(self.table.get("name", self.code))

    @cached_property
    def cases(self) -> tuple[str, ...]:
        """The cases of nouns, the usual one first."""
        return tuple(self.table["cases"])

    @cached_property
    def genders(self) -> tuple[str, ...]:
        """The genders of nouns, the usual one first; a number is a gender, too."""
        return tuple(self.table["genders"])

    def agreeing(self, word: str, gender: str, case: str = "") -> str:
        """Return the form that one of the words ``the``, ``it``, ``is`` and ``is_not`` has by gender and case."""
        forms = self.table[word]
        found = forms.get(gender, "") if isinstance(forms, Mapping) else forms
        return str(found.get(case or self.cases[0], "") if isinstance(found, Mapping) else found)

    def adjective(self, kind: str, name: str, gender: str, case: str) -> str:
        """Return a colour, a size or a place in the form that goes with a noun; "" where the language has none."""
        forms: Forms = self.table.get(kind, {}).get(name, "")
        if isinstance(forms, str):
            return forms
        return str(forms.get(self.table["forms"][gender][case], ""))

    def number(self, value: int) -> str:
        """Return the word for the step of a number from 1, as in ``first``."""
        own: Sequence[str] = self.table.get("numbers", self.frames.get("numbers", ()))
        if value <= len(own):
            return own[value - 1]
        known = ORDINALS.get(self.code)
        return known(value) if known else str(self.frames["digits"]).format(number=value)

    @cached_property
    def frames(self) -> Mapping[str, Any]:
        """What stands around sentences, by level."""
        return dict(self.table["frames"])

    def joints(self, kind: str) -> tuple[str, ...]:
        """Return what stands between two sentences of a kind."""
        return tuple(self.table["joints"][kind])

    @cached_property
    def _contractions(self) -> Mapping[str, str]:
        """Words that become one, with that one, also as they begin a sentence."""
        given = self.table.get("contractions", {}).items()
        table = {long: short for long, short in given if long.strip() and isinstance(short, str) and short.strip()}
        return {
            **table,
            **{long[:1].upper() + long[1:]: short[:1].upper() + short[1:] for long, short in table.items()},
        }

    @cached_property
    def _expansions(self) -> Mapping[str, str]:
        return {short: long for long, short in self._contractions.items()}

    def contracted(self, text: str) -> str:
        """Return a text as it is written: "zu dem" is "zum" in German."""
        return _replaced(text, self._contractions)

    def expanded(self, text: str) -> str:
        """Return a text as sentences are put together: "zum" is "zu dem", so that `contracted` is undone."""
        return _replaced(text, self._expansions)

    @property
    def articles(self) -> frozenset[str]:
        """All forms of the article."""
        forms = self.table["the"]
        each = [forms] if isinstance(forms, str) else list(forms.values())
        return frozenset(text for form in each for text in ([form] if isinstance(form, str) else form.values()))


@lru_cache(maxsize=1024)
def english_ordinal(value: int) -> str:
    """Return the English ordinal of a number in words; inflect knows it, and is loaded only here."""
    import inflect  # noqa: PLC0415 - counting and the other languages start faster without

    engine = inflect.engine()
    return str(engine.number_to_words(engine.ordinal(value)))


ORDINALS: Mapping[str, Callable[[int], str]] = {"en": english_ordinal}
"""How a number becomes a word, for languages that a library counts in."""


def shipped_languages() -> tuple[str, ...]:
    """Return the codes of the languages whose words are part of the package."""
    return tuple(sorted(path.stem for path in FOLDER.glob("*.toml")))


@lru_cache(maxsize=16)
def shipped_table(code: str) -> Mapping[str, Any]:
    """Return the table of a language that is part of the package."""
    table: Mapping[str, Any] = tomllib.loads((FOLDER / f"{code}.toml").read_text(encoding="utf-8"))
    return table


def words_of(code: str, own: Mapping[str, Any]) -> Words:
    """Return the words of a language: those of the package, with a domain's `own` laid over them.

    Raises:
        QueryError: the language is not one of the package, and the domain's table lacks words that each needs.
    """
    known = code in shipped_languages()
    base = dict(shipped_table(code)) if known else {}
    for key, value in own.items():
        below = base.get(key)
        base[key] = {**below, **value} if isinstance(below, Mapping) and isinstance(value, Mapping) else value
    missing = [key for key in shipped_table("en") if key not in base and key not in OPTIONAL]
    if missing:
        has = ", ".join(shipped_languages())
        raise QueryError(f"the language {code} has no words for {', '.join(missing)}; write them, or take {has}")
    words = Words(code, base)
    return Words(code, _expanded(base, words)) if "contractions" in base else words


def _expanded(given: Any, words: Words) -> Any:
    """Return a table in which all texts but the contractions are written out."""
    if isinstance(given, Mapping):
        return {key: each if key == "contractions" else _expanded(each, words) for key, each in given.items()}
    if isinstance(given, list):
        return [_expanded(each, words) for each in given]
    return words.expanded(given) if isinstance(given, str) else given


def _replaced(text: str, words: Mapping[str, str]) -> str:
    """Return a text in which some whole words are others."""
    if not words or not text:
        return text
    return _pattern(tuple(words)).sub(lambda found: words[found[0]], text)


@lru_cache(maxsize=64)
def _pattern(words: tuple[str, ...]) -> re.Pattern[str]:
    """Return a pattern of some whole words, the longest first."""
    return re.compile(rf"\b(?:{'|'.join(map(re.escape, sorted(words, key=len, reverse=True)))})\b")


OPTIONAL = frozenset(["name", "defaults", "facts", "sizes", "places", "colors", "forms"])
"""What a language may lack."""
