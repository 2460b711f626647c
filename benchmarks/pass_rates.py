"""The paper's experiment on physical validation: the share of feasible random sequences by budget, length and objects.

    python benchmarks/pass_rates.py --domain prag --count 10000

Tasks are sampled uniformly from the exact task spaces, the same number of each length. Writes pass_rates_DOMAIN.json
and .png into the folder --output. Only objects named by the actions of a task are counted.
"""

from __future__ import annotations

import argparse
import json
import resource
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import plots
from rich.console import Console
from rich.progress import track
from rich.table import Table

from prag_asp import Task, TaskSpace, load_domain
from prag_asp.domain.load import load_scene
from prag_asp.physics import CAUSES, Budget, Verdict, validate_tasks
from prag_asp.scene.scene import Scene

PAPER = 78.3
"""The percentage of 10,000 sequences of 3 to 6 actions that passed in "PRAG: Procedural Action Generator"."""

BUDGETS = ("1x1", "1x10", "2x10", "6x10", "10x10", "20x20")
FEWEST = 20
"""The minimum number of tasks for a line in the figure."""

HERE = Path(__file__).parent


@dataclass
class Outcome:
    """The results of all tasks at one budget; by length and by number of objects: tasks, and those that passed."""

    budget: Budget
    seconds: float = 0.0
    tasks: int = 0
    passed: int = 0
    lengths: dict[int, list[int]] = field(default_factory=dict)
    sizes: dict[int, list[int]] = field(default_factory=dict)
    causes: Counter[str] = field(default_factory=Counter)
    reasons: Counter[str] = field(default_factory=Counter)

    def add(self, verdict: Verdict, length: int, objects: int) -> None:
        """Count a verdict on a task with `length` actions and `objects` objects."""
        self.tasks += 1
        self.passed += verdict.feasible
        for counts, key in ((self.lengths, length), (self.sizes, objects)):
            pair = counts.setdefault(key, [0, 0])
            pair[0], pair[1] = pair[0] + 1, pair[1] + verdict.feasible
        self.causes.update(verdict.causes)
        if not verdict.feasible:
            proved = verdict.status == "infeasible"
            self.reasons["proved infeasible" if proved else verdict.reason] += 1

    def to_json(self) -> dict[str, Any]:
        """Return the outcome as JSON-able data."""
        return {
            "budget": self.budget.to_json(),
            "tasks": self.tasks,
            "passed": self.passed,
            "processor_seconds": round(self.seconds, 1),
            "by_length": {key: {"tasks": n, "passed": passed} for key, (n, passed) in sorted(self.lengths.items())},
            "by_objects": {key: {"tasks": n, "passed": passed} for key, (n, passed) in sorted(self.sizes.items())},
            "failed_attempts": dict(self.causes),
            "failed_tasks": dict(self.reasons),
        }


def main() -> None:
    """Sample tasks, validate them at each budget, print tables, and write the results and a figure."""
    options = _options()
    domain = load_domain(options.domain)
    scene = load_scene(domain)
    share = options.count // len(options.lengths)
    tasks = [
        task
        for length in options.lengths
        for task in TaskSpace(domain, length).sample(share, seed=options.seed, weights={})
    ]
    sizes = [_objects(task, scene) for task in tasks]
    outcomes = [_measure(tasks, sizes, scene, budget, options) for budget in options.budgets]
    console = Console()
    for table in (_rates(options, outcomes, "length"), _rates(options, outcomes, "objects"), _causes(outcomes)):
        console.print(table)
    options.output.mkdir(parents=True, exist_ok=True)
    file = options.output / f"pass_rates_{domain.name}"
    header = {"domain": domain.name, "seed": options.seed, "paper_percent": PAPER}
    results = {**header, "outcomes": [outcome.to_json() for outcome in outcomes]}
    file.with_suffix(".json").write_text(json.dumps(results, indent=1) + "\n", encoding="utf-8")
    plots.draw(_panels(outcomes), f"{domain.name}: {len(tasks):,} random tasks that pass", file.with_suffix(".png"))
    Console(stderr=True).print(f"wrote {file}.json and .png")


def _options() -> argparse.Namespace:
    """Read the command line."""
    parser = argparse.ArgumentParser(description="Measure the share of random tasks that are physically feasible.")
    parser.add_argument("--domain", default="prag")
    parser.add_argument("--count", type=int, default=10_000, help="total number of tasks, the same for each length")
    parser.add_argument("--lengths", type=int, nargs="+", default=[3, 4, 5, 6])
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--workers", type=int, default=1)
    parser.add_argument("--budgets", type=_budget, nargs="+", default=[_budget(text) for text in BUDGETS])
    parser.add_argument("--output", type=Path, default=HERE / "results", help="folder for the results")
    return parser.parse_args()


def _budget(text: str) -> Budget:
    """Return the budget written as RESTARTSxSAMPLES."""
    restarts, samples = map(int, text.split("x"))
    return Budget(restarts, samples)


def _objects(task: Task, scene: Scene) -> int:
    """Return the number of bodies that the actions of a task name."""
    bodies = {entity for entity, shape in scene.shapes.items() if shape.kind not in ("robot", "table")}
    return len(bodies & {entity for action in task.actions for entity in action.arguments})


def _name(budget: Budget) -> str:
    """Return a budget as it is written on the command line."""
    return f"{budget.restarts}x{budget.samples}"


def _measure(
    tasks: Sequence[Task], sizes: Sequence[int], scene: Scene, budget: Budget, options: argparse.Namespace
) -> Outcome:
    """Validate all tasks at a budget."""
    outcome, begun = Outcome(budget), _processor_seconds()
    verdicts = validate_tasks(tasks, scene, seed=options.seed, workers=options.workers, budget=budget)
    progress = track(verdicts, f"budget {_name(budget)}", total=len(tasks), console=Console(stderr=True))
    for task, objects, verdict in zip(tasks, sizes, progress, strict=True):
        outcome.add(verdict, len(task), objects)
    outcome.seconds = _processor_seconds() - begun
    return outcome


def _processor_seconds() -> float:
    """Return the processor time of this process and of its workers that have ended."""
    usages = [resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)]
    return sum(usage.ru_utime + usage.ru_stime for usage in usages)


def _percent(pair: Sequence[int]) -> float:
    """Return the share of tasks that passed, of a pair of tasks and passed ones."""
    return 100 * pair[1] / pair[0]


def _rates(options: argparse.Namespace, outcomes: Sequence[Outcome], by: str) -> Table:
    """Return the pass rates by budget, and by length or by number of objects."""
    tasks = outcomes[0].tasks
    table = Table(title=f"{options.domain}: % of {tasks:,} tasks that pass, by {by}; the paper: {PAPER} %")
    table.add_column("budget")
    parts = [outcome.lengths if by == "length" else outcome.sizes for outcome in outcomes]
    for key in sorted(parts[0]):
        table.add_column(f"{key} ({parts[0][key][0]:,})", justify="right")
    table.add_column("all", justify="right")
    table.add_column("tasks/s/core", justify="right")
    for outcome, part in zip(outcomes, parts, strict=True):
        cells = [f"{_percent(part[key]):.1f}" for key in sorted(part)]
        speed = outcome.tasks / max(outcome.seconds, 1e-9)
        table.add_row(_name(outcome.budget), *cells, f"{_percent((tasks, outcome.passed)):.2f}", f"{speed:.0f}")
    return table


def _causes(outcomes: Sequence[Outcome]) -> Table:
    """Return the table of the causes of failed attempts and tasks, by budget."""
    table = Table(title="failed attempts per 100 tasks, by cause; failed tasks, by their most common cause")
    table.add_column("cause")
    for outcome in outcomes:
        table.add_column(_name(outcome.budget), justify="right")
    for cause in CAUSES:
        if any(outcome.causes[cause] for outcome in outcomes):
            table.add_row(cause, *(f"{100 * outcome.causes[cause] / outcome.tasks:.1f}" for outcome in outcomes))
    table.add_section()
    for reason in dict.fromkeys(reason for outcome in outcomes for reason, _ in outcome.reasons.most_common()):
        table.add_row(f"tasks: {reason}", *(f"{outcome.reasons[reason]:,}" for outcome in outcomes))
    return table


def _panels(outcomes: Sequence[Outcome]) -> list[plots.Curves]:
    """Return the pass rate over the budgets, a line for each length, and one for each number of objects."""
    places = [_name(outcome.budget) for outcome in outcomes]
    panels = []
    for by, parts in (
        ("actions", [outcome.lengths for outcome in outcomes]),
        ("objects", [outcome.sizes for outcome in outcomes]),
    ):
        keys = [key for key, (tasks, _) in sorted(parts[0].items()) if tasks >= FEWEST]
        lines = [(f"{key} {by if key > 1 else by[:-1]}", [_percent(part[key]) for part in parts]) for key in keys]
        panels.append(
            plots.Curves(
                title=f"by number of {by}",
                across="budget: restarts x samples",
                up="% of tasks that pass",
                places=places,
                lines=lines,
                reference=("the paper: 78.3 %", PAPER),
            )
        )
    return panels


if __name__ == "__main__":
    main()
