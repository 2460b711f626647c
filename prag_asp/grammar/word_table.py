"""The words of a language that all domains share: articles, pronouns, colours, numbers and conjunctions."""

from __future__ import annotations

import re
import sys
from collections.abc import Callable, Iterable, Mapping, Sequence
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
"""A word that never changes, or its forms."""


@dataclass(frozen=True)
class Words:
    """The word table of a language; `code` is its code, such as ``en``."""

    code: str
    table: Mapping[str, Any]

    @property
    def name(self) -> str:
        """The English name of the language."""
        return str(self.table.get("name", self.code))

    @cached_property
    def cases(self) -> tuple[str, ...]:
        """The cases of nouns, the default case first."""
        return tuple(self.table["cases"])

    @cached_property
    def genders(self) -> tuple[str, ...]:
        """The genders of nouns, the default gender first; values of grammatical number count as genders."""
        return tuple(self.table["genders"])

    def agreeing(self, word: str, gender: str, case: str = "") -> str:
        """Return the form, by gender and case, of one of the words ``the``, ``it``, ``is``, ``is_not`` and ``was``."""
        forms = self.table.get(word, "")
        form = forms.get(gender, "") if isinstance(forms, Mapping) else forms
        return str(form.get(case or self.cases[0], "") if isinstance(form, Mapping) else form)

    def adjective(self, kind: str, name: str, gender: str, case: str) -> str:
        """Return the word for a colour, size or place in the form for a noun, or "" if the language lacks the word."""
        forms: Forms = self.table.get(kind, {}).get(name, "")
        if isinstance(forms, str):
            return forms
        return str(forms.get(self.table["forms"][gender][case], ""))

    def number(self, value: int) -> str:
        """Return the ordinal for a step number, counted from 1, such as ``first``."""
        own: Sequence[str] = self.table.get("numbers", self.frames.get("numbers", ()))
        if value <= len(own):
            return own[value - 1]
        ordinal = ORDINALS.get(self.code)
        return ordinal(value) if ordinal else str(self.frames["digits"]).format(number=value)

    @cached_property
    def frames(self) -> Mapping[str, Any]:
        """The frames around sentences for each level."""
        return dict(self.table["frames"])

    def joints(self, kind: str) -> tuple[str, ...]:
        """Return the texts that join two sentences of a given kind."""
        return tuple(self.table["joints"][kind])

    def verb_phrase(self, fact: str) -> int:
        """Return the index after the subject and verb in a sentence about a fact, or 0 if the verb comes last."""
        verbs = {self.agreeing("is", gender) for gender in self.genders}
        ends = [at + len(verb) + 2 for verb in verbs if (at := fact.find(f" {verb} ")) > 0]
        return min(ends, default=0)

    @cached_property
    def many(self) -> tuple[str, ...]:
        """The texts that join three or more facts: between facts, and before the last; empty if not defined."""
        return tuple(self.table["joints"].get("many", ()))

    @cached_property
    def goal(self) -> tuple[str, ...]:
        """The texts that join the facts of a goal: between, before the last, and between two; empty if not defined."""
        return tuple(self.table["joints"].get("goal", ()))

    @cached_property
    def between_facts(self) -> tuple[str, ...]:
        """All texts that can stand between two facts."""
        return tuple(dict.fromkeys((*self.joints("facts"), *self.many, *self.goal)))

    @cached_property
    def adjoined(self) -> tuple[str, ...]:
        """The words with which a predicate can follow a place without a conjunction: "on the table behind the can"."""
        return tuple(self.table.get("adjoined", ()))

    @cached_property
    def both(self) -> tuple[str, ...]:
        """The texts before and after the first of two subjects with the same predicate; empty if not defined."""
        return tuple(self.table["joints"].get("both", ())) if "plural" in self.table else ()

    def in_plural(self, predicate: str) -> str:
        """Return a predicate with its verb in the plural, or "" if it has no verb "is": "is open" gives "are open"."""
        return self._with_verb(predicate, self.agreeing("is", str(self.table["plural"])))

    def in_singular(self, predicate: str) -> list[str]:
        """Return a predicate with its verb in each form: "are open" gives "is open" and "are open"."""
        verbs = dict.fromkeys(self.agreeing("is", gender) for gender in self.genders)
        return list(filter(None, (self._with_verb(predicate, verb) for verb in verbs)))

    def _with_verb(self, predicate: str, verb: str) -> str:
        """Return a predicate whose verb "is", its first or its last word, is replaced; or "" if there is none."""
        verbs, words = {self.agreeing("is", gender) for gender in self.genders}, predicate.split(" ")
        if words[0] in verbs:
            return " ".join([verb, *words[1:]])
        return " ".join([*words[:-1], verb]) if words[-1] in verbs else ""

    def implications(self, text_words: Iterable[str]) -> set[str]:
        """Return the words that the verbs among `text_words` imply: "take" implies that the gripper is "holding"."""
        means = self.table.get("means", {})
        return {word for each in text_words for word in means.get(each, ())}

    @cached_property
    def _contractions(self) -> Mapping[str, str]:
        """The contractions of word sequences, also with a capital letter for the beginning of a sentence."""
        pairs = self.table.get("contractions", {}).items()
        table = {long: short for long, short in pairs if long.strip() and isinstance(short, str) and short.strip()}
        return {
            **table,
            **{long[:1].upper() + long[1:]: short[:1].upper() + short[1:] for long, short in table.items()},
        }

    @cached_property
    def _expansions(self) -> Mapping[str, str]:
        return {short: long for long, short in self._contractions.items()}

    def contracted(self, text: str) -> str:
        """Return a text with contractions: "zu dem" becomes "zum" in German."""
        return _replaced(text, self._contractions)

    def expanded(self, text: str) -> str:
        """Return a text with contractions expanded, which is the inverse of `contracted`: "zum" becomes "zu dem"."""
        return _replaced(text, self._expansions)

    @cached_property
    def function_words(self) -> frozenset[str]:
        """The articles, the pronouns, the verb "is" in all forms, and the words that the name of a place implies."""
        forms = {
            self.agreeing(word, gender, case)
            for word in ("the", "it", "is")
            for gender in self.genders
            for case in self.cases
        }
        return frozenset(form.casefold() for form in (*forms, *self.table.get("implied", ())) if form)

    @property
    def articles(self) -> frozenset[str]:
        """All forms of the definite article."""
        forms = self.table["the"]
        each = [forms] if isinstance(forms, str) else list(forms.values())
        return frozenset(text for form in each for text in ([form] if isinstance(form, str) else form.values()))


@lru_cache(maxsize=1024)
def english_ordinal(value: int) -> str:
    """Return the English ordinal of a number in words; only this function imports inflect."""
    import inflect  # noqa: PLC0415 - counting and the other languages start faster without

    engine = inflect.engine()
    return str(engine.number_to_words(engine.ordinal(value)))


ORDINALS: Mapping[str, Callable[[int], str]] = {"en": english_ordinal}
"""Functions that spell ordinals, for languages for which there is a library."""


def shipped_languages() -> tuple[str, ...]:
    """Return the codes of the languages that have a word table in the package."""
    return tuple(sorted(path.stem for path in FOLDER.glob("*.toml")))


@lru_cache(maxsize=16)
def shipped_table(code: str) -> Mapping[str, Any]:
    """Return the word table for a language in the package."""
    table: Mapping[str, Any] = tomllib.loads((FOLDER / f"{code}.toml").read_text(encoding="utf-8"))
    return table


def words_of(code: str, own: Mapping[str, Any]) -> Words:
    """Return the words of a language: those in the package, overridden by those in a domain's `own` table.

    Raises:
        QueryError: the package does not have the language, and the domain's table lacks required words.
    """
    is_shipped = code in shipped_languages()
    base = dict(shipped_table(code)) if is_shipped else {}
    for key, value in own.items():
        below = base.get(key)
        base[key] = {**below, **value} if isinstance(below, Mapping) and isinstance(value, Mapping) else value
    missing = [key for key in shipped_table("en") if key not in base and key not in OPTIONAL]
    if missing:
        has = ", ".join(shipped_languages())
        raise QueryError(f"the language {code} has no words for {', '.join(missing)}; write them, or use {has}")
    words = Words(code, base)
    return Words(code, _expanded(base, words)) if "contractions" in base else words


def _expanded(value: Any, words: Words) -> Any:
    """Return a table with contractions expanded in all texts."""
    if isinstance(value, Mapping):
        return {key: each if key == "contractions" else _expanded(each, words) for key, each in value.items()}
    if isinstance(value, list):
        return [_expanded(each, words) for each in value]
    return words.expanded(value) if isinstance(value, str) else value


def _replaced(text: str, words: Mapping[str, str]) -> str:
    """Return a text with certain whole words replaced, longest first."""
    if not words or not text:
        return text
    longest_first = sorted(words, key=len, reverse=True)
    return re.sub(rf"\b(?:{'|'.join(map(re.escape, longest_first))})\b", lambda match: words[match[0]], text)


OPTIONAL = frozenset(
    [
        *("name", "defaults", "facts", "sizes", "places", "colors", "forms", "repeated", "formerly", "fluents"),
        *("implied", "plural", "means", "varied", "second", "adjoined", "within", "was"),
    ]
)
"""The optional keys of a word table."""
