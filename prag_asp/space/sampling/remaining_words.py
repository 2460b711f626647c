"""Exact sampling without replacement: each word is sampled by weight from the remaining words of a set.

For each prefix of choices, the weights of the words already taken are summed; a walk subtracts them. Thus no draw is
rejected, and sampling ends only when no weight remains.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import partial
from itertools import accumulate, pairwise
from math import prod

import numpy as np

from prag_asp.random_bits import Bits
from prag_asp.space.automaton.automaton import Completions, Word
from prag_asp.space.automaton.walks import Choice
from prag_asp.space.sampling.choice_table import exact_choice, weights_behind
from prag_asp.space.weights.weights import Walks, Weighed


@dataclass
class _Prefix:
    """The weight of the words taken through each edge after a prefix of choices, and the prefixes after those edges."""

    taken: dict[int, int] = field(default_factory=dict)
    after: dict[int, _Prefix] = field(default_factory=dict)


class RemainingWords:
    """The remaining words of one length in a set: their total weight, and the number of words `taken`."""

    def __init__(self, walks: Walks, length: int) -> None:
        self._walks = walks
        self._length = length
        self._root = _Prefix()
        self.weight, self.taken = self._walks.total, 0

    def take(self, bits: Bits, number: int) -> tuple[Word, int]:
        """Take a remaining word, sampled with the random bits of draw `number`; return it with its weight.

        The remaining weight must be positive.
        """
        random = bits.words(number, 1, max(self._length, 1))[0].tolist()
        prefix, path = self._root, list[tuple[_Prefix, int, int, int]]()  # the last two: totals of edge and source

        def choose(step: int, running: Sequence[int]) -> int:
            nonlocal prefix
            weights = [later - sooner for sooner, later in pairwise((0, *running))]
            left = accumulate(weight - prefix.taken.get(edge, 0) for edge, weight in enumerate(weights))
            edge = exact_choice(list(left), random[step], partial(bits.further, number, step))
            path.append((prefix, edge, weights[edge], running[-1]))
            prefix = prefix.after.setdefault(edge, _Prefix())
            return edge

        word, weight = self._walks.walk(choose)
        # The total of an edge is its own weight times the total of its target, so the weight of each suffix of the
        # word follows from the weight of the next shorter one.
        rest, behind = 1, 1
        for prefix, edge, over, total in reversed(path):
            rest, remainder = divmod(over * rest, behind)
            assert not remainder, "a walk weighs an edge by itself times what follows it"
            prefix.taken[edge] = prefix.taken.get(edge, 0) + rest
            behind = total
        self.weight -= weight
        self.taken += 1
        return word, weight


def walks_of(weighed: Weighed, length: int) -> Walks:
    """Return walks that choose the words of a given length letter by letter."""
    return weighed.ranking or PathWalks(weighed.completions, length)


class PathWalks:
    """Walks along the paths of an automaton from the state `start`; each path is one word."""

    def __init__(self, completions: Completions, length: int, start: int = 0) -> None:
        self._completions = completions
        self._length = length
        self._start = start
        self.total = int(completions.row(length)[start]) if completions.automaton.states else 0

    def walk(self, choose: Choice) -> tuple[Word, int]:
        """Return a word and its weight.

        At each step, `choose` selects an edge, given the running totals of the weights.
        """
        automaton, state = self._completions.automaton, self._start
        edges = []
        for step in range(self._length):
            first, last = automaton.offsets[state : state + 2].tolist()
            outgoing = np.arange(first, last)
            row = self._completions.row(self._length - step - 1)
            edge = first + choose(step, list(accumulate(weights_behind(automaton, outgoing, row))))
            edges.append(edge)
            state = int(automaton.targets[edge])
        weights = [] if automaton.weights is None else [int(automaton.weights[edge]) for edge in edges]
        return tuple(int(automaton.letters[edge]) for edge in edges), prod(weights)
