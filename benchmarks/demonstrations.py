"""Success rate, speed and causes of failure when the simulated robot executes witnesses of random tasks.

    python benchmarks/demonstrations.py tabletop --count 80

The witness of a task is the first one that passes the tier `transit`; it is executed once, so that no retry hides a
failure. Only the execution is timed, by processor time on one core. Tasks in which the robot touches a ball are
counted separately.
"""

from __future__ import annotations

import argparse
import resource
import time
from collections import Counter
from dataclasses import dataclass, field

from rich.console import Console
from rich.table import Table

from prag_asp import Scene, TaskSpace, load_domain, load_scene
from prag_asp.physics import Budget, Tier, open_validator
from prag_asp.physics.demonstration.performance import open_performer
from prag_asp.physics.symbolic_facts import PhysicalTask, physical_task
from prag_asp.physics.world.simulator import open_simulator

ACCEPTED = Budget(tier=Tier.TRANSIT)
KINDS = ("boxes and cans", "balls")


@dataclass
class Outcome:
    """The results of the tasks of one kind and length."""

    tasks: int = 0
    seconds: float = 0.0
    frames: int = 0
    causes: Counter[str] = field(default_factory=Counter)


def main() -> None:
    """Sample tasks, find witnesses, execute them, and print two tables."""
    options = _options()
    domain = load_domain(options.domain)
    scene = load_scene(domain)
    outcomes = {(kind, length): Outcome() for kind in KINDS for length in options.lengths}
    with (
        open_validator(scene) as validator,
        open_simulator(scene) as planner,
        open_performer(scene, planner) as performer,
    ):
        for length in options.lengths:
            tasks = TaskSpace(domain, length).sample(options.count, seed=options.seed, weights={})
            for index, task in enumerate(tasks):
                witness = validator.validate(task, seed=options.seed, index=index, budget=ACCEPTED).witness
                if witness is None:
                    continue
                physical = physical_task(task, scene)
                outcome = outcomes[KINDS[_touches_ball(physical, scene)], length]
                begun = time.process_time()
                demonstration = performer.perform(physical, witness)
                outcome.seconds += time.process_time() - begun
                outcome.tasks += 1
                outcome.frames += len(demonstration.times)
                outcome.causes[demonstration.cause] += 1
    console = Console()
    console.print(_successes(outcomes, f"{options.domain}: executed witnesses, seed {options.seed}"))
    console.print(_causes(outcomes))
    console.print(f"largest memory {resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024:.0f} MB")


def _options() -> argparse.Namespace:
    """Read the command line."""
    parser = argparse.ArgumentParser(description="Let the simulated robot execute witnesses of random tasks.")
    parser.add_argument("domain", nargs="?", default="tabletop")
    parser.add_argument("--lengths", type=int, nargs="+", default=[3, 4, 5, 6])
    parser.add_argument("--count", type=int, default=80, help="tasks of each length")
    parser.add_argument("--seed", type=int, default=1)
    return parser.parse_args()


def _touches_ball(task: PhysicalTask, scene: Scene) -> bool:
    """Return whether the robot approaches or holds a ball."""
    touched = {each for e in task.effects for each in (e.grasps, e.holds, e.releases, e.visits) if each}
    return any(scene.shapes[entity].kind == "sphere" for entity in touched)


def _successes(outcomes: dict[tuple[str, int], Outcome], title: str) -> Table:
    """Return the table of successes and speeds."""
    table = Table(title=title)
    for name in ("kind", "length", "tasks", "executed", "share", "tasks/s/core", "robot time, s"):
        table.add_column(name, justify="right")
    for kind in KINDS:
        rows = [(str(length), outcome) for (each, length), outcome in outcomes.items() if each == kind]
        total = Outcome()
        for _, outcome in rows:
            total.tasks, total.frames = total.tasks + outcome.tasks, total.frames + outcome.frames
            total.seconds += outcome.seconds
            total.causes.update(outcome.causes)
        for name, outcome in [*rows, ("all", total)]:
            if outcome.tasks:
                table.add_row(
                    kind, name, str(outcome.tasks), str(outcome.causes[""]),
                    f"{100 * outcome.causes[''] / outcome.tasks:.1f} %", f"{outcome.tasks / outcome.seconds:.1f}",
                    f"{outcome.frames / 20 / outcome.tasks:.1f}",
                )  # fmt: skip
        table.add_section()
    return table


def _causes(outcomes: dict[tuple[str, int], Outcome]) -> Table:
    """Return the table of the causes of failure."""
    table = Table(title="tasks that failed, by cause")
    table.add_column("cause")
    for kind in KINDS:
        table.add_column(kind, justify="right")
    counts = {
        kind: sum((outcome.causes for (each, _), outcome in outcomes.items() if each == kind), Counter[str]())
        for kind in KINDS
    }
    for cause in sorted({cause for counter in counts.values() for cause in counter if cause}):
        table.add_row(cause, *(str(counts[kind][cause]) for kind in KINDS))
    return table


if __name__ == "__main__":
    main()
