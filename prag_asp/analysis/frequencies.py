"""Compare frequencies in a dataset with the exact expected frequencies in its space, by a chi-square test.

Occurrences within a task depend on each other, so Pearson's statistic would not have a chi-square distribution. The
test uses the exact covariance matrix C of the occurrences in a random task instead: for the differences d from the
expected numbers in n tasks, d' C^+ d / n asymptotically has a chi-square distribution, whose number of degrees of
freedom is the rank of C (Moore 1977).
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from math import exp, inf, lgamma, log

import numpy as np

from prag_asp.analysis.layered_automaton import Objects
from prag_asp.analysis.moments import Feature, Moments, space_moments, task_moments
from prag_asp.space.task_space import TaskSpace
from prag_asp.task import Task

FEW = 5
"""Below this expected number, the distribution of the statistic is not close to a chi-square distribution."""

PRIME = 2**31 - 1
"""The rank of an integer matrix equals its rank modulo this prime, unless the prime divides certain determinants."""


@dataclass(frozen=True)
class Frequency:
    """The number of occurrences of a value in a dataset, and the expected number."""

    value: str
    observed: int
    expected: Fraction


@dataclass(frozen=True)
class FrequencyTest:
    """The frequencies of a feature's values in given tasks, and a test of whether the tasks are a uniform sample.

    `statistic` has a chi-square distribution with `degrees` degrees of freedom if the tasks are independent uniform
    samples from the space; it is infinite if some frequencies are impossible in the space. `p_value` is the probability
    of a statistic at least this large. `few` is the number of values that are expected fewer than five times; if it is
    large, the p-value is only approximate.
    """

    feature: Feature
    tasks: int
    frequencies: tuple[Frequency, ...]
    statistic: float
    degrees: int
    p_value: float

    @property
    def few(self) -> int:
        """The number of values that are expected fewer than five times."""
        return sum(each.expected < FEW for each in self.frequencies)


def compare_frequencies(
    space: TaskSpace, tasks: Iterable[Task | Sequence[str]], feature: Feature = "names"
) -> FrequencyTest:
    """Compare a feature's frequencies in tasks with the exact expected frequencies in uniform samples from a space.

    `feature` is ``actions``, ``names``, ``classes`` (the name of an action with the classes of its arguments) or
    ``pairs`` (of consecutive names).

    Raises:
        QueryError: there is no task, a task has a different length, or the space is empty or has several lengths.
        LimitReached: a limit ended the exploration.
    """
    return frequency_test(task_moments(space, tasks, feature), space_moments(space, feature))


def frequency_test(found: Moments, whole: Moments) -> FrequencyTest:
    """Compare the frequencies in given tasks with those in a space, given the second moments of one feature in both."""
    values = tuple(sorted({*found.values, *whole.values}))
    observed, total = _occurrences(found, values), _occurrences(whole, values)
    frequencies = tuple(
        Frequency(value, int(seen), Fraction(found.words * int(all_seen), whole.words))
        for value, seen, all_seen in zip(values, observed, total, strict=True)
    )
    covariance = whole.words * whole.products - np.outer(whole.occurrences, whole.occurrences)
    degrees = rank(covariance)
    outside = any(each.observed and not each.expected for each in frequencies)
    inside = np.array([each.expected > 0 for each in frequencies])
    differences = np.array([float(each.observed - each.expected) for each in frequencies])[inside]
    statistic = inf if outside else _quadratic(differences, (covariance / whole.words**2), degrees) / found.words
    return FrequencyTest(
        found.feature, found.words, frequencies, statistic, degrees, upper_tail(degrees, statistic)
    )  # fmt: skip


def _occurrences(moments: Moments, values: Sequence[str]) -> list[int]:
    number = dict(zip(moments.values, moments.occurrences.tolist(), strict=True))
    return [number.get(value, 0) for value in values]


def _quadratic(differences: Objects, covariance: Objects, degrees: int) -> float:
    """Return d' C^+ d, computed from the `degrees` largest eigenvalues, or infinity if d is not in the range of C."""
    weights, vectors = np.linalg.eigh(covariance.astype(np.float64))
    along = vectors.T @ differences
    used = len(weights) - degrees
    if not np.allclose(along[:used], 0, atol=1e-6 * max(1.0, float(np.abs(differences).max(initial=0)))):
        return inf
    return float((along[used:] ** 2 / weights[used:]).sum())


def rank(matrix: Objects) -> int:
    """Return the rank of a matrix of integers of any size, by elimination modulo a prime."""
    left = (matrix % PRIME).astype(np.int64)
    found = 0
    for column in range(left.shape[1]):
        pivots = np.flatnonzero(left[found:, column])
        if not len(pivots):
            continue
        pivot = found + int(pivots[0])
        left[[found, pivot]] = left[[pivot, found]]
        row = left[found] * pow(int(left[found, column]), -1, PRIME) % PRIME
        left[found + 1 :] = (left[found + 1 :] - left[found + 1 :, column, None] * row) % PRIME
        found += 1
    return found


def upper_tail(degrees: int, statistic: float) -> float:
    """Return the probability that a chi-square variable with the given degrees of freedom is at least `statistic`.

    This is the regularised upper incomplete gamma function Q(degrees / 2, statistic / 2), computed from its series or
    its continued fraction (Abramowitz and Stegun 1964, 6.5.29 and 6.5.31) to about 14 digits.
    """
    a, x = degrees / 2, statistic / 2
    if x <= 0 or not degrees:
        return 0.0 if x > 0 else 1.0
    if x == inf:
        return 0.0
    scale = exp(a * log(x) - x - lgamma(a))
    if x < a + 1:
        term = total = 1 / a
        while term > total * 1e-17:
            a += 1
            term *= x / a
            total += term
        return max(1 - scale * total, 0.0)
    divisor = x + 1 - a  # Lentz's method
    above, below = inf, 1 / divisor
    fraction, factor, number = below, 0.0, 0
    while abs(factor - 1) > 1e-16:
        number += 1
        term = -number * (number - a)
        divisor += 2
        below = 1 / (divisor + term * below)
        above = divisor + term / above
        factor = below * above
        fraction *= factor
    return scale * fraction
