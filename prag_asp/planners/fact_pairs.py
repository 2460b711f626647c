"""Mutex pairs: an upper bound on the pairs of fluent values in one reachable state (h^2 of Haslum and Geffner).

A pair is reached if the initial state has it, or if an action that may occur makes one of it and makes or leaves the
other. What is never reached is known, and need not be asked of a state.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping

import clingo

MOST = 400
"""Fluents up to which pairs are looked for; there are four times the square of them."""

Values = Mapping[clingo.Symbol, bool]


class FactPairs:
    """The pairs of values that may be reached from a state; each value is a bit of an integer."""

    def __init__(self, state: Values, actions: Iterable[tuple[Values, Values]]) -> None:
        self._number = {fluent: 2 * number for number, fluent in enumerate(state)}
        start = self._mask(state)
        self._with = [start if start >> bit & 1 else 0 for bit in range(2 * len(state))]
        self._reached = start
        masks = [(self._bits(before), self._bits(after), self._changed(after)) for before, after in actions]
        while sum(self._apply(*each) for each in masks):
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
        found = False
        for bit in after:
            new = there & ~self._with[bit]
            if new:
                found = True
                self._with[bit] |= new
                for other in _bits_of(new):
                    self._with[other] |= 1 << bit
        self._reached |= added
        return found

    def _beside(self, bits: Iterable[int]) -> int:
        """Return the values that may be so beside each of some."""
        found = self._reached
        for bit in bits:
            found &= self._with[bit]
        return found

    def _bit(self, fluent: clingo.Symbol, value: bool) -> int:
        return self._number[fluent] + value

    def _bits(self, values: Values) -> list[int]:
        return [self._bit(fluent, value) for fluent, value in values.items()]

    def _mask(self, values: Values) -> int:
        return sum(1 << bit for bit in self._bits(values))

    def _changed(self, after: Values) -> int:
        return sum(3 << self._number[fluent] for fluent in after)


def _bits_of(mask: int) -> Iterator[int]:
    while mask:
        low = mask & -mask
        yield low.bit_length() - 1
        mask ^= low
