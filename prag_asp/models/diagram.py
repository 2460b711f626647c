"""A compiled formula: totals, marginals and samples in time linear in its size, all of them exact.

A node is a choice among branches that exclude each other; a branch is literals and further nodes that share no variable
(a deterministic decomposable negation normal form; Darwiche 2001). So totals are sums of products, and a model is
sampled from the top by choosing each branch with the share of its total.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from math import prod
from typing import NamedTuple

from prag_asp.logic.formula.clause_builder import Literal
from prag_asp.random_bits import WORD, SeededBits

MOST_WORDS = 2**18
"""Random words that are generated at once."""


class Branch(NamedTuple):
    """One way on: literals, and the numbers of nodes that all follow; each comes before the node of the branch."""

    literals: tuple[Literal, ...]
    children: tuple[int, ...]


@dataclass(frozen=True)
class Diagram:
    """Nodes, each a tuple of branches, the last one the root; without nodes, there is no model."""

    nodes: tuple[tuple[Branch, ...], ...]


_Choice = tuple[int, Branch, Branch, Callable[[Iterator[int]], bool]]


@dataclass(frozen=True)
class WeightedDiagram:
    """A diagram whose models have weights: the product of a whole number for each literal that has one, otherwise 1."""

    diagram: Diagram
    weights: Mapping[Literal, int]

    @property
    def total(self) -> int:
        """The sum of the weights of all models: without weights, their number."""
        return self._totals[-1] if self._totals else 0

    @cached_property
    def _totals(self) -> list[int]:
        """The sum of each node."""
        totals: list[int] = []
        for branches in self.diagram.nodes:
            totals.append(
                sum(self._weight(branch) * prod(totals[each] for each in branch.children) for branch in branches)
            )
        return totals

    def _weight(self, branch: Branch) -> int:
        return prod(self.weights[each] for each in branch.literals if each in self.weights) if self.weights else 1

    def marginals(self) -> dict[Literal, int]:
        """Return for each literal the sum of the weights of the models that have it; what none has is left out.

        What surrounds a node weighs as much as all models through it, divided by its own total (Darwiche 2003).
        """
        totals, around = self._totals, [0] * len(self._totals)
        found: dict[Literal, int] = {}
        if around:
            around[-1] = 1
        for node in reversed(range(len(around))):
            for branch in self.diagram.nodes[node] if around[node] else ():
                outside = around[node] * self._weight(branch)
                through = outside * prod(totals[each] for each in branch.children)
                if not through:
                    continue
                for literal in branch.literals:
                    found[literal] = found.get(literal, 0) + through
                for child in branch.children:
                    around[child] += through // totals[child]
        return found

    def sample(self, seed: int) -> Iterator[list[Literal]]:
        """Yield models without end, each sampled with a probability proportional to its weight; the total is above 0.

        Each sample has its own random words, whose number is the same for all samples.
        """
        bits = SeededBits(seed, "models")
        known: dict[int, _Choice] = {}
        most = max(self._most_choices, 1)
        root, batch, first = len(self.diagram.nodes) - 1, max(MOST_WORDS // most, 1), 0
        while True:
            for draw, words in enumerate(bits.words(first, batch, most).tolist(), first):
                step, waiting = 0, [root]
                literals: list[Literal] = []
                while waiting:
                    node = waiting.pop()
                    if node not in known:
                        known[node] = self._choice(node)
                    threshold, one, other, exactly = known[node]
                    if threshold >= 0:
                        word = words[step]
                        step += 1
                        if word > threshold or (word == threshold and not exactly(bits.further(draw, step))):
                            one = other
                    literals += one.literals
                    waiting += one.children
                yield literals
            first += batch

    def _choice(self, node: int) -> _Choice:
        """Return how a node is left: by its first branch where a random word is below a threshold, else by the other.

        Where it can be left in one way only, the threshold is negative.
        """
        totals, branches = self._totals, self.diagram.nodes[node]
        weighed = [(self._weight(each) * prod(totals[child] for child in each.children), each) for each in branches]
        ways = [(weight, each) for weight, each in weighed if weight]
        if len(ways) == 1:
            return -1, ways[0][1], ways[0][1], _never
        (first, one), (_, other) = ways
        threshold, rest = divmod(first << WORD, totals[node])
        return threshold, one, other, _among(rest, totals[node])

    @property
    def _most_choices(self) -> int:
        """The most choices that a sample takes."""
        most: list[int] = []
        for branches in self.diagram.nodes:
            most.append(max(sum(most[each] for each in branch.children) for branch in branches) + (len(branches) > 1))
        return most[-1]


def _never(words: Iterator[int]) -> bool:
    return False


def _among(rest: int, total: int) -> Callable[[Iterator[int]], bool]:
    """Return what decides where a word is the threshold: whether the words after it lie below the rest of the share."""

    def below(words: Iterator[int]) -> bool:
        left = rest
        while left:
            threshold, left = divmod(left << WORD, total)
            word = next(words)
            if word != threshold:
                return word < threshold
        return False

    return below
