"""The costs of edits, which replace, insert or delete an action or a state."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from math import lcm

import numpy as np
from numpy.typing import NDArray

from prag_asp.errors import QueryError
from prag_asp.similarity.background import Background
from prag_asp.similarity.symbols import Symbol

Cost = Callable[[Symbol, Symbol], Fraction]
"""The cost of replacing one symbol with another; None in place of a symbol stands for an insertion or a deletion."""

LARGEST = 2**62
"""A bound on costs in integer units, so that the sum of two distances fits into 64 bits."""


def unit_cost(background: Background) -> Cost:
    """Return the cost function in which every edit costs 1 (Levenshtein 1966)."""
    return lambda one, other: Fraction(int(one != other))


def class_cost(background: Background) -> Cost:
    """Return the cost function in which replacing an action costs the mean class-tree distance between the arguments.

    Inserting an action, deleting it, or replacing it with one that has a different name costs 1.
    """

    def cost(one: Symbol, other: Symbol) -> Fraction:
        if one is None or other is None:
            return Fraction(int(one is not other))
        return background.tree.atom_distance(one, other)

    return cost


def effect_cost(background: Background) -> Cost:
    """Return the cost function in which replacing an action costs (1 + the Jaccard distance of the effects) / 2.

    Adding 1 distinguishes different actions that have the same effects. Symbols are actions with their effects.
    """

    def cost(one: Symbol, other: Symbol) -> Fraction:
        if one is None or other is None or one == other:
            return Fraction(int(one != other))
        union = len(one[1] | other[1])
        return (1 + (Fraction(len(one[1] ^ other[1]), union) if union else Fraction(0))) / 2

    return cost


def state_cost(one: Symbol, other: Symbol) -> Fraction:
    """Return the number of (fact, value) pairs that only one of two states has, or the cost of inserting a state.

    A fact that is true in one state and false in the other costs 2, and a fact that is unknown in one of them costs 1.
    Inserting or deleting a state with n known facts costs 1 + n.

    This is a metric, because a state can be regarded as the set of its pairs and one more element, and a missing state
    as the empty set.
    """
    if one is None or other is None:
        return Fraction(0 if one is other else 1 + len(other if one is None else one))
    return Fraction(len(one ^ other))


@dataclass(frozen=True)
class CostTable:
    """The costs of replacing symbols by each other, as integers in units of 1 / `denominator`.

    `costs` has shape (symbols + 1, symbols + 1); the last row and column hold the costs of inserting and deleting.
    """

    symbols: tuple[Symbol, ...]
    costs: NDArray[np.int64]
    denominator: int

    @classmethod
    def of(cls, symbols: Sequence[Symbol], cost: Cost) -> CostTable:
        """Return the costs between the given symbols.

        Raises:
            QueryError: the costs have no common denominator that fits into 64 bits.
        """
        everything = (*symbols, None)
        rows = [[cost(one, other) for other in everything] for one in everything]
        denominator = lcm(*{value.denominator for row in rows for value in row})
        scaled = [[int(value * denominator) for value in row] for row in rows]
        if max(map(max, scaled)) > LARGEST // 2**16:
            raise QueryError("the costs have no small common denominator; give costs with fewer different denominators")
        return cls(tuple(symbols), np.array(scaled, dtype=np.int64), denominator)

    @cached_property
    def uniform(self) -> bool:
        """Whether every edit costs 1."""
        return self.denominator == 1 and bool((self.costs == 1 - np.eye(len(self.costs), dtype=np.int64)).all())

    def violation(self) -> str:
        """Return the reason why the costs are not a metric, or "" if they are."""
        costs = self.costs
        spell = [str(symbol) for symbol in self.symbols] + ["nothing"]
        for text, wrong in (
            ("replacing {0} by itself costs {d}", np.argwhere(np.diag(costs) != 0).repeat(2, axis=1)),
            ("replacing {0} by {1} costs nothing", np.argwhere((costs == 0) & ~np.eye(len(costs), dtype=np.bool_))),
            ("replacing {0} by {1} costs {d}, but the reverse costs {e}", np.argwhere(costs != costs.T)),
        ):
            if len(wrong):
                i, j = wrong[0]
                d, e = (Fraction(int(value), self.denominator) for value in (costs[i, j], costs[j, i]))
                return text.format(spell[i], spell[j], d=d, e=e)
        for middle in range(len(costs)):
            wrong = np.argwhere(costs > costs[:, middle, None] + costs[middle])
            if len(wrong):
                i, j = wrong[0]
                return f"replacing {spell[i]} by {spell[j]} costs more than by way of {spell[middle]}"
        return ""
