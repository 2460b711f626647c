"""The words of one length as the paths of the smallest automaton with one layer of states for each step.

From the last layer to the first, states are merged if the same words lead from them to the end. The result is the
minimal automaton of a finite set of words (Revuz 1992). All sums over a space become sums over its layers.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from prag_asp.errors import QueryError
from prag_asp.processes.progress_events import stage
from prag_asp.space.automaton.automaton import Automaton
from prag_asp.space.engines import Level
from prag_asp.space.engines.prefix import checked_level
from prag_asp.space.task_space import TaskSpace
from prag_asp.space.weights.weights import Weights

Objects = NDArray[np.object_]
"""Integers of any size."""


@dataclass(frozen=True)
class LayerEdges:
    """The edges from one layer to the next, in order of source and letter; arrays have the shape (edges,).

    `states` is the number of states in the layer; each state has at least one edge.
    """

    states: int
    sources: NDArray[np.int64]
    letters: NDArray[np.int64]
    targets: NDArray[np.int64]

    @cached_property
    def begins(self) -> NDArray[np.int64]:
        """The index of the first edge of each state, shape (states,)."""
        return np.searchsorted(self.sources, np.arange(self.states))


@dataclass(frozen=True)
class LayeredAutomaton:
    """The words of one length: the paths from state 0 of the first layer to the only state of the last layer.

    `letters` holds the texts of the letters. `edges` has one item for each step; it is None if there is no word.
    """

    length: int
    letters: tuple[str, ...]
    edges: tuple[LayerEdges, ...] | None

    @property
    def sizes(self) -> list[int]:
        """The number of states in each layer."""
        return [] if self.edges is None else [*(step.states for step in self.edges), 1]

    @cached_property
    def completions(self) -> list[Objects]:
        """The number of words from each state of each layer to the end."""
        rows = [np.array([1], dtype=object)]
        for step in reversed(self._inhabited):
            rows.append(np.add.reduceat(rows[-1][step.targets], step.begins))
        return rows[::-1]

    @cached_property
    def beginnings(self) -> list[Objects]:
        """The number of paths from the initial state to each state of each layer."""
        rows = [np.array([1], dtype=object)]
        for step, size in zip(self._inhabited, self.sizes[1:], strict=True):
            rows.append(sums_at(rows[-1][step.sources], step.targets, size))
        return rows

    @property
    def total(self) -> int:
        """The number of words."""
        return 0 if self.edges is None else int(self.completions[0][0])

    @property
    def _inhabited(self) -> tuple[LayerEdges, ...]:
        return self.edges or ()

    def words(self) -> NDArray[np.int64]:
        """Return all words in order, shape (words, length)."""
        if self.edges is None:
            return np.zeros((0, self.length), dtype=np.int64)
        words, states = np.zeros((1, 0), dtype=np.int64), np.zeros(1, dtype=np.int64)
        for step in self.edges:
            degrees = np.diff(np.append(step.begins, len(step.letters)))[states]
            edges = np.arange(degrees.sum()) + np.repeat(step.begins[states] - np.cumsum(degrees) + degrees, degrees)
            words = np.column_stack([np.repeat(words, degrees, axis=0), step.letters[edges]])
            states = step.targets[edges]
        return words


def sums_at(values: Objects, places: NDArray[np.int64], size: int) -> Objects:
    """Return the sums of the values with each index in `places`, shape (size,)."""
    order = np.argsort(places, kind="stable")
    held, begins = np.unique(places[order], return_index=True)
    sums = np.zeros(size, dtype=object)
    if len(held):
        sums[held] = np.add.reduceat(values[order], begins)
    return sums


def layered_words(space: TaskSpace, by: Level) -> LayeredAutomaton:
    """Return the words of one level of a space with a single length.

    Raises:
        QueryError: there is no such level, the space has several lengths, or its states are too many to be listed.
        LimitReached: a limit ended the exploration.
    """
    engine, length = space.engines.engine(checked_level(by), space.length), space.length
    weighed = engine.weighed(length, Weights(), plain=True)
    if weighed.ranking is not None:
        raise QueryError(f"{space.title}: its states are too many to be listed; take a shorter length, or a condition")
    stage("merging states by layers")
    return LayeredAutomaton(length, engine.letters, layers_of(weighed.automaton, length))


def layers_of(automaton: Automaton, length: int) -> tuple[LayerEdges, ...] | None:
    """Return the layers of the words of one length, or None if there is no word."""
    if not automaton.states:
        return None
    sources, targets = automaton.sources, automaton.targets
    reached = np.zeros((length + 1, automaton.states), dtype=np.bool_)
    reached[0, 0] = True
    for step in range(length):
        reached[step + 1, targets[reached[step][sources]]] = True
    blocks = np.where(reached[length] & automaton.accepting, 0, -1)
    layers: list[LayerEdges] = []
    for step in range(length - 1, -1, -1):
        used = np.flatnonzero(reached[step][sources] & (blocks[targets] >= 0))
        if not len(used):
            return None
        layer, blocks = _merged(automaton, used, blocks)
        layers.append(layer)
    return tuple(reversed(layers)) if blocks[0] >= 0 else None


def _merged(
    automaton: Automaton, used: NDArray[np.int64], blocks: NDArray[np.int64]
) -> tuple[LayerEdges, NDArray[np.int64]]:
    """Return the layer of the edges `used`, and the index of the merged state of each state, or -1 for none.

    `blocks` holds the merged states of the next layer. States with the same letters and targets are merged.
    """
    letters, targets = automaton.letters[used].astype(np.int64), blocks[automaton.targets[used]]
    states, begins = np.unique(automaton.sources[used], return_index=True)
    ends = np.append(begins[1:], len(used))
    numbers: dict[tuple[bytes, bytes], int] = {}
    merged = np.full(automaton.states, -1, dtype=np.int64)
    chosen: list[tuple[int, int]] = []
    for state, begin, end in zip(states.tolist(), begins.tolist(), ends.tolist(), strict=True):
        key = letters[begin:end].tobytes(), targets[begin:end].tobytes()
        number = numbers.setdefault(key, len(numbers))
        merged[state] = number
        if number == len(chosen):
            chosen.append((begin, end))
    edges = np.concatenate([np.arange(begin, end) for begin, end in chosen] or [np.zeros(0, dtype=np.int64)])
    sources = np.repeat(np.arange(len(chosen)), [end - begin for begin, end in chosen])
    return LayerEdges(len(chosen), sources, letters[edges], targets[edges]), merged
