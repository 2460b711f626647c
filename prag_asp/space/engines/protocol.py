"""What every engine answers, and what it is asked for."""

from __future__ import annotations

import random
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from fractions import Fraction
from typing import Literal, Protocol

from prag_asp.logic.model import Model
from prag_asp.space.limits import Limits
from prag_asp.space.weights import Weights

Level = Literal["plan", "task", "skeleton"]
LEVELS: tuple[Level, ...] = ("plan", "task", "skeleton")

Letters = tuple[str, ...]
"""A plan or a task as the texts of its actions, a skeleton as names."""


@dataclass(frozen=True)
class Draw:
    """A plan or task drawn, with the exact probability that it had."""

    word: Letters
    probability: Fraction


class Engine(Protocol):
    """A way to count, enumerate and draw the words of one domain at one level.

    `prefix` holds, for the first steps, the text of an action or of an action's name. Words come in the order of
    their letters: actions in clingo's order of terms, names in alphabetical order.
    """

    def count(self, length: int, prefix: Letters = ()) -> int:
        """Return the number of words of a length."""
        ...

    def words(self, length: int, prefix: Letters = ()) -> Iterator[Letters]:
        """Yield the words of a length in order, lazily."""
        ...

    def contains(self, word: Letters) -> bool:
        """Return whether a word belongs to the level."""
        ...

    def unrank(self, length: int, rank: int) -> Letters:
        """Return the word of a rank from 0 to count - 1."""
        ...

    def rank(self, word: Letters) -> int | None:
        """Return the rank of a word among those of its length, or None where it is no word."""
        ...

    def draws(self, length: int, generator: random.Random, weights: Weights) -> Iterator[Draw]:
        """Yield words drawn independently, each with a probability proportional to its weight, without end.

        Raises:
            QueryError: there is nothing to draw.
        """
        ...


Progress = Callable[[str], None]
"""Told in a few words how far a long computation is."""

MakeEngine = Callable[[Model, Level, "Progress | None", Limits], Engine]
