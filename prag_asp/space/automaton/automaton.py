"""Deterministic automata as arrays: exact counts, ordered enumeration, and ranks.

Every level of a task space is the set of words of one automaton. The letters of plans and tasks are actions; the
letters of skeletons are action names.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise
from sys import getsizeof
from typing import Any

import numpy as np
from numpy.typing import NDArray

from prag_asp.processes.progress_events import counted
from prag_asp.space.automaton.walks import words_along

KEPT_BYTES = 1 << 30
"""Approximate memory for the cached rows of one automaton, in bytes."""

Word = tuple[int, ...]
"""The letters of a word, given by their numbers."""


@dataclass(frozen=True)
class Automaton:
    """A deterministic automaton whose words are the paths from state 0 to an accepting state.

    The edges of state s are the rows ``offsets[s]:offsets[s + 1]`` of `letters` and `targets`, in ascending order of
    the letters, which are integers. `accepting` has shape (states,), and `weights` has shape (edges,) with a
    nonnegative integer for each edge, or is None if all weights are 1. An automaton without states has no words.
    `horizon` is the greatest length up to which the automaton has all words, or None if it has all words of every
    length.
    """

    offsets: NDArray[np.int64]
    letters: NDArray[np.int64]
    targets: NDArray[np.int64]
    accepting: NDArray[np.bool_]
    weights: NDArray[Any] | None = None
    horizon: int | None = None

    @property
    def states(self) -> int:
        """The number of states."""
        return len(self.accepting)

    @cached_property
    def sources(self) -> NDArray[np.int64]:
        """The source of each edge, shape (edges,)."""
        return np.repeat(np.arange(self.states), np.diff(self.offsets))

    @cached_property
    def edges(self) -> list[tuple[list[int], list[int]]]:
        """The letters and the targets of the edges of each state, as lists for fast access to single entries."""
        letters, targets, offsets = self.letters.tolist(), self.targets.tolist(), self.offsets.tolist()
        return [(letters[begin:end], targets[begin:end]) for begin, end in pairwise(offsets)]

    def step(self, state: int, letter: int) -> int | None:
        """Return the edge with a given letter from a state, or None if there is no such edge."""
        first, last = int(self.offsets[state]), int(self.offsets[state + 1])
        edge = first + int(np.searchsorted(self.letters[first:last], letter))
        return edge if edge < last and self.letters[edge] == letter else None

    def with_edges(self, edges: NDArray[np.int64]) -> Automaton:
        """Return the automaton restricted to the edges with the given numbers, which are in ascending order."""
        return replace(
            self,
            offsets=np.searchsorted(self.sources[edges], np.arange(self.states + 1)).astype(np.int64),
            letters=self.letters[edges],
            targets=self.targets[edges],
            weights=None if self.weights is None else self.weights[edges],
        )


NOTHING = Automaton(np.zeros(1, dtype=np.int64), np.zeros(0, dtype=np.int64), np.zeros(0, dtype=np.int64),
                    np.zeros(0, dtype=np.bool_))  # fmt: skip
"""An automaton without words."""


def positive(automaton: Automaton) -> Automaton:
    """Return the automaton without its edges of weight 0."""
    return automaton if automaton.weights is None else automaton.with_edges(np.flatnonzero(automaton.weights != 0))


def avoiding(automaton: Automaton, letters: Collection[int]) -> Automaton:
    """Return the automaton that accepts only the words without the given letters."""
    return automaton.with_edges(np.flatnonzero(~np.isin(automaton.letters, list(letters))))


def accepts(automaton: Automaton, word: Sequence[int]) -> bool:
    """Return whether a word belongs to the automaton."""
    state = 0
    if not automaton.states:
        return False
    for letter in word:
        edge = automaton.step(state, letter)
        if edge is None:
            return False
        state = int(automaton.targets[edge])
    return bool(automaton.accepting[state])


class Completions:
    """The total weight of the completions from each state, for each number of remaining letters.

    Values are exact: 64-bit integers as long as they cannot overflow, and Python integers after that. All rows are
    cached while they fit into `KEPT_BYTES`; after that, only every second row is cached, then every fourth, and so on,
    and the others are recomputed.
    """

    def __init__(self, automaton: Automaton) -> None:
        self.automaton = automaton
        self._kept: dict[int, NDArray[Any]] = {0: automaton.accepting.astype(np.int64)}
        self._between: dict[int, NDArray[Any]] = {}
        self._every = 1
        self._bytes = 0
        degrees = np.diff(automaton.offsets)
        heaviest = 1 if automaton.weights is None else int(automaton.weights.max(initial=1))
        self._growth = int(degrees.max(initial=0)) * heaviest
        self._inhabited = np.flatnonzero(degrees)

    def row(self, left: int) -> NDArray[Any]:
        """Return the weights of completions with `left` letters, shape (states,), of dtype int64 or object."""
        row = self._kept.get(left)
        if row is None:
            row = self._between.get(left)
        return self._climb(left) if row is None else row

    def _climb(self, left: int) -> NDArray[Any]:
        """Compute a row, starting from the nearest cached row before it, and return it."""
        place = left - left % self._every
        while place not in self._kept:
            place -= self._every
        row = self._kept[place]
        self._between = {}
        for number in counted(range(place + 1, left + 1), "lengths"):
            row = self.following(row)
            if number % self._every:
                self._between[number] = row
            else:
                self._between = {}
                self._keep(number, row)
        return row

    def _keep(self, left: int, row: NDArray[Any]) -> None:
        self._kept[left] = row
        self._bytes += row.nbytes
        if row.dtype == object:
            self._bytes += sum(map(getsizeof, row.tolist()))
        if self._bytes > KEPT_BYTES:
            self._every *= 2
            self._kept = {number: row for number, row in self._kept.items() if number % self._every == 0}
            self._bytes //= 2

    def last_row(self, left: int) -> NDArray[Any]:
        """Return the row that `row` returns, without caching the rows before it."""
        place = max(number for number in self._kept if number <= left)
        row = self._kept[place]
        for _ in counted(range(left - place), "lengths"):
            row = self.following(row)
        return row

    def following(self, row: NDArray[Any]) -> NDArray[Any]:
        """Return the row for completions with one more letter than those of `row`."""
        automaton = self.automaton
        if row.dtype != object and int(row.max(initial=1)) * self._growth >= 2**62:
            row = row.astype(object)
        terms = row[automaton.targets]
        if automaton.weights is not None:
            terms = terms * (automaton.weights if terms.dtype == object else automaton.weights.astype(np.int64))
        result = np.zeros(automaton.states, dtype=row.dtype)
        if len(self._inhabited):
            result[self._inhabited] = np.add.reduceat(terms, automaton.offsets[self._inhabited])
        return result


NO_PATHS = Completions(NOTHING)
"""The completions of an automaton whose states are not listed."""


def count_words(completions: Completions, length: int, prefix: Sequence[Callable[[int], bool]] = ()) -> int:
    """Return the total weight of the words of a given length whose first letters satisfy `prefix`."""
    if not completions.automaton.states or len(prefix) > length:
        return 0
    reached = states_after(completions.automaton, prefix)
    row = completions.last_row(length - len(prefix))
    return sum(weight * int(row[state]) for state, weight in reached.items())


def count_following(
    completions: Completions, length: int, prefix: Sequence[Callable[[int], bool]] = ()
) -> dict[int, int]:
    """Return, for each letter that can follow `prefix`, the total weight of the words that continue with it."""
    automaton = completions.automaton
    found: dict[int, int] = {}
    if not automaton.states or len(prefix) >= length:
        return found
    row = completions.row(length - len(prefix) - 1)
    for state, weight in states_after(automaton, prefix).items():
        for edge in range(int(automaton.offsets[state]), int(automaton.offsets[state + 1])):
            behind = weight * int(row[automaton.targets[edge]])
            if behind:
                letter = int(automaton.letters[edge])
                factor = 1 if automaton.weights is None else int(automaton.weights[edge])
                found[letter] = found.get(letter, 0) + behind * factor
    return {letter: number for letter, number in sorted(found.items()) if number}


def states_after(automaton: Automaton, prefix: Sequence[Callable[[int], bool]]) -> dict[int, int]:
    """Return the states after paths with letters that satisfy `prefix`, each with the weight of these paths."""
    reached: dict[int, int] = {0: 1}
    for allowed in prefix:
        following: dict[int, int] = {}
        for state, weight in reached.items():
            for edge in range(int(automaton.offsets[state]), int(automaton.offsets[state + 1])):
                if allowed(int(automaton.letters[edge])):
                    target = int(automaton.targets[edge])
                    factor = 1 if automaton.weights is None else int(automaton.weights[edge])
                    following[target] = following.get(target, 0) + weight * factor
        reached = following
    return reached


def weights_by_length(completions: Completions, number: int) -> list[int]:
    """Return the total weight of the words of each length 0, 1, ..., `number` - 1."""
    if not completions.automaton.states:
        return [0] * number
    weights, row = [], completions.row(0)
    for _ in range(number):
        weights.append(int(row[0]))
        row = completions.following(row)
    return weights


def words(completions: Completions, length: int, prefix: Sequence[Callable[[int], bool]] = ()) -> Iterator[Word]:
    """Yield the words of a given length in order, lazily; for `prefix`, see `count_words`."""
    automaton = completions.automaton
    if not automaton.states or len(prefix) > length or not completions.row(length)[0]:
        return

    def onward(state: int, step: int) -> Iterator[tuple[int, int]]:
        for edge in range(int(automaton.offsets[state]), int(automaton.offsets[state + 1])):
            letter, target = int(automaton.letters[edge]), int(automaton.targets[edge])
            if (step >= len(prefix) or prefix[step](letter)) and completions.row(length - step - 1)[target]:
                yield letter, target

    yield from words_along(0, length, onward)


class Ranking:
    """The words of one length in lexicographic order of their letters (Nijenhuis and Wilf 1978), without weights.

    Only rows of completions are cached, so that memory does not grow with the number of queries.
    """

    def __init__(self, completions: Completions, length: int) -> None:
        self._completions = completions
        self._length = length
        self.total = count_words(completions, length)
        completions.row(length)

    def unrank(self, rank: int) -> Word:
        """Return the word with a given rank, from 0 to total - 1."""
        word, state = [], 0
        for left in range(self._length - 1, -1, -1):
            row = self._completions.row(left)
            letters, targets = self._completions.automaton.edges[state]
            place, behind = 0, int(row[targets[0]])
            while rank >= behind:
                rank -= behind
                place += 1
                behind = int(row[targets[place]])
            word.append(letters[place])
            state = targets[place]
        return tuple(word)

    def rank(self, word: Sequence[int]) -> int | None:
        """Return the rank of a word, or None if it is not a word of this length."""
        rank, state = 0, 0
        if len(word) != self._length or not accepts(self._completions.automaton, word):
            return None
        for left, letter in zip(range(self._length - 1, -1, -1), word, strict=True):
            row = self._completions.row(left)
            letters, targets = self._completions.automaton.edges[state]
            place = letters.index(letter)
            rank += sum(int(row[target]) for target in targets[:place])
            state = targets[place]
        return rank
