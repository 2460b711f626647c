"""Check that demonstrations respect the joint limits of the robots and have no unwanted contacts.

    python benchmarks/episodes.py --count 500

Samples random tasks of every domain with a scene (`tabletop` and `prag` also with the kuka) and demonstrates each at
the default budget. Checks the speeds and accelerations of the simulated joints and of the commands from frame to frame.
Contacts are checked by the package and by an independent checker (tests/independent/recordings.py). Exits with code 1
if there is any fault.
"""

from __future__ import annotations

import argparse
import sys
import time
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from pathlib import Path

from rich.console import Console
from rich.progress import track
from rich.table import Table

sys.path.insert(0, str(Path(__file__).parents[1]))

from prag_asp import Scene, TaskSpace, load_domain, load_scene
from prag_asp.physics import Budget, Tier, check_demonstration, validate_tasks
from prag_asp.physics.search.attempt import PRESSED
from prag_asp.physics.verdict import Verdict
from prag_asp.task import Task
from tests.independent.recordings import above_limits, unwanted

KINDS = (("tabletop", ""), ("prag", ""), ("kitchen", ""), ("two_arms", ""), ("tabletop", "kuka"), ("prag", "kuka"))
"""Domains, and the robot that replaces the one of the domain."""

LENGTHS = (3, 4, 5)


@dataclass
class Outcome:
    """The results of the tasks of one domain with one robot."""

    tasks: int = 0
    shown: int = 0
    at_once: int = 0
    seconds: float = 0.0
    causes: Counter[str] = field(default_factory=Counter)
    faults: list[str] = field(default_factory=list)


def main() -> None:
    """Sample tasks, demonstrate them, check the demonstrations, and print a table and the faults."""
    options = _options()
    console, outcomes = Console(stderr=True), dict[str, Outcome]()
    for i, (name, robot) in enumerate(KINDS):
        number = options.count // len(KINDS) + (i < options.count % len(KINDS))
        domain = load_domain(name)
        scene = _with_robot(load_scene(domain), robot)
        tasks = [
            task
            for part, length in enumerate(LENGTHS)
            for task in _sampled(TaskSpace(domain, length), number, options.seed, part)
        ]
        outcome = outcomes[f"{name} {robot}".strip()] = Outcome()
        begun = time.perf_counter()
        verdicts = validate_tasks(
            tasks, scene, seed=options.seed, workers=options.workers, budget=Budget(tier=Tier.DEMONSTRATION)
        )
        for task, verdict in track(
            zip(tasks, verdicts, strict=True), f"{name} {robot}", total=len(tasks), console=console
        ):
            _note(outcome, task, verdict, scene)
        outcome.seconds = time.perf_counter() - begun
    Console().print(_table(outcomes, options.seed))
    faults = [f"{name}: {fault}" for name, outcome in outcomes.items() for fault in outcome.faults]
    for fault in faults:
        Console().print(fault, soft_wrap=True, highlight=False)
    sys.exit(bool(faults))


def _options() -> argparse.Namespace:
    """Read the command line."""
    parser = argparse.ArgumentParser(description="Check demonstrations of random tasks of every domain.")
    parser.add_argument(
        "--count", type=int, default=500, help="total number of tasks, the same for each domain and robot"
    )
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--workers", type=int, default=1)
    return parser.parse_args()


def _sampled(space: TaskSpace, number: int, seed: int, part: int) -> Iterator[Task]:
    """Yield the tasks of the length number `part`, its share of `number` tasks of all lengths."""
    share = number // len(LENGTHS) + (part < number % len(LENGTHS))
    yield from space.sample(share, seed=seed, weights={}) if share else ()


def _with_robot(scene: Scene, robot: str) -> Scene:
    """Return a scene in which all robots are of another kind."""
    if not robot:
        return scene
    return replace(scene, robots={name: mount._replace(kind=robot) for name, mount in scene.robots.items()})


def _note(outcome: Outcome, task: Task, verdict: Verdict, scene: Scene) -> None:
    """Add the result of a task and the faults of its demonstration."""
    outcome.tasks += 1
    outcome.causes.update(verdict.causes)
    shown = verdict.demonstration
    if shown is None:
        return
    outcome.shown += 1
    outcome.at_once += verdict.restarts == 1
    kinds = [scene.robots[name].kind for name in shown.robots]
    initial = [str(fluent) for fluent, value in task.initial.items() if value]
    faults = [
        *above_limits(shown.joints, kinds),
        *above_limits(shown.commands[..., :7], kinds),
        *unwanted(shown, list(map(str, task.actions)), initial),
        *check_demonstration(task, shown, scene),
    ]
    outcome.faults += [f"{task}, index {verdict.index}: {fault}" for fault in faults]


def _table(outcomes: dict[str, Outcome], seed: int) -> Table:
    """Return the table of demonstrations."""
    table = Table(title=f"demonstrations, seed {seed}")
    for name in ("domain", "tasks", "demonstrated", "without restart", "rejected for a contact", "faults", "tasks/s"):
        table.add_column(name, justify="left" if name == "domain" else "right")
    for name, outcome in outcomes.items():
        table.add_row(
            name, str(outcome.tasks), str(outcome.shown), str(outcome.at_once), str(outcome.causes[PRESSED]),
            str(len(outcome.faults)), f"{outcome.tasks / outcome.seconds:.1f}",
        )  # fmt: skip
    return table


if __name__ == "__main__":
    main()
