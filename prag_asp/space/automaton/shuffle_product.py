"""The words of several automata, shuffled: in order, by rank and as samples, without their product automaton.

A state of the whole is a state of each part. The words that complete it are the shuffles of words that complete these:
with n letters to come, the sum over the ways to write n as a sum of one length for each part, of the multinomial
coefficient and the product of what the parts have (Stanley, Enumerative Combinatorics 2, 5.1). So memory grows with
the sum of the parts' states, and not with their product.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cache, lru_cache, partial
from itertools import accumulate
from math import comb
from operator import mul

import numpy as np

from prag_asp.space.automaton.automaton import Completions, Word
from prag_asp.space.automaton.walks import Choice, owner_of, words_along

REMEMBERED = 1 << 12
"""Number of states whose completions are remembered."""

Ways = tuple[int, ...]
"""Weights of words by their length, from 0 on; what is not there is 0."""

NOTHING: Ways = (1,)
"""The weight of the empty word."""

State = tuple[int, ...]
"""A state of each part."""


@dataclass(frozen=True)
class PartEdge:
    """One edge of a state: its letter, what it weighs, the part that acts, and the state of the part after it."""

    letter: int
    weight: int
    part: int
    target: int


class ShuffledWords:
    """The words of one length that are shuffles of one word of each part; `total` is the sum of their weights.

    `letters` has the numbers in the whole of the letters of each part; no letter is one of two parts. Without weights
    on the parts, words come in the order and with the ranks that the automaton of the whole would give them.
    """

    def __init__(self, parts: Sequence[Completions], letters: Sequence[Sequence[int]], length: int) -> None:
        self._parts = parts
        self._letters = letters
        self._length = length
        self._ways = lru_cache(REMEMBERED)(self._compute_ways)
        self._own = lru_cache(REMEMBERED)(self._compute_own)
        self._behind = lru_cache(REMEMBERED)(self._compute_behind)
        self._beside = lru_cache(REMEMBERED)(_beside_each)
        self._start: State = (0,) * len(parts)
        inhabited = all(part.automaton.states for part in parts)
        self.total = self._completions(self._start, length) if inhabited else 0

    def weighing(self, weights: Sequence[int]) -> ShuffledWords:
        """Return the same words, where the letters of the whole weigh so much."""
        parts = []
        for part, letters in zip(self._parts, self._letters, strict=True):
            by_letter = np.array([weights[letter] for letter in letters], dtype=object)
            parts.append(Completions(replace(part.automaton, weights=by_letter[part.automaton.letters])))
        return ShuffledWords(parts, self._letters, self._length)

    def words(self, prefix: Sequence[Collection[int]] = ()) -> Iterator[Word]:
        """Yield the words whose first letters are among those of `prefix`, in order, lazily."""
        if not self.total or len(prefix) > self._length:
            return

        def onward(state: State, step: int) -> Iterator[tuple[int, State]]:
            for edge, behind in zip(self._onward(state), self._behind(state, self._length - step - 1), strict=True):
                if behind and (step >= len(prefix) or edge.letter in prefix[step]):
                    yield edge.letter, _move(state, edge)

        yield from words_along(self._start, self._length, onward)

    def count(self, prefix: Sequence[Collection[int]]) -> int:
        """Return the weight of the words whose first letters are among those of `prefix`."""
        if not self.total or len(prefix) > self._length:
            return 0
        reached = {self._start: 1}
        for allowed in prefix:
            following: dict[State, int] = {}
            for state, weight in reached.items():
                for edge in self._onward(state):
                    if edge.letter in allowed:
                        after = _move(state, edge)
                        following[after] = following.get(after, 0) + weight * edge.weight
            reached = following
        left = self._length - len(prefix)
        return sum(weight * self._completions(state, left) for state, weight in reached.items())

    def unrank(self, rank: int) -> Word:
        """Return the word that owns a rank from 0 to total - 1."""
        return self.walk(owner_of(rank))[0]

    def rank(self, word: Sequence[int]) -> int | None:
        """Return the rank of a word where all weigh 1, or None where it is no word."""
        if not self.total or len(word) != self._length:
            return None
        rank, state = 0, self._start
        for step, letter in enumerate(word):
            edges, running = self._onward(state), self._running(state, step)
            place = next((place for place, edge in enumerate(edges) if edge.letter == letter), None)
            before = running[place - 1] if place else 0
            if place is None or running[place] == before:
                return None
            rank += before
            state = _move(state, edges[place])
        return rank

    def walk(self, choose: Choice) -> tuple[Word, int]:
        """Return a word and its weight; `choose` takes an edge of each step by the running totals of their weights."""
        word, weight, state = [], 1, self._start
        for step in range(self._length):
            edge = self._onward(state)[choose(step, self._running(state, step))]
            word.append(edge.letter)
            weight *= edge.weight
            state = _move(state, edge)
        return tuple(word), weight

    def _running(self, state: State, step: int) -> list[int]:
        return list(accumulate(self._behind(state, self._length - step - 1)))

    def _onward(self, state: State) -> list[PartEdge]:
        """Return the edges of a state, in order of their letters."""
        edges = (edge for part, own in enumerate(state) for edge in self._own(part, own))
        return sorted(edges, key=lambda edge: edge.letter)

    def _compute_own(self, part: int, state: int) -> list[PartEdge]:
        automaton = self._parts[part].automaton
        first, last = automaton.offsets[state : state + 2].tolist()
        weights = [1] * (last - first) if automaton.weights is None else automaton.weights[first:last].tolist()
        letters, targets = automaton.letters[first:last].tolist(), automaton.targets[first:last].tolist()
        return [
            PartEdge(self._letters[part][letter], weight, part, target)
            for letter, target, weight in zip(letters, targets, weights, strict=True)
        ]

    def _compute_ways(self, part: int, state: int) -> Ways:
        """Return the weight of the words of a part that complete a state of it, by their length."""
        return tuple([int(self._parts[part].row(left)[state]) for left in range(self._length + 1)])

    def _completions(self, state: State, left: int) -> int:
        """Return the weight of all words of a length that complete a state."""
        found: Ways = NOTHING
        for part, own in enumerate(state):
            found = _shuffle(found, self._ways(part, own), left)
        return found[left]

    def _compute_behind(self, state: State, left: int) -> list[int]:
        """Return the weight of all words that go on over each edge of a state, with `left` letters after it."""
        ways = [self._ways(part, own) for part, own in enumerate(state)]
        beside = self._beside(tuple(sorted(ways)), left)
        return [
            edge.weight * sum(map(mul, self._ways(edge.part, edge.target), beside[ways[edge.part]]))
            for edge in self._onward(state)
        ]


def _beside_each(ways: Sequence[Ways], left: int) -> dict[Ways, list[int]]:
    """Return how many times each number of words of a part counts in the whole, by the length of that word.

    That is the weight of the shuffles of one word of each other part, times the ways to put them and the word together
    to `left` letters. Parts that have the same have the same beside them.
    """
    before = list(accumulate(ways[:-1], partial(_shuffle, length=left), initial=NOTHING))
    behind = list(accumulate(ways[:0:-1], partial(_shuffle, length=left), initial=NOTHING))
    found = {}
    for own, sooner, later in zip(ways, before, reversed(behind), strict=True):
        if own not in found:
            rest = _shuffle(sooner, later, left)
            found[own] = [number * each for number, each in zip(_binomials(left), reversed(rest), strict=True)]
    return found


def _move(state: State, edge: PartEdge) -> State:
    return (*state[: edge.part], edge.target, *state[edge.part + 1 :])


def _shuffle(first: Ways, second: Ways, length: int) -> Ways:
    """Return the weight of the shuffles of two words by their length, up to one (binomial convolution)."""
    second = second + (0,) * (length + 1 - len(second))
    return tuple([sum(map(mul, map(mul, _binomials(n), first), reversed(second[: n + 1]))) for n in range(length + 1)])


@cache
def _binomials(n: int) -> list[int]:
    return [comb(n, k) for k in range(n + 1)]
