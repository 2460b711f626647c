"""Sampling of the paths of an automaton with probabilities exactly proportional to their weights."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import accumulate

import numpy as np
from numpy.typing import NDArray

from prag_asp.random_bits import Bits, Words
from prag_asp.space.automaton.automaton import Completions
from prag_asp.space.sampling.choice_table import ChoiceTable, Integers, exact_choice, make_choice_table, weights_behind

CHUNK_WORDS = 1 << 17
"""Approximate number of random words per chunk, so that a chunk fits into the processor cache."""

FEW = 64
"""Maximum number of draws for which building tables for all states does not pay off."""

KEPT_EDGES = 1 << 23
"""Maximum number of edges in all tables for the tables to be cached; above it, each chunk builds the tables that it
needs."""


class PathSampler:
    """A sampler of accepting paths of one length.

    Each path uses one random word for each edge. Results depend neither on the number of paths drawn together nor on
    whether tables are cached, because tables depend only on the automaton.
    """

    def __init__(self, completions: Completions, length: int, starts: Integers | None = None) -> None:
        self._completions = completions
        self._length = length
        self._starts = np.zeros(1, dtype=np.int64) if starts is None else starts
        self._tables: list[ChoiceTable] | None = None
        self._numbered: list[Integers] = []
        self._too_many = False

    def sample(self, bits: Bits, first: int, count: int) -> NDArray[np.int64]:
        """Return the edges of the paths of draws from `first` on, starting in state 0; shape (length, count)."""
        edges = np.empty((self._length, count), dtype=np.int64)
        for begin, end in chunks(count, self._length):
            words = bits.words(first + begin, end - begin, self._length)
            edges[:, begin:end] = self.descend(np.zeros(end - begin, dtype=np.int64), words, bits, first + begin)
        return edges

    def descend(self, states: Integers, words: Words, bits: Bits, first: int) -> NDArray[np.int64]:
        """Return the edges, shape (length, paths), of paths from `states`, chosen by `words`, shape (paths, length).

        If a path needs further random words, they are bits of its draw; `first` is the number of the first draw.
        """
        automaton, row = self._completions.automaton, self._completions.row
        columns = np.ascontiguousarray(words.T)
        edges = np.empty(columns.shape, dtype=np.int64)

        def choose(table: ChoiceTable, slots: Integers, step: int) -> Integers:
            def resolve(place: int, slot: int) -> int:
                of_slot = table.edges[int(table.first[slot]) : int(table.first[slot + 1])]
                running = list(accumulate(weights_behind(automaton, of_slot, row(self._length - step - 1))))
                return exact_choice(running, int(columns[step][place]), lambda: bits.further(first + place, step))

            return table.choose(slots, columns[step], resolve)

        tables = self._kept() if len(states) > FEW else None
        if tables is None:
            for step in range(self._length):
                visited, slots = np.unique(states, return_inverse=True)
                table = make_choice_table(automaton, visited, row(self._length - step - 1), guided=False)
                edges[step] = table.edges[choose(table, slots, step)]
                states = automaton.targets[edges[step]].astype(np.int64)
            return edges
        slots = np.searchsorted(tables[0].states, states) if tables else states
        for step, (table, onward) in enumerate(zip(tables, self._numbered, strict=True)):
            chosen = choose(table, slots, step)
            edges[step] = table.edges[chosen]
            slots = onward[chosen]
        return edges

    def _kept(self) -> list[ChoiceTable] | None:
        """Return the cached tables of all steps, or None if they would be too large."""
        if self._tables is None and not self._too_many:
            layers = self._layers()
            if layers is None:
                self._too_many = True
                return None
            automaton, rows = self._completions.automaton, self._completions.row
            self._tables = [
                make_choice_table(automaton, states, rows(self._length - step - 1), guided=True)
                for step, states in enumerate(layers[:-1])
            ]
            self._numbered = [
                np.searchsorted(after, automaton.targets[table.edges])
                for table, after in zip(self._tables, layers[1:], strict=True)
            ]
        return self._tables

    def _layers(self) -> list[Integers] | None:
        """Return the states of paths after each step, or None if they have too many edges for cached tables."""
        automaton = self._completions.automaton
        layers, total = [np.unique(self._starts)], 0
        for left in range(self._length - 1, -1, -1):
            counts = automaton.offsets[layers[-1] + 1] - automaton.offsets[layers[-1]]
            total += int(counts.sum())
            if total > KEPT_EDGES:
                return None
            edges = np.arange(counts.sum()) + np.repeat(
                automaton.offsets[layers[-1]] - np.cumsum(counts) + counts, counts
            )
            alive = self._completions.row(left)[automaton.targets[edges]] != 0
            if automaton.weights is not None:
                alive &= automaton.weights[edges] != 0
            layers.append(np.unique(automaton.targets[edges[alive.astype(np.bool_)]]).astype(np.int64))
        return layers


def chunks(count: int, words: int) -> Iterator[tuple[int, int]]:
    """Yield the range of draws in each chunk, where each draw uses `words` random words."""
    size = max(CHUNK_WORDS // max(words, 1), 2 * FEW)
    for begin in range(0, count, size):
        yield begin, min(begin + size, count)
