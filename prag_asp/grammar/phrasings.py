"""Subsets of paraphrases: ``1 of 2`` is every second paraphrase, starting with the first."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import gcd
from typing import TYPE_CHECKING, Any, TypeVar

from prag_asp.errors import QueryError

if TYPE_CHECKING:
    from prag_asp.grammar.template import Template
    from prag_asp.grammar.ways import Signature

Way = TypeVar("Way")

SPELLED = re.compile(r"(?P<number>[1-9][0-9]{0,3}) of (?P<all>[1-9][0-9]{0,3})")
FRAMES = ("vague", "default")
"""The levels whose frames have paraphrases; in the frames of ``exact``, actions are numbered instead."""


@dataclass(frozen=True)
class Phrasings:
    """Every `all`-th paraphrase of each list, starting with the `number`-th, counted from 1.

    If a list has no such paraphrase, as a list of length one may not, the whole list is used.
    """

    number: int = 1
    all: int = 1

    @classmethod
    def parse(cls, text: str) -> Phrasings:
        """Parse a subset of phrasings; an empty text means all of them.

        Raises:
            QueryError: the text is not of the form ``1 of 2``.
        """
        match = SPELLED.fullmatch(" ".join(text.split()))
        if not text.strip():
            return cls()
        if match is None or int(match["number"]) > int(match["all"]):
            raise QueryError(f"phrasings {text!r}: write which of how many, such as '1 of 2'")
        return cls(int(match["number"]), int(match["all"]))

    def __str__(self) -> str:
        return f"{self.number} of {self.all}" if self.all > 1 else ""

    def has(self, place: int) -> bool:
        """Return whether the subset contains the paraphrase at an index of its list."""
        return place % self.all == self.number - 1

    def of(self, ways: Sequence[Way]) -> Sequence[Way]:
        """Return the paraphrases in a list that belong to the subset, or all of them if none does."""
        if self.all == 1:
            return ways
        return [way for place, way in enumerate(ways) if self.has(place)] or ways

    def disjoint(self, other: Phrasings) -> bool:
        """Return whether two subsets are disjoint for lists of any length (by the Chinese remainder theorem)."""
        return (self.number - other.number) % gcd(self.all, other.all) != 0

    def require(
        self, actions: Mapping[Signature, Sequence[Template]], frames: Mapping[str, Any], language: str
    ) -> None:
        """Check that each action and each frame of instructions has a paraphrase in the subset.

        Raises:
            QueryError: an action or a level has too few paraphrases.
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
