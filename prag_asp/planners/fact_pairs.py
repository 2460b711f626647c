"""Mutex pairs: an upper bound on the pairs of fluent values in one reachable state (h^2 of Haslum and Geffner).

A pair is reached if the initial state has it, or if a reachable action makes one of its values and makes or preserves
the other. Conditions that exclude unreachable pairs are redundant.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping

import clingo

MOST = 400
"""Maximum number of fluents for which pairs are computed; their number is four times its square."""

Values = Mapping[clingo.Symbol, bool]


class FactPairs:
    """The pairs of values that may be reached from a state; each value is a bit of an integer."""

    def __init__(self, state: Values, actions: Iterable[tuple[Values, Values]]) -> None:
        self._number = {fluent: 2 * number for number, fluent in enumerate(state)}
        start = sum(1 << bit for bit in self._bits(state))
        self._with = [start if start >> bit & 1 else 0 for bit in range(2 * len(state))]
        self._reached = start
        masks = [
            (self._bits(before), self._bits(after), sum(3 << self._number[fluent] for fluent in after))
            for before, after in actions
        ]
        while sum(self._apply(*mask) for mask in masks):
            pass

    def excludes(self, before: Values, fluent: clingo.Symbol, value: bool) -> bool:
        """Return whether a value of a fluent is mutex with one of some others."""
        return not self._beside(self._bits(before)) >> self._bit(fluent, value) & 1

    def _apply(self, before: list[int], after: list[int], changed: int) -> bool:
        """Add the pairs that an action reaches, and return whether one is new."""
        beside = self._beside(before)
        if any(not beside >> bit & 1 for bit in before):
            return False
        added = sum(1 << bit for bit in after)
        there = (beside & ~changed) | added
        is_new = False
        for bit in after:
            new = there & ~self._with[bit]
            if new:
                is_new = True
                self._with[bit] |= new
                while new:
                    lowest = new & -new
                    self._with[lowest.bit_length() - 1] |= 1 << bit
                    new ^= lowest
        self._reached |= added
        return is_new

    def _beside(self, bits: Iterable[int]) -> int:
        """Return the values that may hold together with each of some values."""
        compatible = self._reached
        for bit in bits:
            compatible &= self._with[bit]
        return compatible

    def _bit(self, fluent: clingo.Symbol, value: bool) -> int:
        return self._number[fluent] + value

    def _bits(self, values: Values) -> list[int]:
        return [self._bit(fluent, value) for fluent, value in values.items()]
