"""Pass rates of physics: counts of feasible tasks, and of the reasons why others failed."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from prag_asp.physics import Verdict


@dataclass
class Tally:
    """The numbers of validated tasks, of feasible tasks, and of failures by reason.

    `reasons` counts the failed tasks by status and reason, `causes` the failed attempts of all tasks. `nearest`
    describes how far the best attempts got at the first task with the status not_found.
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
