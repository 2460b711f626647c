"""Subsets of paraphrases: ``1 of 2`` is every second one from the first on."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import gcd
from typing import TYPE_CHECKING, Any, TypeVar

from prag_asp.errors import QueryError

if TYPE_CHECKING:
    from prag_asp.grammar.reader import Signature
    from prag_asp.grammar.template import Template

Way = TypeVar("Way")

SPELLED = re.compile(r"(?P<number>[1-9][0-9]{0,3}) of (?P<all>[1-9][0-9]{0,3})")
FRAMES = ("vague", "default")
"""The levels whose frames differ from phrasing to phrasing; that of ``exact`` numbers the actions."""


@dataclass(frozen=True)
class Phrasings:
    """Of each list of paraphrases, every `all`-th from the `number`-th on, counted from 1.

    A list without any of these, such as one with a single paraphrase, is used as a whole.
    """

    number: int = 1
    all: int = 1

    @classmethod
    def parse(cls, text: str) -> Phrasings:
        """Return the phrasings that a text spells, all of them where it is empty.

        Raises:
            QueryError: it spells none.
        """
        found = SPELLED.fullmatch(" ".join(text.split()))
        if not text.strip():
            return cls()
        if found is None or int(found["number"]) > int(found["all"]):
            raise QueryError(f"phrasings {text!r}: write which of how many, such as '1 of 2'")
        return cls(int(found["number"]), int(found["all"]))

    def __str__(self) -> str:
        return f"{self.number} of {self.all}" if self.all > 1 else ""

    def has(self, place: int) -> bool:
        """Return whether the paraphrase at a place of its list, from 0, is one of these."""
        return place % self.all == self.number - 1

    def of(self, ways: Sequence[Way]) -> Sequence[Way]:
        """Return those of a list of paraphrases; all where there are none."""
        if self.all == 1:
            return ways
        return [way for place, way in enumerate(ways) if self.has(place)] or ways

    def disjoint(self, other: Phrasings) -> bool:
        """Return whether no paraphrase is in both, for lists of any length (by the Chinese remainder theorem)."""
        return (self.number - other.number) % gcd(self.all, other.all) != 0

    def require(
        self, actions: Mapping[Signature, Sequence[Template]], frames: Mapping[str, Any], language: str
    ) -> None:
        """Check that each action and each instruction has such a phrasing.

        Raises:
            QueryError: one has too few sentences.
        """
        if self.all == 1:
            return
        for (name, _), templates in actions.items():
            if not any(self.has(template.phrasing) for template in templates):
                have = len({template.phrasing for template in templates})
                raise QueryError(
                    f"phrasings {self}: {name} has only {have} in {language}; write more under "
                    f"[language.{language}.actions]"
                )
        for level in FRAMES:
            if len(frames[level]) < self.number:
                text = f"the level {level} has only {len(frames[level])} in {language}"
                raise QueryError(f"phrasings {self}: {text}; write more under [language.{language}.words.frames]")
