"""Success rates over a whole space, and differences between them, estimated from stratified samples."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from statistics import NormalDist
from typing import NamedTuple

import msgspec

from prag_asp.dataset.strata.stratum_figures import StratumFigures, stratum_weights
from prag_asp.evaluation.episode import EvaluatedEpisode
from prag_asp.integers import number_of

Outcomes = Mapping[str, Sequence[Fraction]]
"""For each stratum, the values of its evaluated tasks; the value of a task is the share of successful episodes."""


class StratifiedRate(NamedTuple):
    """An estimate for a whole space: the share of successes, a 95 % interval, the standard error, and the counts."""

    share: Fraction
    low: float
    high: float
    error: float
    tasks: int
    strata: int

    def __str__(self) -> str:
        """Return the share in percent, with its interval and the counts."""
        interval = f"{100 * self.low:.0f} to {100 * self.high:.0f}"
        return f"{100 * float(self.share):.0f} % ({interval}; {self.tasks} tasks in {self.strata} strata)"


class StratifiedDifference(NamedTuple):
    """The estimated rates of two policies over a whole space, and their difference with its 95 % interval."""

    first: Fraction
    second: Fraction
    low: float
    high: float
    tasks: int

    @property
    def difference(self) -> Fraction:
        """The first rate minus the second."""
        return self.first - self.second


@dataclass(frozen=True)
class EvaluatedStratum:
    """A stratum: its weight, the estimated number of tasks that count, and the values of the sampled tasks.

    `population` is never smaller than the number of sampled tasks, and is equal to it if all tasks were drawn.
    `share_variance` is the variance of the estimated share of tasks that count, divided by the squared share.
    """

    weight: Fraction
    population: Fraction
    values: Sequence[Fraction]
    share_variance: float = 0.0

    @property
    def mean(self) -> Fraction:
        """The mean of the values."""
        return sum(self.values, start=Fraction(0)) / len(self.values)

    @property
    def left(self) -> Fraction:
        """The finite-population correction: the share of tasks that are not in the sample."""
        return 1 - len(self.values) / self.population

    @property
    def size(self) -> float:
        """The number of independent tasks that give the same variance; infinite if all tasks are in the sample."""
        n = len(self.values)
        return float(n * (self.population - 1) / (self.population - n)) if self.left else math.inf

    def covariance(self, values: Sequence[Fraction], others: Sequence[Fraction]) -> float:
        """Return the covariance of two sample means over the tasks (Cochran 1977, theorem 5.3, for variances)."""
        n = len(values)
        if n < 2 or not self.left:
            return 0.0
        one, two = sum(values, start=Fraction(0)) / n, sum(others, start=Fraction(0)) / n
        products = sum(((x - one) * (y - two) for x, y in zip(values, others, strict=True)), start=Fraction(0))
        return float(self.left * products / (n - 1) / n)

    @property
    def shifted(self) -> float:
        """The mean after adding one success and one failure, so that the variance is not 0."""
        n = len(self.values)
        return float((self.mean * n + 1) / (n + 2))


def weighted(episodes: Sequence[EvaluatedEpisode], strata: Sequence[StratumFigures]) -> tuple[EvaluatedEpisode, ...]:
    """Return the episodes with weights that sum to 1; without strata, return the episodes unchanged.

    The weight of a stratum is divided equally among its evaluated tasks, and the weight of a task equally among its
    initial states.
    """
    if not strata:
        return tuple(episodes)
    weights = stratum_weights(strata)
    starts = Counter((episode.part, tuple(episode.task)) for episode in episodes)
    tasks = Counter(part for part, _ in starts)
    shares = [
        weights[episode.part] / tasks[episode.part] / starts[episode.part, tuple(episode.task)] for episode in episodes
    ]
    return tuple(
        msgspec.structs.replace(episode, weight=str(share), weight_value=float(share))
        for episode, share in zip(episodes, shares, strict=True)
    )


def stratified_rate(
    episodes: Iterable[EvaluatedEpisode], strata: Sequence[StratumFigures], confidence: float = 0.95
) -> StratifiedRate:
    """Return the success rate over all tasks that count, with an interval.

    The rate is the weighted mean of the rates of the strata, and its variance is the sum of their variances with
    squared weights, each corrected for the finite population (Cochran, Sampling Techniques, 1977, chapter 5). The
    interval is Wilson's, with the effective number of tasks (Korn and Graubard 1998). If physics rejects tasks, the
    weights are estimates; the interval includes their variance, as for a ratio (Cochran, section 6.11).

    Raises:
        QueryError: no task of any stratum counts.
    """
    found = _evaluated_strata(_outcomes((each, each.success) for each in episodes), strata)
    share = sum((each.weight * each.mean for each in found), start=Fraction(0))
    z = NormalDist().inv_cdf(0.5 + confidence / 2)
    low, high = _interval(found, z)
    of_weights = _weight_variance(found, [each.mean for each in found])
    below, above = (math.sqrt((float(share) - limit) ** 2 + z * z * of_weights) for limit in (low, high))
    variance = sum(float(each.weight) ** 2 * each.covariance(each.values, each.values) for each in found)
    return StratifiedRate(
        share, max(0.0, float(share) - below), min(1.0, float(share) + above), math.sqrt(variance + of_weights),
        sum(len(each.values) for each in found), len(found),
    )  # fmt: skip


def stratified_difference(
    pairs: Sequence[tuple[EvaluatedEpisode, EvaluatedEpisode]],
    strata: Sequence[StratumFigures],
    confidence: float = 0.95,
) -> StratifiedDifference:
    """Return the difference between two success rates over all tasks that count, from pairs of episodes.

    The interval combines those of `stratified_rate` with the correlation of the two estimates (Zou and Donner 2008).

    Raises:
        QueryError: no task of any stratum counts.
    """
    z = NormalDist().inv_cdf(0.5 + confidence / 2)
    ones, twos = (_outcomes((pair[0], pair[which].success) for pair in pairs) for which in (0, 1))
    first, second = _evaluated_strata(ones, strata), _evaluated_strata(twos, strata)
    one_rate, two_rate = (
        sum((each.weight * each.mean for each in found), start=Fraction(0)) for found in (first, second)
    )
    both = list(zip(first, second, strict=True))
    one, two, joint = (
        sum(float(x.weight) ** 2 * x.covariance(x.values, y.values) for x, y in rows)
        for rows in ([(x, x) for x in first], [(y, y) for y in second], both)
    )
    correlation = max(-1.0, min(joint / math.sqrt(one * two), 1.0)) if one * two > 0 else 0.0
    of_weights = z * z * _weight_variance(first, [x.mean - y.mean for x, y in both])
    (low1, high1), (low2, high2) = _interval(first, z), _interval(second, z)
    p1, p2 = float(one_rate), float(two_rate)

    def half_width(mine: float, its: float) -> float:
        return math.sqrt(max(mine * mine - 2 * correlation * mine * its + its * its, 0.0) + of_weights)

    difference = float(one_rate - two_rate)
    below, above = half_width(p1 - low1, high2 - p2), half_width(high1 - p1, p2 - low2)
    tasks = sum(len(each.values) for each in first)
    return StratifiedDifference(one_rate, two_rate, max(-1.0, difference - below), min(1.0, difference + above), tasks)


def _outcomes(episodes: Iterable[tuple[EvaluatedEpisode, bool]]) -> Outcomes:
    """Return the values of the tasks of each stratum, in order of their first episodes."""
    by_task: dict[tuple[str, tuple[str, ...]], list[bool]] = {}
    for episode, success in episodes:
        by_task.setdefault((episode.part, tuple(episode.task)), []).append(success)
    outcomes: dict[str, list[Fraction]] = {}
    for (part, _), results in by_task.items():
        outcomes.setdefault(part, []).append(Fraction(sum(results), len(results)))
    return outcomes


def _evaluated_strata(outcomes: Outcomes, strata: Sequence[StratumFigures]) -> list[EvaluatedStratum]:
    """Return the strata with tasks that count, each with its weight and the values of its evaluated tasks."""
    weights = stratum_weights(strata)
    return [
        EvaluatedStratum(
            weights[each.name],
            Fraction(each.tasks * number_of(each.size), each.draws),
            outcomes[each.name],
            float(each.variance / each.share**2),
        )
        for each in strata
        if weights[each.name]
    ]


def _interval(strata: Sequence[EvaluatedStratum], z: float) -> tuple[float, float]:
    """Return Wilson's interval for the weighted mean, with the effective number of independent tasks.

    This number is the ratio of the variance of a single task to that of the weighted mean, both computed with shifted
    means, so that strata with few tasks that all succeed do not make the estimate certain. For a single stratum, it is
    the number of tasks, corrected for the finite population.
    """
    rows = [(float(each.weight), each.shifted, each.size) for each in strata]
    middle = sum(weight * mean for weight, mean, _ in rows)
    variance = sum(weight * weight * mean * (1 - mean) / size for weight, mean, size in rows)
    p = float(sum((each.weight * each.mean for each in strata), start=Fraction(0)))
    if not variance:
        return p, p
    n = middle * (1 - middle) / variance
    centre, spread = p + z * z / (2 * n), z * math.sqrt(max(p * (1 - p), 0.0) / n + z * z / (4 * n * n))
    low, high = (centre - spread) / (1 + z * z / n), (centre + spread) / (1 + z * z / n)
    return (0.0 if p == 0 else low), (1.0 if p == 1 else high)


def _weight_variance(strata: Sequence[EvaluatedStratum], means: Sequence[Fraction]) -> float:
    """Return the variance of a weighted mean that is due to the weights, to first order."""
    whole = sum((each.weight * mean for each, mean in zip(strata, means, strict=True)), start=Fraction(0))
    return sum(
        float(each.weight * (mean - whole)) ** 2 * each.share_variance for each, mean in zip(strata, means, strict=True)
    )
