"""Whether recordings keep to the limits of the robots' joints, and press on nothing that their task does not name.

    python benchmarks/recordings.py --count 500

Draws random tasks of every domain with a scene, of `tabletop` and `prag` with the kuka too, and looks for a recording
of each, at the default budget. In each the speeds and accelerations of the simulated joints are measured from frame to
frame, and those of the commands; contacts are judged by the package, and by a rule that shares no line with it
(tests/independent/recordings.py). It ends with code 1 where anything is found.
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
from prag_asp.physics import Budget, check_demonstration, validate_tasks
from prag_asp.physics.search.attempt import PRESSED
from prag_asp.physics.verdict import Verdict
from prag_asp.task import Task
from tests.independent.recordings import above_limits, unwanted

KINDS = (("tabletop", ""), ("prag", ""), ("kitchen", ""), ("two_arms", ""), ("tabletop", "kuka"), ("prag", "kuka"))
"""Domains, and the robot that stands there in place of their own."""

LENGTHS = (3, 4, 5)


@dataclass
class Outcome:
    """What became of the tasks of one domain with one robot."""

    tasks: int = 0
    shown: int = 0
    at_once: int = 0
    seconds: float = 0.0
    causes: Counter[str] = field(default_factory=Counter)
    faults: list[str] = field(default_factory=list)


def main() -> None:
    """Draw tasks, record them, judge the recordings, print a table and what is wrong."""
    options = _options()
    console, outcomes = Console(stderr=True), dict[str, Outcome]()
    for i, (name, robot) in enumerate(KINDS):
        number = options.count // len(KINDS) + (i < options.count % len(KINDS))
        domain = load_domain(name)
        scene = _with_robot(load_scene(domain), robot)
        drawn = [
            task
            for part, length in enumerate(LENGTHS)
            for task in _drawn(TaskSpace(domain, length), number, options.seed, part)
        ]
        outcome = outcomes[f"{name} {robot}".strip()] = Outcome()
        begun = time.perf_counter()
        verdicts = validate_tasks(
            drawn, scene, seed=options.seed, workers=options.workers, budget=Budget(tier="demonstration")
        )
        for task, verdict in track(
            zip(drawn, verdicts, strict=True), f"{name} {robot}", total=len(drawn), console=console
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
    parser = argparse.ArgumentParser(description="Judge recordings of random tasks of every domain.")
    parser.add_argument("--count", type=int, default=500, help="tasks in all, as many of each domain and robot")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--workers", type=int, default=1)
    return parser.parse_args()


def _drawn(space: TaskSpace, number: int, seed: int, part: int) -> Iterator[Task]:
    """Yield the tasks of one length of so many of all lengths."""
    share = number // len(LENGTHS) + (part < number % len(LENGTHS))
    yield from space.sample(share, seed=seed, weights={}) if share else ()


def _with_robot(scene: Scene, robot: str) -> Scene:
    """Return a scene with another robot wherever one stands."""
    if not robot:
        return scene
    return replace(scene, robots={name: mount._replace(kind=robot) for name, mount in scene.robots.items()})


def _note(outcome: Outcome, task: Task, verdict: Verdict, scene: Scene) -> None:
    """Note what became of a task, and what is wrong with its recording."""
    outcome.tasks += 1
    outcome.causes.update(verdict.causes)
    shown = verdict.demonstration
    if shown is None:
        return
    outcome.shown += 1
    outcome.at_once += verdict.restarts == 1
    kinds = [scene.robots[name].kind for name in shown.robots]
    known = [str(fluent) for fluent, value in task.initial.items() if value]
    found = [
        *above_limits(shown.joints, kinds),
        *above_limits(shown.commands[..., :7], kinds),
        *unwanted(shown, list(map(str, task.actions)), known),
        *check_demonstration(task, shown, scene),
    ]
    outcome.faults += [f"{task}, index {verdict.index}: {fault}" for fault in found]


def _table(outcomes: dict[str, Outcome], seed: int) -> Table:
    """Return the table of recordings."""
    table = Table(title=f"recordings, seed {seed}")
    for name in ("domain", "tasks", "recorded", "at the first start", "stopped for a contact", "faults", "tasks/s"):
        table.add_column(name, justify="left" if name == "domain" else "right")
    for name, outcome in outcomes.items():
        table.add_row(
            name, str(outcome.tasks), str(outcome.shown), str(outcome.at_once), str(outcome.causes[PRESSED]),
            str(len(outcome.faults)), f"{outcome.tasks / outcome.seconds:.1f}",
        )  # fmt: skip
    return table


if __name__ == "__main__":
    main()
