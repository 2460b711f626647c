"""Statistics of paired successes: an exact test, and an interval for the difference between two proportions."""

from __future__ import annotations

import math
from fractions import Fraction
from typing import NamedTuple

from prag_asp.dataset.pass_rates import Rate


class Pairs(NamedTuple):
    """The numbers of pairs in which both policies, only the first, only the second, or neither succeeds."""

    both: int
    first: int
    second: int
    neither: int

    @property
    def total(self) -> int:
        """The number of pairs."""
        return sum(self)

    @property
    def rates(self) -> tuple[Rate, Rate]:
        """The success rates of the first and the second policy."""
        return Rate(self.both + self.first, self.total), Rate(self.both + self.second, self.total)

    @property
    def difference(self) -> Fraction:
        """The exact difference between the shares, first minus second, or 0 without pairs."""
        return Fraction(self.first - self.second, self.total) if self.total else Fraction(0)

    def p_value(self) -> Fraction:
        """Return the exact two-sided p-value of McNemar's test (1947), from the binomial distribution.

        If both policies are equally likely to succeed, each of the n discordant pairs is equally likely to favour
        either policy. The p-value is the probability of a split at least as uneven as the one observed, in either
        direction.
        """
        differ, fewer = self.first + self.second, min(self.first, self.second)
        tail = sum(math.comb(differ, k) for k in range(fewer + 1))
        return min(Fraction(1), Fraction(2 * tail, 2**differ))

    def interval(self, confidence: float = 0.95) -> tuple[float, float]:
        """Return an interval for the difference between the probabilities of success, first minus second.

        It is method 10 in Newcombe, "Improved confidence intervals for the difference between binomial proportions
        based on paired data", Statistics in Medicine 17 (1998): Wilson's intervals for the two shares are combined
        using the correlation of the pairs, which is corrected for continuity.

        Raises:
            QueryError: the confidence is not between 0 and 1.
        """
        if not self.total:
            return -1.0, 1.0
        one, two = self.rates
        (low1, high1), (low2, high2) = one.interval(confidence), two.interval(confidence)
        p1, p2, phi = float(one.share), float(two.share), self._correlation()
        below, above = _combined(p1 - low1, high2 - p2, phi), _combined(high1 - p1, p2 - low2, phi)
        difference = float(self.difference)
        return max(-1.0, difference - below), min(1.0, difference + above)

    def _correlation(self) -> float:
        """Return the correlation between the outcomes of a pair, with the continuity correction of method 10."""
        a, b, c, d = self
        product = (a + b) * (c + d) * (a + c) * (b + d)
        if product == 0:
            return 0.0
        excess: float = a * d - b * c
        if excess > 0:
            excess = max(excess - self.total / 2, 0.0)
        return excess / math.sqrt(product)


def _combined(one: float, two: float, phi: float) -> float:
    """Return the half-width of the interval for the difference between two shares, given their half-widths."""
    return math.sqrt(max(one * one - 2 * phi * one * two + two * two, 0.0))
