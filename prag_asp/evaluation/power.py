"""Sample sizes, exact powers and smallest detectable effects for comparisons of two policies.

>>> from prag_asp.evaluation import ComparisonDesign
>>> design = ComparisonDesign(correlation=0.5)
>>> design.scenarios(effect=0.1, power=0.8)
211
>>> design.smallest_effect(500)
Fraction(161, 2500)
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from fractions import Fraction
from statistics import NormalDist

from prag_asp.errors import QueryError
from prag_asp.evaluation.exact_power import CLOSE, paired_power, unpaired_power
from prag_asp.exact_numbers import parse_number

Probability = int | float | str | Fraction
"""A probability; a float means its shortest decimal representation."""

MOST = 100_000
"""The maximum number of scenarios, which is more than any evaluation has; computing its power takes a second."""

AHEAD = 30
"""The number of next larger sample sizes that must also reach the power, because exact power is not monotone.

Critical values are integers, so power drops where one of them changes. The fluctuation is largest if all results
differ: for effects from 0.06 to 0.3, some numbers in a range of 7 to 39 numbers then reach a power of 0.8 and others do
not; the next 200 numbers all reach it.
"""

STEP = Fraction(1, 10_000)
"""The resolution of smallest effects, which is a hundredth of a percentage point."""

LEAST_ALPHA = Fraction(1, 10**6)
"""The smallest significance level, because tails of tests are sums of floats that omit probabilities of 1e-18."""


@dataclass(frozen=True)
class ComparisonDesign:
    """Two policies whose success rates are compared at a two-sided significance level `alpha`.

    `rate` is the probability of success of the first policy; that of the second policy is larger by the effect. If
    neither `correlation` nor `discordant` is given, each policy has its own sample of scenarios, and the test is
    Fisher's exact test, which, for samples of equal size, doubles the smaller tail. Otherwise both policies run in the
    same scenarios, and the test is McNemar's exact test (1947), as in `compare`; its unconditional power sums over the
    number of scenarios in which only one policy succeeds (Duffy, Statistics in Medicine 3, 1984; Connor, Biometrics 43,
    1987). `correlation` is the correlation between the two results in a scenario, and `discordant` is the share of
    scenarios in which the results differ.

    With `tasks`, the number N of all tasks, scenarios are sampled from them without replacement and the claim is about
    these tasks. The variance of a rate over n scenarios is then smaller by the factor (N - n) / (N - 1), like that of a
    hypergeometric variable, so they count as n (N - 1) / (N - n) (Cochran, Sampling Techniques, 1977, section 4.4).

    Raises:
        QueryError: a number is out of its range, or both `correlation` and `discordant` are given.
    """

    rate: Probability = Fraction(1, 2)
    alpha: Probability = Fraction(1, 20)
    correlation: Probability | None = None
    discordant: Probability | None = None
    tasks: int | None = None

    def __post_init__(self) -> None:
        _within("rate", self.rate, 0, 1)
        _within("alpha", self.alpha, LEAST_ALPHA, Fraction(1, 2))
        if self.correlation is not None and self.discordant is not None:
            raise QueryError("a correlation determines the share of discordant scenarios; leave one of them out")
        if self.correlation is not None:
            _within("correlation", self.correlation, -1, 1)
        if self.discordant is not None:
            _within("discordant", self.discordant, 0, 1)
        if self.tasks is not None and self.tasks < 1:
            raise QueryError(f"a space has at least 1 task; got {self.tasks}")

    @property
    def paired(self) -> bool:
        """Whether both policies run in the same scenarios."""
        return self.correlation is not None or self.discordant is not None

    @property
    def test(self) -> str:
        """The name of the test."""
        return "McNemar's exact test" if self.paired else "Fisher's exact test"

    def power(self, scenarios: int, effect: Probability) -> float:
        """Return the probability that the test finds an effect with a given number of scenarios for each policy.

        Rejections in both directions count. With `tasks`, the power is that for the effective number of scenarios,
        rounded down and at most `MOST`, and 1 if the scenarios cover all tasks.

        Raises:
            QueryError: the effect is impossible at this rate, or more scenarios are given than there are tasks, or more
                than `MOST`.
        """
        return self._power(self._effective(scenarios), _exact("effect", effect))

    def scenarios(self, effect: Probability, power: Probability = Fraction(4, 5)) -> int:
        """Return the number of scenarios for each policy with which the test finds an effect with a given power.

        Exact power is not monotone in the number of scenarios. Apart from the correction for `tasks`, the test has the
        given power with the returned number and with each of the next `AHEAD` numbers, but not with the number before
        it.

        Raises:
            QueryError: the effect is 0 or impossible at this rate, the power is 1 without `tasks`, or more than `MOST`
                scenarios are needed.
        """
        exact, wished = _exact("effect", effect), float(_within("power", power, 0, 1))
        if wished == 1.0 and self.tasks is not None:
            return self.tasks
        if wished == 1.0:
            raise QueryError("no number of scenarios gives a power of 1; give a lower power, such as 0.99")
        if exact == 0:
            raise QueryError("no number of scenarios shows an effect of 0; give a larger effect")
        number = self._least(lambda scenarios: self._power(scenarios, exact) >= wished, f"an effect of {effect}")
        if self.tasks is None:
            return number
        return math.ceil(Fraction(number * self.tasks, self.tasks + number - 1))

    def smallest_effect(self, scenarios: int, power: Probability = Fraction(4, 5)) -> Fraction | None:
        """Return the smallest effect, in steps of 0.0001, that the test finds with a given power.

        The result is None if the rate of the second policy cannot be that large.

        Raises:
            QueryError: more scenarios are given than there are tasks, or more than `MOST`.
        """
        wished, number = float(_within("power", power, 0, 1)), self._effective(scenarios)
        if number == math.inf:
            assert self.tasks is not None
            return Fraction(1, self.tasks)
        low, high = 0, math.floor(self._largest_effect() / STEP)
        if high == 0 or self._power(number, high * STEP) < wished:
            return None
        while high - low > 1:
            middle = (low + high) // 2
            low, high = (low, middle) if self._power(number, middle * STEP) >= wished else (middle, high)
        return high * STEP

    def half_width(self, scenarios: int) -> float:
        """Return the half-width of Wilson's interval (1927) around a success rate of `rate`, with confidence 1 - alpha.

        Raises:
            QueryError: more scenarios are given than there are tasks, or more than `MOST`.
        """
        number, p = self._effective(scenarios, whole=False), float(_exact("rate", self.rate))
        if number == math.inf:
            return 0.0
        z = NormalDist().inv_cdf(1 - float(_exact("alpha", self.alpha)) / 2)
        return z / (1 + z * z / number) * math.sqrt(p * (1 - p) / number + z * z / (4 * number * number))

    def _effective(self, scenarios: int, *, whole: bool = True) -> float:
        """Return the number of scenarios from an infinite space that has the variance of `scenarios` out of `tasks`."""
        if not 1 <= scenarios <= MOST:
            raise QueryError(f"{scenarios} scenarios: give a number from 1 to {MOST:,}")
        if self.tasks is None:
            return scenarios
        if scenarios > self.tasks:
            raise QueryError(f"{scenarios} scenarios are more than the {self.tasks} tasks; give at most {self.tasks}")
        if scenarios == self.tasks:
            return math.inf
        number = min(Fraction(scenarios * (self.tasks - 1), self.tasks - scenarios), Fraction(MOST))
        return math.floor(number) if whole else float(number)

    def _power(self, scenarios: float, effect: Fraction) -> float:
        """Return the power for an effective number of scenarios."""
        first, second = _exact("rate", self.rate), _exact("rate", self.rate) + effect
        if not 0 <= second <= 1:
            raise QueryError(f"an effect of {float(effect):g} leads from the rate {float(first):g} to "
                             f"{float(second):g}; give a smaller one")  # fmt: skip
        alone = self._discordant_shares(effect)
        if alone is not None and min(alone) < 0:
            given = f"discordant {self.discordant}" if self.correlation is None else f"correlation {self.correlation}"
            rates = f"rates of {float(first):g} and {float(second):g}"
            raise QueryError(f"{given} is impossible for {rates}; give another one, or a smaller effect")
        if scenarios == math.inf:
            return 1.0 if effect else 0.0
        alpha = _exact("alpha", self.alpha)
        if alone is None:
            return unpaired_power(int(scenarios), float(first), float(second), alpha)
        return paired_power(int(scenarios), *alone, alpha)

    def _discordant_shares(self, effect: Fraction) -> tuple[float, float] | None:
        """Return the shares of scenarios in which only the first policy succeeds, and in which only the second does.

        A share is negative if rates, effect and correlation contradict each other; the result is None if samples are
        not paired.
        """
        first = _exact("rate", self.rate)
        second = first + effect
        if self.discordant is not None:
            share = _exact("discordant", self.discordant)
            both = (first + second - share) / 2
            possible = both >= 0 and both + share <= 1
            return (float((share - effect) / 2), float((share + effect) / 2)) if possible else (-1.0, -1.0)
        if self.correlation is None:
            return None
        correlation = float(_exact("correlation", self.correlation))
        spread = math.sqrt(first * (1 - first) * second * (1 - second))
        both_succeed = float(first * second) + correlation * spread
        shares = [float(first) - both_succeed, float(second) - both_succeed]
        undefined = spread == 0 != correlation  # a constant result is not correlated with anything
        if undefined or min(both_succeed, 1 - both_succeed - sum(shares), *shares) < -CLOSE:
            return -1.0, -1.0
        return max(shares[0], 0.0), max(shares[1], 0.0)

    def _largest_effect(self) -> Fraction:
        """Return the largest effect, in steps, that the rate and the correlation allow, or 0 if they allow none."""
        low, high = 0, math.floor((1 - _exact("rate", self.rate)) / STEP)

        def possible(steps: int) -> bool:
            alone = self._discordant_shares(steps * STEP)
            return alone is None or min(alone) >= 0

        if possible(high):
            return high * STEP
        while high - low > 1:
            middle = (low + high) // 2
            low, high = (middle, high) if possible(middle) else (low, middle)
        return low * STEP

    @staticmethod
    def _least(reaches: Callable[[int], bool], what: str) -> int:
        """Return a number of scenarios that suffices, as do the next `AHEAD` numbers, unlike the number before it."""
        low, high = 0, 16
        while not reaches(high):
            if high == MOST:
                raise QueryError(f"{what} needs more than {MOST:,} scenarios; give a larger one, or a lower power")
            low, high = high, min(2 * high, MOST)
        while high - low > 1:
            middle = (low + high) // 2
            low, high = (low, middle) if reaches(middle) else (middle, high)
        checked = high
        while checked < high + AHEAD:
            checked += 1
            if not reaches(checked):
                high = checked + 1
        return high


def _exact(name: str, value: Probability) -> Fraction:
    """Return a number as a fraction; a float means its shortest decimal representation.

    Raises:
        QueryError: the value is not a number.
    """
    return parse_number(name, str(value))


def _within(name: str, value: Probability, low: int | Fraction, high: int | Fraction) -> Fraction:
    """Return a number as a fraction.

    Raises:
        QueryError: the number is not between the bounds.
    """
    exact = _exact(name, value)
    if not low <= exact <= high:
        raise QueryError(f"{name} {value} is not between {float(low):g} and {float(high):g}")
    return exact
