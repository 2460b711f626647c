"""Lists, ranks and samples of the shuffles of the words of several automata, without their product automaton.

A state of the product consists of one state of each part. Its completions are the shuffles of completions of the parts:
for n letters, their number is the sum, over all compositions of n into one length per part, of the multinomial
coefficient times the product of the parts' own numbers of completions (Stanley, Enumerative Combinatorics 2, 5.1).
Memory therefore grows with the sum of the parts' states, not with their product.
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
"""The number of states whose completions are cached."""

Ways = tuple[int, ...]
"""Total weights of words by length, starting at length 0; missing entries are 0."""

NOTHING: Ways = (1,)
"""The weight of the empty word."""

State = tuple[int, ...]
"""A state of each part."""


@dataclass(frozen=True)
class PartEdge:
    """An edge of a state: its letter, its weight, the acting part, and the successor of this part."""

    letter: int
    weight: int
    part: int
    target: int


class ShuffledWords:
    """All shuffles of one word from each part that result in a given length; `total` is the sum of their weights.

    `letters` maps the letters of each part to their numbers in the product automaton; parts share no letters. Without
    weights, words have the order and the ranks of the product automaton.
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
        """Return the same words, weighted by `weights`, the weights of the letters of the product automaton."""
        parts = []
        for part, letters in zip(self._parts, self._letters, strict=True):
            by_letter = np.array([weights[letter] for letter in letters], dtype=object)
            parts.append(Completions(replace(part.automaton, weights=by_letter[part.automaton.letters])))
        return ShuffledWords(parts, self._letters, self._length)

    def words(self, prefix: Sequence[Collection[int]] = ()) -> Iterator[Word]:
        """Yield the words whose first letters `prefix` allows, in order, lazily."""
        if not self.total or len(prefix) > self._length:
            return

        def onward(state: State, step: int) -> Iterator[tuple[int, State]]:
            for edge, behind in zip(self._onward(state), self._behind(state, self._length - step - 1), strict=True):
                if behind and (step >= len(prefix) or edge.letter in prefix[step]):
                    yield edge.letter, _move(state, edge)

        yield from words_along(self._start, self._length, onward)

    def count(self, prefix: Sequence[Collection[int]]) -> int:
        """Return the total weight of the words whose first letters `prefix` allows."""
        if not self.total or len(prefix) > self._length:
            return 0
        left = self._length - len(prefix)
        return sum(weight * self._completions(state, left) for state, weight in self._after(prefix).items())

    def following(self, prefix: Sequence[Collection[int]]) -> dict[int, int]:
        """Return, for each letter that can follow `prefix`, the total weight of the words that continue with it."""
        found: dict[int, int] = {}
        if not self.total or len(prefix) >= self._length:
            return found
        left = self._length - len(prefix) - 1
        for state, weight in self._after(prefix).items():
            for edge, behind in zip(self._onward(state), self._behind(state, left), strict=True):
                found[edge.letter] = found.get(edge.letter, 0) + weight * behind
        return {letter: number for letter, number in sorted(found.items()) if number}

    def _after(self, prefix: Sequence[Collection[int]]) -> dict[State, int]:
        """Return the states after the words that `prefix` allows, each with the total weight of these words."""
        reached = {self._start: 1}
        for allowed in prefix:
            following: dict[State, int] = {}
            for state, weight in reached.items():
                for edge in self._onward(state):
                    if edge.letter in allowed:
                        after = _move(state, edge)
                        following[after] = following.get(after, 0) + weight * edge.weight
            reached = following
        return reached

    def unrank(self, rank: int) -> Word:
        """Return the word with a given rank, from 0 to total - 1."""
        return self.walk(owner_of(rank))[0]

    def rank(self, word: Sequence[int]) -> int | None:
        """Return the rank of a word if all weights are 1, or None if it is not a word."""
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
        """Return a word and its weight.

        At each step, `choose` selects an edge, given the running totals of the weights.
        """
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
        """Return, for each length, the total weight of the completions of a state of a part."""
        return tuple([int(self._parts[part].row(left)[state]) for left in range(self._length + 1)])

    def _completions(self, state: State, left: int) -> int:
        """Return the total weight of the completions of a state that have `left` letters."""
        shuffled: Ways = NOTHING
        for part, own in enumerate(state):
            shuffled = _shuffle(shuffled, self._ways(part, own), left)
        return shuffled[left]

    def _compute_behind(self, state: State, left: int) -> list[int]:
        """Return the total weight of the words through each edge of a state, with `left` letters after it."""
        ways = [self._ways(part, own) for part, own in enumerate(state)]
        beside = self._beside(tuple(sorted(ways)), left)
        return [
            edge.weight * sum(map(mul, self._ways(edge.part, edge.target), beside[ways[edge.part]]))
            for edge in self._onward(state)
        ]


def _beside_each(ways: Sequence[Ways], left: int) -> dict[Ways, list[int]]:
    """Return, for each part and each length of its word, the factor that the other parts contribute.

    The factor is the weight of the shuffles of one word from each other part, times the number of ways to shuffle them
    with the word of the part so that `left` letters result. Parts with equal completions have equal factors.
    """
    before = list(accumulate(ways[:-1], partial(_shuffle, length=left), initial=NOTHING))
    behind = list(accumulate(ways[:0:-1], partial(_shuffle, length=left), initial=NOTHING))
    factors = {}
    for own, sooner, later in zip(ways, before, reversed(behind), strict=True):
        if own not in factors:
            rest = _shuffle(sooner, later, left)
            factors[own] = [number * weight for number, weight in zip(_binomials(left), reversed(rest), strict=True)]
    return factors


def _move(state: State, edge: PartEdge) -> State:
    return (*state[: edge.part], edge.target, *state[edge.part + 1 :])


def _shuffle(first: Ways, second: Ways, length: int) -> Ways:
    """Return the total weight of shuffles of two words for each length up to `length` (binomial convolution)."""
    second = second + (0,) * (length + 1 - len(second))
    return tuple([sum(map(mul, map(mul, _binomials(n), first), reversed(second[: n + 1]))) for n in range(length + 1)])


@cache
def _binomials(n: int) -> list[int]:
    return [comb(n, k) for k in range(n + 1)]
