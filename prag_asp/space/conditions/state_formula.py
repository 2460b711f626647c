"""Formulas over the fluents of one state, as disjunctions of conjunctions."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping

from prag_asp.atom import parse_atom
from prag_asp.errors import QueryError
from prag_asp.wording import not_too_deep, unknown

Conjunction = Mapping[str, bool]
"""A conjunction of literals: fluents with their truth values."""

MOST_CONJUNCTIONS = 10_000
WORD = re.compile(r"\s*(?P<word>[(),]|[^\s(),]+)")


def parse_formula(text: str, fluents: Iterable[str]) -> tuple[Conjunction, ...]:
    """Return the disjunctive normal form of a formula with ``and``, ``or`` and ``not``.

    A comma is an ``and`` that binds weakest. Contradictory conjunctions are dropped.

    Raises:
        QueryError: the text is not a formula, or has an unknown fluent.
    """
    with not_too_deep(text):
        return tuple(dict(literals) for literals in _FormulaParser(text, frozenset(fluents)).whole())


def parse_conjunction(text: str, fluents: Iterable[str]) -> Conjunction:
    """Return the literals of a formula without ``or``.

    Raises:
        QueryError: the text is not such a formula, or is contradictory.
    """
    conjunctions = parse_formula(text, fluents)
    if len(conjunctions) != 1:
        raise QueryError(f"{text!r}: write fluents that hold together, like holding(panda,apple_1), not open(panda)")
    return conjunctions[0]


_Literals = frozenset[tuple[str, bool]]


class _FormulaParser:
    """A recursive-descent parser of a formula, which pushes negations down to the fluents."""

    def __init__(self, text: str, fluents: frozenset[str]) -> None:
        self._text, self._fluents = text, fluents
        self._words = [match["word"] for match in WORD.finditer(text)]

    def whole(self) -> list[_Literals]:
        conjunctions = self._conjunction(",", positive=True)
        if self._words:
            raise self._wrong(f"unexpected {self._words[0]!r}")
        return conjunctions

    def _conjunction(self, word: str, positive: bool) -> list[_Literals]:
        """Parse the operands of the operator `word`, where ``,`` binds weakest, followed by ``or`` and then ``and``."""
        below = {",": "or", "or": "and"}
        conjunctions = self._conjunction(below[word], positive) if word in below else self._negation(positive)
        while self._words[:1] == [word]:
            self._words.pop(0)
            other = self._conjunction(below[word], positive) if word in below else self._negation(positive)
            if (word == "or") == positive:
                conjunctions = self._smallest([*conjunctions, *other])
                continue
            if len(conjunctions) * len(other) > MOST_CONJUNCTIONS:
                raise self._wrong("it has too many cases; ask for less")
            both = (one | another for one in conjunctions for another in other)
            conjunctions = self._smallest([literals for literals in both if len(dict(literals)) == len(literals)])
        return conjunctions

    def _negation(self, positive: bool) -> list[_Literals]:
        if self._words[:1] == ["not"]:
            self._words.pop(0)
            return self._negation(not positive)
        if self._words[:1] == ["("]:
            self._words.pop(0)
            conjunctions = self._conjunction(",", positive)
            if self._words[:1] != [")"]:
                raise self._wrong("a parenthesis is not closed")
            self._words.pop(0)
            return conjunctions
        return [frozenset({(self._fluent(), positive)})]

    def _fluent(self) -> str:
        if not self._words or self._words[0] in ("and", "or", ")", ","):
            raise self._wrong(f"a fluent is missing before {self._words[0]!r}" if self._words else "it ends too early")
        text = self._words.pop(0)
        if self._words[:1] == ["("]:
            depth = 0
            while self._words:
                word = self._words.pop(0)
                depth += (word == "(") - (word == ")")
                text += word
                if depth == 0:
                    break
        fluent = str(parse_atom(text))
        if fluent not in self._fluents:
            raise QueryError(unknown(fluent, self._fluents, "fluent"))
        return fluent

    def _smallest(self, conjunctions: list[_Literals]) -> list[_Literals]:
        """Return the conjunctions that no weaker conjunction absorbs, in order."""
        distinct = list(dict.fromkeys(conjunctions))
        return [literals for literals in distinct if not any(other < literals for other in distinct)]

    def _wrong(self, what: str) -> QueryError:
        return QueryError(
            f"{self._text!r} is not a formula: {what}; write it like holding(panda,apple_1) or not open(panda)"
        )
