"""How many tasks passed physics, and why the others did not."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from prag_asp.physics import Verdict


@dataclass
class Tally:
    """How many tasks were looked at, how many passed, and why the rest failed.

    `reasons` counts the tasks that did not pass by their status and reason, `causes` the failed attempts of all tasks.
    """

    seen: int = 0
    passed: int = 0
    reasons: Counter[tuple[str, str]] = field(default_factory=Counter)
    causes: Counter[str] = field(default_factory=Counter)

    def add(self, verdict: Verdict) -> None:
        """Count a verdict."""
        self.count(verdict.status, verdict.reason, verdict.causes)

    def count(self, status: str, reason: str, causes: Mapping[str, int] | None = None) -> None:
        """Count what became of a task, and why attempts at it failed."""
        self.seen += 1
        self.passed += status == "feasible"
        self.causes.update(causes or {})
        if status != "feasible":
            self.reasons[status, reason] += 1

    @property
    def proved(self) -> int:
        """How many tasks are proved infeasible."""
        return sum(number for (status, _), number in self.reasons.items() if status == "infeasible")
