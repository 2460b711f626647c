"""Speed of validation, pass rate at a budget, and causes of failure, by length.

    python benchmarks/physics.py tabletop --lengths 3 4 5 6 --count 400

Tasks are sampled beforehand; only their validation is timed, by processor time on one core.
"""

from __future__ import annotations

import argparse
import time
from collections import Counter
from dataclasses import dataclass, field

from rich.console import Console
from rich.table import Table

from prag_asp import Task, TaskSpace, load_domain, load_scene
from prag_asp.physics import CAUSES, TIERS, Budget, Tier, Validator, open_validator

WARM_UP = 20
"""The number of tasks that are validated before measuring."""


@dataclass
class Outcome:
    """The results of the tasks of one length."""

    tasks: int = 0
    seconds: float = 0.0
    restarts: int = 0
    statuses: Counter[str] = field(default_factory=Counter)
    causes: Counter[str] = field(default_factory=Counter)
    reasons: Counter[str] = field(default_factory=Counter)

    @property
    def speed(self) -> float:
        """Tasks per second and core."""
        return self.tasks / self.seconds if self.seconds else 0.0

    def add(self, other: Outcome) -> None:
        """Add the tasks of another outcome."""
        self.tasks, self.seconds = self.tasks + other.tasks, self.seconds + other.seconds
        self.restarts += other.restarts
        for ours, theirs in zip(self._counters(), other._counters(), strict=True):
            ours.update(theirs)

    def _counters(self) -> tuple[Counter[str], ...]:
        return self.statuses, self.causes, self.reasons


def main() -> None:
    """Sample tasks, validate them, and print two tables."""
    options = _options()
    budget = Budget(options.restarts, options.samples, Tier(options.tier))
    domain = load_domain(options.domain)
    scene = load_scene(domain)
    tasks_by_length = {
        n: list(TaskSpace(domain, n).sample(options.count, seed=options.seed, weights={})) for n in options.lengths
    }
    with open_validator(scene) as validator:
        for index, task in enumerate(next(iter(tasks_by_length.values()))[:WARM_UP]):
            validator.validate(task, seed=options.seed + 1, index=index)
        by_length = {n: _measure(validator, tasks, options.seed, budget) for n, tasks in tasks_by_length.items()}
    total = Outcome()
    for outcome in by_length.values():
        total.add(outcome)
    columns = {**{str(n): outcome for n, outcome in by_length.items()}, "all": total}
    console = Console()
    console.print(
        _speeds(columns, f"{options.domain}: budget {budget} (restarts x samples, tier), seed {options.seed}")
    )
    console.print(_causes(columns))


def _options() -> argparse.Namespace:
    """Read the command line."""
    parser = argparse.ArgumentParser(description="Measure the validation of random tasks, by length.")
    parser.add_argument("domain", nargs="?", default="tabletop")
    parser.add_argument("--lengths", type=int, nargs="+", default=[3, 4, 5, 6])
    parser.add_argument("--count", type=int, default=400, help="tasks of each length")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--restarts", type=int, default=Budget().restarts)
    parser.add_argument("--samples", type=int, default=Budget().samples)
    parser.add_argument("--tier", choices=TIERS, default=TIERS[0])
    return parser.parse_args()


def _measure(validator: Validator, tasks: list[Task], seed: int, budget: Budget) -> Outcome:
    """Validate tasks of one length."""
    outcome = Outcome()
    begun = time.process_time()
    for index, task in enumerate(tasks):
        verdict = validator.validate(task, seed=seed, index=index, budget=budget)
        outcome.tasks += 1
        outcome.restarts += verdict.restarts
        outcome.statuses[verdict.status] += 1
        outcome.causes.update(verdict.causes)
        if not verdict.feasible:
            kind = "proved infeasible" if verdict.status == "infeasible" else "not found"
            outcome.reasons[f"{kind}: {verdict.reason if kind == 'not found' else ''}".rstrip(": ")] += 1
    outcome.seconds = time.process_time() - begun
    return outcome


def _speeds(columns: dict[str, Outcome], title: str) -> Table:
    """Return the table of speeds and pass rates."""
    table = Table(title=title)
    for name in ("length", "tasks", "tasks/s/core", "passed", "infeasible", "not found", "restarts"):
        table.add_column(name, justify="right")
    for name, outcome in columns.items():
        rate = 100 * outcome.statuses["feasible"] / outcome.tasks if outcome.tasks else 0.0
        table.add_row(
            name, str(outcome.tasks), f"{outcome.speed:.0f}", f"{rate:.1f} %", str(outcome.statuses["infeasible"]),
            str(outcome.statuses["not_found"]), f"{outcome.restarts / max(outcome.tasks, 1):.2f}",
        )  # fmt: skip
    return table


def _causes(columns: dict[str, Outcome]) -> Table:
    """Return the table of the causes of failed attempts and of failed tasks."""
    table = Table(title="failed attempts by cause, and failed tasks by reason")
    table.add_column("cause")
    for name in columns:
        table.add_column(name, justify="right")
    for cause in CAUSES:
        if columns["all"].causes[cause]:
            table.add_row(cause, *(str(outcome.causes[cause]) for outcome in columns.values()))
    table.add_section()
    for reason, _ in columns["all"].reasons.most_common():
        table.add_row(f"task {reason}", *(str(outcome.reasons[reason]) for outcome in columns.values()))
    return table


if __name__ == "__main__":
    main()
