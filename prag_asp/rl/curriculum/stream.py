"""Draws by one setting of weights, of which the probability of any task is known."""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction
from itertools import chain

from prag_asp.rl.curriculum.course import skip
from prag_asp.rl.curriculum.task_pool import Offer, Pool, Word
from prag_asp.space.weights.weights import Number


class Stream:
    """Tasks of a space, those of the pool and all others, drawn by weights, and how many of them were taken.

    `total` is what all tasks of the space weigh together. It keeps its own way to draw: an engine keeps the last alone.
    """

    def __init__(self, pool: Pool, weights: Mapping[str, Number], seed: int):
        self._weights = pool.space.weights(weights)
        draws = pool.draws(seed=seed, weights=self._weights)
        self._symbols = {str(action): action for action in pool.space.domain.facts.actions}
        first = next(draws)
        # The probability of a task is its weight over that of all, so any draw tells what all weigh.
        self.total = self._weighed(first.word) / first.probability
        self._draws = chain([first], draws)
        self.taken = 0

    def take(self) -> Offer:
        """Return the next task."""
        self.taken += 1
        return next(self._draws)

    def skip(self, count: int) -> None:
        """Go on as if so many tasks had been taken."""
        skip(self._draws, count)
        self.taken += count

    def probability(self, word: Word) -> Fraction:
        """Return the probability with which a task of the space is drawn."""
        return self._weighed(word) / self.total

    def _weighed(self, word: Word) -> Fraction:
        return self._weights.of_plan([self._symbols[action] for action in word])


def times(weights: Mapping[str, Number], factors: Mapping[str, Fraction]) -> dict[str, Number]:
    """Return weights, each times its factor where it has one."""
    return {key: Fraction(weights.get(key, 1)) * factors.get(key, 1) for key in sorted({*weights, *factors})}
