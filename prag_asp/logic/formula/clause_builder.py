"""Clauses under construction: each gate is defined once, and its output is a function of its inputs."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import NamedTuple

Literal = int
"""A variable from 1 upwards, negative if it is negated."""

TRUE: Literal = 1
"""The first variable is always true, so that constants are literals and no clause is empty."""


MANY = 16
"""The minimum number of literals of a recorded sum; the nodes of shorter sums are ordinary gates."""


class Sum(NamedTuple):
    """A literal that is true if the weights of the true literals reach a bound; all weights are positive."""

    output: Literal
    bound: int
    literals: tuple[Literal, ...]
    weights: tuple[int, ...]


class ClauseBuilder:
    """A growing set of clauses.

    `sums` holds, by output, the sums whose clauses define several nodes of a diagram. `nodes` holds the variables of
    those nodes that are not outputs of sums, so that only clauses of sums contain them.

    Every method that returns a literal adds clauses that fix its value for each assignment of the given literals, so no
    method changes the number of models.

    With `sums_apart`, no clause defines the output of a sum: a sum is only recorded in `sums`, unless it is a
    conjunction or a disjunction.
    """

    def __init__(self, *, sums_apart: bool = False) -> None:
        self.variables = 1
        self._sums_apart = sums_apart
        self._outputs: dict[tuple[int, tuple[tuple[int, Literal], ...]], Literal] = {}
        self.clauses: list[tuple[Literal, ...]] = [(TRUE,)]
        self.sums: dict[Literal, Sum] = {}
        self.nodes: set[Literal] = set()
        self._gates: dict[frozenset[Literal], Literal] = {}
        self._choices: dict[tuple[Literal, Literal, Literal], Literal] = {}

    def fresh(self) -> Literal:
        """Return a variable that no clause contains."""
        self.variables += 1
        return self.variables

    def add(self, *literals: Literal) -> None:
        """Add a clause."""
        clause = set(literals) - {-TRUE}
        if TRUE not in clause and not any(-literal in clause for literal in clause):
            self.clauses.append(tuple(sorted(clause, key=abs)) or (-TRUE,))

    def equate(self, first: Literal, second: Literal) -> None:
        """State that two literals have the same value."""
        self.add(-first, second)
        self.add(first, -second)

    def all_of(self, literals: Iterable[Literal], into: Literal | None = None) -> Literal:
        """Return the conjunction of the given literals; with `into`, state that this literal is equivalent to it."""
        inputs = set(literals) - {TRUE}
        if -TRUE in inputs or any(-literal in inputs for literal in inputs):
            existing: Literal | None = -TRUE
        elif len(inputs) < 2:
            existing = next(iter(inputs), TRUE)
        else:
            existing = self._gates.get(frozenset(inputs))
        if existing is not None:
            if into is not None:
                self.equate(into, existing)
            return existing
        output = self._gates[frozenset(inputs)] = self.fresh() if into is None else into
        for literal in inputs:
            if abs(literal) == abs(output):  # a rule may derive an atom from itself
                self.add(-output, literal)
            else:
                self.clauses.append((-output, literal) if abs(output) < abs(literal) else (literal, -output))
        self.add(output, *(-literal for literal in inputs))
        return output

    def any_of(self, literals: Iterable[Literal], into: Literal | None = None) -> Literal:
        """Return the disjunction of the given literals; with `into`, state that this literal is equivalent to it."""
        return -self.all_of((-literal for literal in literals), None if into is None else -into)

    def at_least(self, bound: int, literals: Sequence[Literal], weights: Sequence[int]) -> Literal:
        """Return a literal that is true if the positive weights of the true literals reach a bound.

        The sum is encoded as a binary decision diagram (Eén and Sörensson 2006): node (i, b) states that the weights of
        the true literals from the i-th on reach b.
        """
        terms = sorted(zip(weights, literals, strict=True), reverse=True)
        if self._sums_apart:
            return self._sum_apart(bound, terms)
        remaining = [0]
        for weight, _ in reversed(terms):
            remaining.append(remaining[-1] + weight)
        remaining.reverse()
        open_bounds = [{bound}]
        for place, (weight, _) in enumerate(terms):
            target = {below for above in open_bounds[-1] for below in (above, above - weight)}
            open_bounds.append({each for each in target if 0 < each <= remaining[place + 1]})
        nodes: dict[int, Literal] = {}
        every: set[Literal] = set()
        for place in reversed(range(len(terms))):
            weight, literal = terms[place]

            def node(target: int, below: int = place + 1, below_nodes: dict[int, Literal] = nodes) -> Literal:
                if target <= 0:
                    return TRUE
                return below_nodes[target] if target <= remaining[below] else -TRUE

            nodes = {
                target: self._reached(literal, node(target - weight), node(target))
                for target in sorted(open_bounds[place])
                if 0 < target <= remaining[place]
            }
            every.update(nodes.values())
        if bound <= 0:
            return TRUE
        output = nodes.get(bound, -TRUE)
        self.nodes.discard(output)
        if len(terms) < MANY:
            self.nodes -= every
        elif not self.nodes.isdisjoint(every):
            self.sums[output] = Sum(output, bound, tuple(literals), tuple(weights))
        return output

    def _sum_apart(self, bound: int, terms: Sequence[tuple[int, Literal]]) -> Literal:
        """Return the output of a sum that no clause defines, or of an equivalent gate."""
        whole = sum(weight for weight, _ in terms)
        if bound <= 0 or bound > whole:
            return TRUE if bound <= 0 else -TRUE
        if terms[-1][0] >= bound:
            return self.any_of(literal for _, literal in terms)
        if whole - terms[-1][0] < bound:
            return self.all_of(literal for _, literal in terms)
        key = (bound, tuple(terms))
        if key not in self._outputs:
            weights, literals = zip(*terms, strict=True)
            output = self._outputs[key] = self.fresh()
            self.sums[output] = Sum(output, bound, literals, weights)
        return self._outputs[key]

    def _reached(self, literal: Literal, high: Literal, low: Literal) -> Literal:
        """Return the literal of a node, given the literals of its `high` and `low` children; `low` implies `high`."""
        if high == low or literal == -TRUE:
            return low
        if literal == TRUE:
            return high
        if (high, low) == (TRUE, -TRUE):
            return literal
        key = (literal, high, low)
        if key not in self._choices:
            output = self._choices[key] = self.fresh()
            self.nodes.add(output)
            self.add(-output, high)
            self.add(-output, literal, low)
            self.add(output, -literal, -high)
            self.add(output, -low)
        return self._choices[key]
