"""A compiled formula, which gives exact totals, marginals and samples in time linear in its size.

A node is a disjunction of mutually exclusive branches; a branch is a conjunction of literals and nodes that share no
variable (a deterministic decomposable negation normal form; Darwiche 2001). Totals are therefore sums of products, and
models are sampled top-down by choosing each branch in proportion to its total.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from math import prod
from typing import NamedTuple

from prag_asp.logic.formula.clause_builder import TRUE, Literal
from prag_asp.random_bits import WORD, SeededBits

MOST_WORDS = 2**18
"""The maximum number of random words per batch."""


class Branch(NamedTuple):
    """A branch of a node: literals and the numbers of child nodes, which precede the node."""

    literals: tuple[Literal, ...]
    children: tuple[int, ...]


@dataclass(frozen=True)
class Diagram:
    """Nodes as tuples of branches; the last node is the root. A diagram without nodes has no model."""

    nodes: tuple[tuple[Branch, ...], ...]

    def given(self, literals: Iterable[Literal]) -> Diagram:
        """Return the diagram of the models that contain all given literals; a literal may be ``TRUE`` or ``-TRUE``."""
        against = {-literal for literal in literals}
        if TRUE in against:
            return Diagram(())
        nodes: list[tuple[Branch, ...]] = []
        renumbered: list[int] = []  # -1 for a node without models
        for branches in self.nodes:
            left = tuple(
                Branch(branch.literals, tuple(renumbered[child] for child in branch.children))
                for branch in branches
                if against.isdisjoint(branch.literals) and all(renumbered[child] >= 0 for child in branch.children)
            )
            renumbered.append(len(nodes) if left else -1)
            if left:
                nodes.append(left)
        return Diagram(tuple(nodes) if renumbered and renumbered[-1] >= 0 else ())


_Choice = tuple[int, Branch, Branch, Callable[[Iterator[int]], bool]]


@dataclass(frozen=True)
class WeightedDiagram:
    """A diagram with weights: a model's weight is the product of the integer weights of its literals, by default 1."""

    diagram: Diagram
    weights: Mapping[Literal, int]

    def unweighted(self) -> WeightedDiagram:
        """Return the same diagram without weights."""
        return WeightedDiagram(self.diagram, {})

    @property
    def total(self) -> int:
        """The sum of the weights of all models, which is their number if there are no weights."""
        return self._totals[-1] if self._totals else 0

    @cached_property
    def _totals(self) -> list[int]:
        """The total weight of each node."""
        totals: list[int] = []
        for branches in self.diagram.nodes:
            totals.append(
                sum(self._weight(branch) * prod(totals[child] for child in branch.children) for branch in branches)
            )
        return totals

    def _weight(self, branch: Branch) -> int:
        return prod(self.weights.get(literal, 1) for literal in branch.literals) if self.weights else 1

    def marginals(self) -> dict[Literal, int]:
        """Return the total weight of the models that contain each literal; literals with a total of 0 are omitted.

        The context weight of a node is the total weight of the models through the node, divided by the node's total
        (Darwiche 2003).
        """
        totals, around = self._totals, [0] * len(self._totals)
        marginals: dict[Literal, int] = {}
        if around:
            around[-1] = 1
        for node in reversed(range(len(around))):
            for branch in self.diagram.nodes[node] if around[node] else ():
                outside = around[node] * self._weight(branch)
                through = outside * prod(totals[child] for child in branch.children)
                if not through:
                    continue
                for literal in branch.literals:
                    marginals[literal] = marginals.get(literal, 0) + through
                for child in branch.children:
                    around[child] += through // totals[child]
        return marginals

    def sample(self, seed: int) -> Iterator[list[Literal]]:
        """Yield models endlessly, with probabilities proportional to their weights; the total must be above 0.

        Each sample uses separate random words, whose number is the same for all samples.
        """
        bits = SeededBits(seed, "models")
        choices: dict[int, _Choice] = {}
        choices_below: list[int] = []  # for each node, the maximum number of choices in a sample
        for branches in self.diagram.nodes:
            below = max(sum(choices_below[child] for child in branch.children) for branch in branches)
            choices_below.append(below + (len(branches) > 1))
        most = max(choices_below[-1], 1)
        root, batch, first = len(self.diagram.nodes) - 1, 1, 0
        while True:
            for draw, words in enumerate(bits.words(first, batch, most).tolist(), first):
                step, waiting = 0, [root]
                literals: list[Literal] = []
                while waiting:
                    node = waiting.pop()
                    if node not in choices:
                        choices[node] = self._choice(node)
                    threshold, one, other, exactly = choices[node]
                    if threshold >= 0:
                        word = words[step]
                        step += 1
                        if word > threshold or (word == threshold and not exactly(bits.further(draw, step))):
                            one = other
                    literals += one.literals
                    waiting += one.children
                yield literals
            first += batch
            batch = min(2 * batch, max(MOST_WORDS // most, 1))

    def _choice(self, node: int) -> _Choice:
        """Return the choice at a node: its first branch if a random word is below a threshold, otherwise the second.

        A negative threshold means that only one branch is possible.
        """
        totals, branches = self._totals, self.diagram.nodes[node]
        weighed = [
            (self._weight(branch) * prod(totals[child] for child in branch.children), branch) for branch in branches
        ]
        ways = [(weight, branch) for weight, branch in weighed if weight]
        if len(ways) == 1:
            return -1, ways[0][1], ways[0][1], lambda _: False
        (first, one), (_, other) = ways
        threshold, rest = divmod(first << WORD, totals[node])
        return threshold, one, other, _among(rest, totals[node])


def _among(rest: int, total: int) -> Callable[[Iterator[int]], bool]:
    """Return a tie-breaker for a word equal to the threshold, which tests whether the next words are below the rest."""

    def below(words: Iterator[int]) -> bool:
        left = rest
        while left:
            threshold, left = divmod(left << WORD, total)
            word = next(words)
            if word != threshold:
                return word < threshold
        return False

    return below
