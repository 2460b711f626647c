"""Check that demonstrations respect the joint limits of the robots, and their contacts; replay them in MuJoCo.

    python benchmarks/episodes.py --count 500
    python benchmarks/episodes.py --count 100 --only household --replay

Samples random tasks of every domain and example with a scene (`tabletop` and `prag` also with the kuka) and
demonstrates each at the default budget. Checks the speeds and accelerations of the simulated joints and of the commands
from frame to frame. Contacts and what is in the hand are checked by the package and by an independent checker
(tests/independent/recordings.py), which also checks the witness. Exits with code 1 if there is any fault.

With --replay the commands of each recording are followed open loop in MuJoCo (pip install mujoco scipy), once with
friction 20 % less and masses 20 % more, once the other way round; both have to reach every state of the task.
"""

from __future__ import annotations

import argparse
import json
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
from prag_asp.dataset.jsonl import Record, write_line
from prag_asp.physics import Budget, Tier, check_demonstration, validate_tasks
from prag_asp.physics.search.attempt import PRESSED
from prag_asp.physics.verdict import Verdict
from prag_asp.task import Task
from tests.independent.check import problems
from tests.independent.recordings import above_limits, loosened, overloaded, unwanted
from tests.independent.world import world_of

EXAMPLES = Path(__file__).parents[1] / "examples"
KINDS = (
    ("tabletop", ""), ("prag", ""), ("kitchen", ""), ("two_arms", ""), ("tabletop", "kuka"), ("prag", "kuka"),
    ("household", ""), *((str(EXAMPLES / name), "") for name in ("desk", "dishes", "warehouse")),
)  # fmt: skip
"""Domains, and the robot that replaces the one of the domain."""

CHANGES = ((0.8, 1.2), (1.2, 0.8))
"""Factors of friction and of masses in replays."""

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
    replayed: int = 0
    lost: list[str] = field(default_factory=list)


def main() -> None:
    """Sample tasks, demonstrate them, check the demonstrations, and print a table and the faults."""
    options = _options()
    console, outcomes = Console(stderr=True), dict[str, Outcome]()
    kinds = [each for each in KINDS if not options.only or Path(each[0]).name in options.only]
    for i, (name, robot) in enumerate(kinds):
        number = options.count // len(kinds) + (i < options.count % len(kinds))
        domain = load_domain(name)
        scene = _with_robot(load_scene(domain), robot)
        tasks = [
            task
            for part, length in enumerate(LENGTHS)
            for task in _sampled(TaskSpace(domain, length), number, options.seed, part)
        ]
        outcome = outcomes[f"{Path(name).name} {robot}".strip()] = Outcome()
        begun = time.perf_counter()
        verdicts = validate_tasks(
            tasks, scene, seed=options.seed, workers=options.workers, budget=Budget(tier=Tier.DEMONSTRATION)
        )
        for task, verdict in track(
            zip(tasks, verdicts, strict=True), f"{name} {robot}", total=len(tasks), console=console
        ):
            _note(outcome, task, verdict, scene)
            if options.replay and verdict.demonstration is not None:
                _replay(outcome, task, verdict, scene)
        outcome.seconds = time.perf_counter() - begun
    Console().print(_table(outcomes, options.seed))
    faults = [f"{name}: {fault}" for name, outcome in outcomes.items() for fault in outcome.faults]
    faults_and_lost = [*faults, *(f"{name}: {text}" for name, each in outcomes.items() for text in each.lost)]
    for fault in faults_and_lost:
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
    parser.add_argument("--only", nargs="+", default=[], help="names of domains and examples")
    parser.add_argument("--replay", action="store_true", help="replay the recordings in MuJoCo")
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
    if shown is None or verdict.witness is None:
        return
    outcome.shown += 1
    outcome.at_once += verdict.restarts == 1
    kinds = [scene.robots[name].kind for name in shown.robots]
    initial = [str(fluent) for fluent, value in task.initial.items() if value]
    record = json.loads(write_line(Record(task, None, verdict.witness.to_json())))
    sized = shown.sized_scene(scene)
    world = world_of(replace(sized, ranges={}))
    faults = [
        *problems(record, record["witness"], world, ways=True),
        *overloaded(shown, world.masses),
        *loosened(shown, world.robots),
        *above_limits(shown.joints, kinds),
        *above_limits(shown.commands[..., :7], kinds),
        *unwanted(shown, list(map(str, task.actions)), initial),
        *check_demonstration(task, shown, scene),
    ]
    outcome.faults += [f"{task}, index {verdict.index}: {fault}" for fault in faults]


def _replay(outcome: Outcome, task: Task, verdict: Verdict, scene: Scene) -> None:
    """Follow the commands of a recording in MuJoCo, and add whether every state is reached."""
    from second_simulator import Change, replay  # noqa: PLC0415 - only --replay needs MuJoCo

    shown = verdict.demonstration
    assert shown is not None
    states = [{str(fluent): value for fluent, value in state.items()} for state in (task.initial, *task.states)]
    sized = replace(shown.sized_scene(scene), ranges={})
    missed = [(change, replay(states, shown, sized, Change(*change))) for change in CHANGES]
    outcome.replayed += not any(texts for _, texts in missed)
    outcome.lost += [
        f"{task}, index {verdict.index}, friction and masses x {change}: not replayed: {texts[0]}"
        for change, texts in missed
        if texts
    ]


def _table(outcomes: dict[str, Outcome], seed: int) -> Table:
    """Return the table of demonstrations."""
    table = Table(title=f"demonstrations, seed {seed}")
    columns = ("domain", "tasks", "demonstrated", "without restart", "rejected for a contact", "faults", "replayed")
    for name in (*columns, "tasks/s"):
        table.add_column(name, justify="left" if name == "domain" else "right")
    for name, outcome in outcomes.items():
        table.add_row(
            name, str(outcome.tasks), str(outcome.shown), str(outcome.at_once), str(outcome.causes[PRESSED]),
            str(len(outcome.faults)), str(outcome.replayed), f"{outcome.tasks / outcome.seconds:.1f}",
        )  # fmt: skip
    return table


if __name__ == "__main__":
    main()
