"""A lower bound on the number of tasks that cover all combinations of a space.

Each combination has a weight. If no task covers combinations with a total weight above W, at least total / W tasks are
needed. The best weights solve the dual of a linear programme; multiplicative updates, which repeatedly make the
combinations of a heaviest task lighter, approximate them (Plotkin, Shmoys and Tardos 1995). Each intermediate bound is
valid, and all sums are exact integers.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from prag_asp.analysis.layered_automaton import LayeredAutomaton
from prag_asp.space.limits import LimitClock

ROUNDS = 4000
"""The number of updates; more updates hardly ever improve a bound."""

WORK = 40_000_000
"""The total number of edges that the updates visit; this takes about a second."""

COARSE, FINE = 3, 5
"""Updates reduce weights by 1/8 in the first quarter of the rounds, and by 1/32 after that."""

HEAVIEST, LIGHTEST = 1 << 30, 1 << 20
"""Weights are scaled up when all are below `LIGHTEST`; sums for 10,000 combinations and 1,000 actions fit 64 bits."""


def fewest_tasks(words: LayeredAutomaton, masks: Sequence[int], enough: int, clock: LimitClock) -> int:
    """Return a lower bound, at most `enough`, on the number of tasks that cover all combinations.

    `masks` holds the combinations of each letter as bits. The search ends at a limit.
    """
    combinations = 0
    for mask in masks:
        combinations |= mask
    if not combinations or words.edges is None:
        return 0
    incidence = np.array(
        [[mask >> bit & 1 for bit in range(combinations.bit_length())] for mask in masks], dtype=np.int64
    )
    weights = np.full(incidence.shape[1], HEAVIEST, dtype=np.int64)
    best, rounds = 0, max(min(ROUNDS, WORK // sum(len(step.letters) for step in words.edges)), 1)
    for number in range(rounds):
        word, heaviest = _heaviest(words, incidence @ weights)
        best = max(best, -(-int(weights.sum()) // heaviest))
        if best >= enough or clock.reached_limit():
            break
        covered = incidence[word].any(axis=0)
        weights[covered] -= weights[covered] >> (COARSE if number < rounds // 4 else FINE)
        if weights.max() < LIGHTEST:
            weights *= HEAVIEST // LIGHTEST
    return min(best, enough)


def _heaviest(words: LayeredAutomaton, gains: NDArray[np.int64]) -> tuple[list[int], int]:
    """Return a word whose letters have the largest sum of gains, together with this sum."""
    steps = words.edges or ()
    values = [np.zeros(1, dtype=np.int64)]
    for step in reversed(steps):
        values.append(np.maximum.reduceat(gains[step.letters] + values[-1][step.targets], step.begins))
    values.reverse()
    state, word = 0, list[int]()
    for place, step in enumerate(steps):
        end = step.begins[state + 1] if state + 1 < step.states else len(step.letters)
        edges = np.arange(step.begins[state], end)
        edge = edges[np.argmax(gains[step.letters[edges]] + values[place + 1][step.targets[edges]])]
        word.append(int(step.letters[edge]))
        state = int(step.targets[edge])
    return word, int(values[0][0])
