"""What an engine answers where it is known at once that there are no words."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from prag_asp.logic.domain_logic import DomainLogic
from prag_asp.space.engines.engine import Letters, Level, all_letters
from prag_asp.space.weights.weights import Weighed, Weights


@dataclass(frozen=True)
class NoWords:
    """Answers for one domain at one level, for lengths that no word has; nothing is ground for it."""

    model: DomainLogic
    level: Level

    @property
    def letters(self) -> Letters:
        """The texts of the letters, in their order."""
        return tuple(all_letters(self.model, self.level))

    def count(self, length: int, prefix: Letters = ()) -> int:
        """Return the number of words of a length."""
        return 0

    def words(self, length: int, prefix: Letters = ()) -> Iterator[Letters]:
        """Yield the words of a length in order."""
        return iter(())

    def contains(self, word: Letters) -> bool:
        """Return whether a word belongs to the level."""
        return False

    def unrank(self, length: int, rank: int) -> Letters:
        """Raise an error: no rank has a word."""
        raise IndexError(rank)

    def rank(self, word: Letters) -> int | None:
        """Return the rank of a word, which is none."""
        return None

    def weighed(self, length: int, weights: Weights, *, goals: bool = False, plain: bool = False) -> Weighed:
        """Return the words of a length with their weights."""
        from prag_asp.space.engines.listed_words import listed

        return listed((), self.letters, self.model, self.level, length, Weights(), goals=False)
