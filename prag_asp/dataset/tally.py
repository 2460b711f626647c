"""How many tasks passed physics at which budget, and why the others did not, as a line and a table on stderr."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from typing import TYPE_CHECKING

from prag_asp.physics import CAUSES, Verdict
from prag_asp.wording import plural

if TYPE_CHECKING:
    from rich.table import Table

KINDS = {"not_found": "not found", "infeasible": "proved infeasible", "witness_fails": "witness fails"}
"""How the table calls what became of a task that did not pass."""


class Tally:
    """How many tasks were looked at, how many passed, and why the rest failed."""

    def __init__(self, what: tuple[str, str], limits: str):
        """Begin to count; `what` says in words what one of them is, and several."""
        self.seen, self.passed = 0, 0
        self._what, self._limits = what, limits
        self._reasons: Counter[tuple[str, str]] = Counter()
        self._causes: Counter[str] = Counter()

    def add(self, verdict: Verdict) -> None:
        """Count a verdict."""
        self.count(verdict.status, verdict.reason, verdict.causes)

    def count(self, status: str, reason: str, causes: Mapping[str, int] | None = None) -> None:
        """Count what became of a task, and why attempts at it failed."""
        self.seen += 1
        self.passed += status == "feasible"
        self._causes.update(causes or {})
        if status != "feasible":
            self._reasons[KINDS.get(status, status), reason] += 1

    @property
    def proved(self) -> int:
        """How many tasks are proved infeasible."""
        return sum(number for (kind, _), number in self._reasons.items() if kind == KINDS["infeasible"])

    def __str__(self) -> str:
        share = f" ({100 * self.passed / self.seen:.1f} %, {self._limits})" if self.seen else ""
        return f"{plural(self.seen, *self._what)}, {self.passed} passed{share}"

    def show(self) -> None:
        """Print the line and, where an attempt or a task failed, the table of causes on stderr."""
        from rich.console import Console

        console = Console(stderr=True, highlight=False)
        console.print(str(self), soft_wrap=True, markup=False)
        if self._reasons or self._causes:
            console.print(self._table())

    def _table(self) -> Table:
        """Return how many tasks failed for each reason, and how many attempts for each cause."""
        from rich.markup import escape
        from rich.table import Table

        table = Table()
        table.add_column("cause")
        table.add_column("tasks", justify="right")
        table.add_column("failed attempts", justify="right")
        tasks = {cause: self._reasons[KINDS["not_found"], cause] for cause in CAUSES}
        for cause in CAUSES:
            if self._causes[cause] or tasks[cause]:
                table.add_row(cause, str(tasks[cause]), str(self._causes[cause]))
        for (kind, reason), number in self._reasons.most_common():
            if kind != KINDS["not_found"] or reason not in tasks:
                table.add_row(escape(f"{kind}: {reason}"), str(number), "")
        return table
