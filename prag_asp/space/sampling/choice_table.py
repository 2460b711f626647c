"""Exact choices between the edges of states, for many draws at once.

An edge is chosen with a probability exactly proportional to its weight, an integer of any size. A uniform real number U
in [0, 1) chooses the first edge whose cumulative share of the weights exceeds U. The first 64 bits of U decide, unless
they equal the first 64 bits of some cumulative share; then further bits of U are drawn. For most U, a guide table (Chen
and Asau 1974) looks up the edge from the leading bits; for the others, it is found by binary search.
"""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from itertools import accumulate, pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from prag_asp.random_bits import WORD, Words
from prag_asp.space.automaton.automaton import Automaton

GUIDE_CELLS = 1 << 15
"""Approximate number of cells of a guide table, which should fit into the processor cache."""

LARGEST = (1 << WORD) - 1
Integers = NDArray[np.int64]
Resolve = Callable[[int, int], int]
"""A function that finds the edge from further bits, given the index of a draw in its batch and the slot of its state.
"""


@dataclass(frozen=True)
class ChoiceTable:
    """The choices of one step: for given states, called slots 0, 1, ..., their edges with thresholds.

    The edges of slot s are ``first[s]:first[s + 1]``; `edges` are their numbers in the automaton, and `thresholds` are
    floor(2^64 * cumulative share); the last one for each state is unused. `guide` has 2^bits cells for each slot,
    which hold the chosen edge, or -1 if a threshold lies within the cell; it is empty if bits is 0.
    """

    states: Integers
    first: Integers
    edges: Integers
    thresholds: Words
    bits: int
    guide: NDArray[np.int32]

    def choose(self, slots: Integers, words: Words, resolve: Resolve) -> Integers:
        """Return the edges, numbered as in this table, that random words choose at slots.

        All arrays have shape (draws,).
        """
        if not self.bits:
            return self._search(slots, words, np.arange(len(slots)), resolve)
        cells = (words >> np.uint64(WORD - self.bits)).view(np.int64)
        cells += slots << self.bits
        chosen: Integers = self.guide[cells].astype(np.int64)
        missing = np.flatnonzero(chosen < 0)
        if len(missing):
            chosen[missing] = self._search(slots[missing], words[missing], missing, resolve)
        return chosen

    def _search(self, slots: Integers, words: Words, places: NDArray[np.intp], resolve: Resolve) -> Integers:
        first = self.first[slots]
        low: Integers = first.copy()
        high = self.first[slots + 1] - 1
        while (low < high).any():
            middle = (low + high) >> 1
            passed = (self.thresholds[middle] <= words) & (low < high)
            low = np.where(passed, middle + 1, low)
            high = np.where(passed, high, middle)
        before = np.maximum(low - 1, 0)
        for tie in np.flatnonzero((low > first) & (self.thresholds[before] == words)).tolist():
            low[tie] = int(first[tie]) + resolve(int(places[tie]), int(slots[tie]))
        return low


def make_choice_table(automaton: Automaton, states: Integers, row: NDArray[Any], *, guided: bool) -> ChoiceTable:
    """Return the choices for `states` that have completions; `row` holds the weight of each state's completions."""
    counts = automaton.offsets[states + 1] - automaton.offsets[states]
    first = np.concatenate([[0], np.cumsum(counts)])
    edges = np.arange(first[-1]) + np.repeat(automaton.offsets[states] - first[:-1], counts)
    behind = weights_behind(automaton, edges, row)
    sums = (list(accumulate(behind[begin:end])) for begin, end in pairwise(first.tolist()))
    # 2^64, the last threshold of each state, becomes the largest word, which is a tie if it is drawn.
    scaled = (min((total << WORD) // running[-1], LARGEST) for running in sums for total in running)
    thresholds = np.fromiter(scaled, dtype=np.uint64, count=len(edges))
    bits = max(int(GUIDE_CELLS / len(states)).bit_length() - 1, 0) if guided and len(states) else 0
    return ChoiceTable(states, first, edges, thresholds, bits, _guide(thresholds, first, bits))


def weights_behind(automaton: Automaton, edges: Integers, row: NDArray[Any]) -> list[int]:
    """Return the total weight through each of the given edges; `row` holds the weight of each state's completions."""
    behind: list[int] = row[automaton.targets[edges]].tolist()
    if automaton.weights is None:
        return behind
    return [weight * total for weight, total in zip(automaton.weights[edges].tolist(), behind, strict=True)]


def _guide(thresholds: Words, first: Integers, bits: int) -> NDArray[np.int32]:
    """Return, for each slot and each value of the leading bits, the edge, or -1 if a threshold lies within the cell."""
    if not bits:
        return np.zeros(0, dtype=np.int32)
    slots = len(first) - 1
    inner = np.ones(len(thresholds), dtype=np.bool_)
    inner[first[1:] - 1] = False
    owners = np.repeat(np.arange(slots), np.diff(first))[inner]
    cells = (owners << bits) + (thresholds[inner] >> np.uint64(WORD - bits)).astype(np.int64)
    within = np.bincount(cells, minlength=slots << bits)
    passed = np.cumsum(within.reshape(slots, -1), axis=1) + first[:-1, None]
    return np.where(within > 0, -1, passed.reshape(-1)).astype(np.int32)


def exact_choice(running: Sequence[int], word: int, further: Callable[[], Iterator[int]]) -> int:
    """Return the index of the first running total that, divided by the last total, exceeds a uniform number.

    The number is 0.word further... in base 2^64; only the digits that decide are read.
    """
    total, number, size = running[-1], word, WORD
    digits: Iterator[int] | None = None
    while True:
        least = bisect_right(running, (number * total) >> size)
        if least == bisect_right(running, ((number + 1) * total - 1) >> size):
            return least
        digits = digits or further()
        number, size = (number << WORD) | next(digits), size + WORD
