"""Sample tasks with fixed weights, and compute the exact probability of any task."""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction
from itertools import chain

from prag_asp.exact_numbers import Number
from prag_asp.rl.curriculum.task_pool import Proposal, TaskPool, Word
from prag_asp.rl.curriculum.task_sampler import skip


class ProposalStream:
    """A stream of tasks sampled by weight from a space, whether or not they are in the pool; `taken` counts them.

    `total` is the sum of the weights of all tasks in the space.
    """

    def __init__(self, pool: TaskPool, weights: Mapping[str, Number], seed: int):
        self._weights = pool.space.weights(weights)
        draws = pool.draws(seed=seed, weights=self._weights)
        self._symbols = {str(action): action for action in pool.space.domain.facts.actions}
        first = next(draws)
        # the probability of a task is its weight divided by the total, so the total follows from any sample
        self.total = self._weight_of(first.word) / first.probability
        self._draws = chain([first], draws)
        self.taken = 0

    def take(self) -> Proposal:
        """Return the next task."""
        self.taken += 1
        return next(self._draws)

    def skip(self, count: int) -> None:
        """Skip `count` tasks."""
        skip(self._draws, count)
        self.taken += count

    def probability(self, word: Word) -> Fraction:
        """Return the exact probability of a task of the space."""
        return self._weight_of(word) / self.total

    def _weight_of(self, word: Word) -> Fraction:
        return self._weights.of_plan([self._symbols[action] for action in word])


def scale_weights(weights: Mapping[str, Number], factors: Mapping[str, Fraction]) -> dict[str, Number]:
    """Return weights, each multiplied by its factor if it has one."""
    return {key: Fraction(weights.get(key, 1)) * factors.get(key, 1) for key in sorted({*weights, *factors})}
