"""Success rates with confidence intervals, and tallies of physics: feasible tasks, and reasons for failure."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass, field
from fractions import Fraction
from statistics import NormalDist
from typing import TYPE_CHECKING, NamedTuple

from prag_asp.errors import QueryError

if TYPE_CHECKING:
    from prag_asp.physics import Verdict


class Rate(NamedTuple):
    """A success rate: the number of successes in a number of trials."""

    successes: int
    trials: int

    @property
    def share(self) -> Fraction:
        """The exact share of successes, or 0 if there are no trials.

        For tasks of one length, the share of whole tasks is the product of the shares of the stages.
        """
        return Fraction(self.successes, self.trials) if self.trials else Fraction(0)

    def interval(self, confidence: float = 0.95) -> tuple[float, float]:
        """Return Wilson's score interval for the probability of success (Wilson, 1927).

        Raises:
            QueryError: the confidence is not between 0 and 1.
        """
        if not 0.0 < confidence < 1.0:
            raise QueryError(f"a confidence is above 0 and below 1, such as 0.95; got {confidence!r}")
        if self.trials == 0:
            return 0.0, 1.0
        z, n, p = NormalDist().inv_cdf(0.5 + confidence / 2), self.trials, self.successes / self.trials
        middle, spread = p + z * z / (2 * n), z * math.sqrt(p * (1 - p) / n + z * z / (4 * n * n))
        low, high = (middle - spread) / (1 + z * z / n), (middle + spread) / (1 + z * z / n)
        # if all or none succeed, the bound is exactly 1 or 0, which floats would miss
        return (0.0 if self.successes == 0 else low), (1.0 if self.successes == n else high)

    def __str__(self) -> str:
        """Return the share in percent, with its 95 % interval and the counts."""
        low, high = self.interval()
        return (
            f"{100 * float(self.share):.0f} % ({100 * low:.0f} to {100 * high:.0f}; {self.successes} of {self.trials})"
        )


@dataclass
class Tally:
    """The numbers of validated tasks, of feasible tasks, and of failures by reason and by cause.

    `reasons` counts the failed tasks by status and reason, and `causes` counts the failed attempts at all tasks.
    `nearest` describes how far the best attempts got at the first task with the status not_found.
    """

    seen: int = 0
    passed: int = 0
    reasons: Counter[tuple[str, str]] = field(default_factory=Counter)
    causes: Counter[str] = field(default_factory=Counter)
    nearest: str = ""

    def add(self, verdict: Verdict) -> None:
        """Count a verdict."""
        self.nearest = self.nearest or verdict.nearest
        self.count(verdict.status, verdict.reason, verdict.causes)

    def count(self, status: str, reason: str, causes: Mapping[str, int] | None = None) -> None:
        """Count the outcome of a task, and the causes of failed attempts."""
        self.seen += 1
        self.passed += status == "feasible"
        self.causes.update(causes or {})
        if status != "feasible":
            self.reasons[status, reason] += 1

    @property
    def proved(self) -> int:
        """The number of tasks proved infeasible."""
        return sum(number for (status, _), number in self.reasons.items() if status == "infeasible")
