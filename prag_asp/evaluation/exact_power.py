"""The exact power of two tests: Fisher's for two samples, and McNemar's for pairs.

Powers are sums over all results that the tests reject. Terms whose total probability is below 1e-15 are omitted; the
others are computed as floats. Whether a result is rejected is decided exactly.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from fractions import Fraction
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Floats = NDArray[np.float64]
    Integers = NDArray[np.int64]

DEVIATIONS = math.log(1e18) / 2
"""A sum of n bits, independent or sampled without replacement, exceeds its mean by sqrt(DEVIATIONS * n) with a
probability of at most 1e-18 (Hoeffding, 1963).
"""

CLOSE = 1e-8
"""The relative difference from the significance level below which integers decide; the error of floats is smaller.

A sum of nine logarithms of factorials up to 200,000!, which is about exp(2e6), is off by at most 4e-9.
"""


def unpaired_power(scenarios: int, first: float, second: float, alpha: Fraction) -> float:
    """Return the power of Fisher's exact test for two samples of equal size, given the probabilities of success."""
    spread = math.sqrt(DEVIATIONS * 2 * scenarios)
    mean = scenarios * (first + second)
    totals = np.arange(max(0, math.floor(mean - spread)), min(2 * scenarios, math.ceil(mean + spread)) + 1)
    critical = fisher_critical_values(scenarios, totals, alpha)
    numbers = np.arange(scenarios + 1)
    place = np.searchsorted(critical, numbers)  # the smallest total at which this number is rejected
    least = np.clip(np.append(totals, totals[-1] + 1)[place] - numbers, 0, scenarios + 1)
    power = 0.0
    for fewer, more in ((first, second), (second, first)):
        at_least = np.append(np.cumsum(_binomial(scenarios, numbers, more)[::-1])[::-1], 0.0)
        power += float(_binomial(scenarios, numbers, fewer) @ at_least[least])
    return min(power, 1.0)


def paired_power(scenarios: int, first: float, second: float, alpha: Fraction) -> float:
    """Return the power of McNemar's exact test, given, for each policy, the probability that only it succeeds."""
    share = first + second
    if share == 0:
        return 0.0
    spread = math.sqrt(DEVIATIONS * scenarios)
    differing = np.arange(
        max(1, math.floor(scenarios * share - spread)), min(scenarios, math.ceil(scenarios * share + spread)) + 1
    )
    critical = sign_test_critical_values(differing, alpha)
    weights = _binomial(scenarios, differing, share)
    power = sum(weights @ _binomial_at_most(critical, differing, each / share) for each in (first, second))
    return min(float(power), 1.0)


def fisher_critical_values(scenarios: int, totals: Integers, alpha: Fraction) -> Integers:
    """Return, for each total number of successes, the largest number in one sample that Fisher's test rejects.

    Both samples have `scenarios` members. A number is rejected as too small if twice the tail is at most alpha. If no
    number is rejected, the result is one less than the smallest possible number.
    """
    depth = math.ceil(math.sqrt(DEVIATIONS * scenarios)) + 2
    numbers = totals[:, None] // 2 - np.arange(depth)[::-1]
    logs = _log_binomials(scenarios, numbers) + _log_binomials(scenarios, totals[:, None] - numbers)
    tails = np.cumsum(np.exp(logs - _log_binomials(2 * scenarios, totals)[:, None]), axis=1)

    def exact(total: int, number: int) -> bool:
        term = math.comb(scenarios, number) * math.comb(scenarios, total - number)
        bound = alpha.numerator * math.comb(2 * scenarios, total) // (2 * alpha.denominator)

        def before(term: int, k: int) -> int:
            return term * k * (scenarios - total + k) // ((scenarios - k + 1) * (total - k + 1))

        return _tail_within(bound, term, number, before)

    return _largest_rejected(totals, numbers, tails, alpha, exact)


def sign_test_critical_values(differing: Integers, alpha: Fraction) -> Integers:
    """Return the largest numbers of pairs won by one policy that McNemar's test rejects as too small, or -1.

    A policy wins a pair if only it succeeds. There is one result for each number of differing pairs. Twice the tail of
    the binomial distribution with probability 1/2 must be at most alpha.
    """
    depth = math.ceil(math.sqrt(DEVIATIONS * int(differing[-1]))) + 2
    numbers = differing[:, None] // 2 - np.arange(depth)[::-1]
    tails = np.cumsum(_binomial(differing[:, None], numbers, 0.5), axis=1)

    def exact(pairs: int, number: int) -> bool:
        bound = (alpha.numerator << pairs) // (2 * alpha.denominator)
        return _tail_within(bound, math.comb(pairs, number), number, lambda term, k: term * k // (pairs - k + 1))

    return _largest_rejected(differing, numbers, tails, alpha, exact)


def _tail_within(bound: int, term: int, number: int, before: Callable[[int, int], int]) -> bool:
    """Return exactly whether a term and all earlier terms, which decrease towards number 0, sum to at most a bound."""
    tail = 0
    for k in range(number, -1, -1):
        tail += term
        if tail > bound:
            return False
        if tail + term * k <= bound:
            return True
        term = before(term, k)
    return True


def _largest_rejected(
    rows: Integers, numbers: Integers, tails: Floats, alpha: Fraction, exact: Callable[[int, int], bool]
) -> Integers:
    """Return the last number in each row for which twice the tail is at most alpha; `exact` decides near-ties."""
    ratio = 2 * tails / float(alpha)
    rejected = ratio <= 1
    for row, column in np.argwhere(np.abs(ratio - 1) < CLOSE):
        rejected[row, column] = exact(int(rows[row]), int(numbers[row, column]))
    found: Integers = numbers[np.arange(len(rows)), np.count_nonzero(rejected, axis=1) - 1]
    return np.maximum(found, -1)


def _binomial_at_most(bounds: Integers, sizes: Integers, probability: float) -> Floats:
    """Return the probability that each binomial variable is at most its bound."""
    spread = np.sqrt(DEVIATIONS * sizes)
    lowest = np.maximum(np.floor(sizes * probability - spread).astype(np.int64), 0)
    numbers = lowest[:, None] + np.arange(2 * math.ceil(spread[-1]) + 2)
    terms = np.where(numbers <= bounds[:, None], _binomial(sizes[:, None], numbers, probability), 0.0)
    return np.asarray(terms.sum(axis=1), dtype=np.float64)


def _binomial(sizes: int | Integers, numbers: Integers, probability: float) -> Floats:
    """Return binomial probabilities, or 0 for impossible numbers."""
    if probability in (0.0, 1.0):
        return np.asarray(numbers == sizes * int(probability), dtype=np.float64)
    ways = _log_binomials(sizes, numbers)
    logs = ways + numbers * math.log(probability) + (sizes - numbers) * math.log1p(-probability)
    return np.asarray(np.exp(logs), dtype=np.float64)


def _log_binomials(sizes: int | Integers, numbers: Integers) -> Floats:
    """Return the logarithms of binomial coefficients, or minus infinity for impossible numbers."""
    possible = (numbers >= 0) & (numbers <= sizes)
    chosen = np.where(possible, numbers, 0)
    logs = _log_factorials(int(np.max(sizes)))
    return np.where(possible, logs[sizes] - logs[chosen] - logs[sizes - chosen], -np.inf)


_FACTORIALS: list[Floats] = [np.zeros(1)]
"""The logarithms of the factorials computed so far."""


def _log_factorials(largest: int) -> Floats:
    """Return the logarithms of the factorials from 0 to at least `largest`; they are cached."""
    if len(_FACTORIALS[0]) <= largest:
        sizes = range(2 * largest + 1)
        _FACTORIALS[0] = np.array([math.lgamma(size + 1) for size in sizes])
    return _FACTORIALS[0]
