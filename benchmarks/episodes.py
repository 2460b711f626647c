"""Check that demonstrations respect the joint limits of the robots, and their contacts; replay them in MuJoCo.

    python benchmarks/episodes.py --count 500 --log episodes.jsonl
    python benchmarks/episodes.py --count 40 --only household --replay

Samples random tasks of every domain and example with a scene (`tabletop` and `prag` also with the kuka) and
demonstrates each at the default budget. Checks the speeds and accelerations of the simulated joints and of the commands
from frame to frame. Contacts and what is in the hand are checked by the package and by an independent checker
(tests/independent/recordings.py), which also checks the witness. Exits with code 1 if there is any fault.

With --log each result is appended to a file at once, and the results that the file has are not computed again.

With --replay the commands of each recording are followed open loop in MuJoCo (pip install mujoco scipy), once with
friction 20 % less and masses 20 % more, once the other way round; both have to reach every state of the task.
"""

from __future__ import annotations

import argparse
import json
import sys
import time
from collections.abc import Iterator, Mapping
from dataclasses import asdict, dataclass, replace
from pathlib import Path

from rich.console import Console
from rich.progress import track
from rich.table import Table

sys.path.insert(0, str(Path(__file__).parents[1]))

from prag_asp import Scene, TaskSpace, load_domain, load_scene
from prag_asp.dataset.jsonl import Record, write_line
from prag_asp.physics import Budget, Tier, check_demonstration
from prag_asp.physics.search.attempt import PRESSED
from prag_asp.physics.validation import validate_numbered
from prag_asp.physics.verdict import Verdict
from prag_asp.rl import Rate
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


@dataclass(frozen=True)
class Result:
    """The result of a task: a line of the log.

    `kind` is the domain with its robot; `seed` and `index` reproduce the validation. `nearest` says how far the search
    came if the task is not demonstrated, `contacts` how many attempts were rejected for a contact. `lost` has the facts
    that replays miss, None if the recording was not replayed.
    """

    kind: str
    seed: int
    index: int
    task: str
    shown: bool
    restarts: int
    contacts: int
    nearest: str
    seconds: float
    faults: list[str]
    lost: list[str] | None


Results = dict[tuple[str, int, int, str], Result]
"""Results by kind, seed, index and task."""


def main() -> None:
    """Sample tasks, demonstrate them, check the demonstrations, and print a table and the faults."""
    options = _options()
    logged, found = _read(options.log), dict[str, list[Result]]()
    kinds = [each for each in KINDS if not options.only or Path(each[0]).name in options.only]
    for i, (name, robot) in enumerate(kinds):
        kind = f"{Path(name).name} {robot}".strip()
        number = options.count // len(kinds) + (i < options.count % len(kinds))
        domain = load_domain(name)
        scene = _with_robot(load_scene(domain), robot)
        tasks = [
            task
            for part, length in enumerate(options.lengths)
            for task in _sampled(TaskSpace(domain, length), number, options, part)
        ]
        for result in _results(kind, tasks, scene, logged, options):
            found.setdefault(kind, []).append(result)
    Console().print(_table(found, options))
    for result in (each for some in found.values() for each in some):
        texts = [*result.faults, *(result.lost or ()), *(() if result.shown else (f"not found: {result.nearest}",))]
        for text in texts:
            Console().print(
                f"{result.kind}: {result.task}, index {result.index}: {text}", soft_wrap=True, highlight=False
            )
    sys.exit(any(result.faults for some in found.values() for result in some))


def _options() -> argparse.Namespace:
    """Read the command line."""
    parser = argparse.ArgumentParser(description="Check demonstrations of random tasks of every domain.")
    parser.add_argument(
        "--count", type=int, default=500, help="total number of tasks, the same for each domain and robot"
    )
    parser.add_argument("--lengths", type=int, nargs="+", default=[3, 4, 5, 6], help="of tasks, in actions")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--only", nargs="+", default=[], help="names of domains and examples")
    parser.add_argument("--replay", action="store_true", help="replay the recordings in MuJoCo")
    parser.add_argument("--log", type=Path, help="file of results, which are appended and not computed again")
    return parser.parse_args()


def _sampled(space: TaskSpace, number: int, options: argparse.Namespace, part: int) -> Iterator[Task]:
    """Yield the tasks of the length number `part`, its share of `number` tasks of all lengths."""
    share = number // len(options.lengths) + (part < number % len(options.lengths))
    yield from space.sample(share, seed=options.seed, weights={}) if share else ()


def _with_robot(scene: Scene, robot: str) -> Scene:
    """Return a scene in which all robots are of another kind."""
    if not robot:
        return scene
    return replace(scene, robots={name: mount._replace(kind=robot) for name, mount in scene.robots.items()})


def _read(log: Path | None) -> Results:
    """Return the results of a log; a line that was cut off by a crash is ignored."""
    results: Results = {}
    for line in log.read_text(encoding="utf-8").splitlines() if log is not None and log.exists() else ():
        try:
            result = Result(**json.loads(line))
        except ValueError:
            continue
        results[result.kind, result.seed, result.index, result.task] = result
    return results


def _results(
    kind: str, tasks: list[Task], scene: Scene, logged: Results, options: argparse.Namespace
) -> Iterator[Result]:
    """Yield the results of tasks: first those that are logged, then the others, which are logged."""
    missing = list[tuple[int, Task]]()
    for index, task in enumerate(tasks):
        known = logged.get((kind, options.seed, index, str(task)))
        if known is None or (options.replay and known.shown and known.lost is None):
            missing.append((index, task))
        else:
            yield known
    begun = time.process_time()
    verdicts = validate_numbered(missing, scene, seed=options.seed, budget=Budget(tier=Tier.DEMONSTRATION))
    for (index, task), verdict in track(
        zip(missing, verdicts, strict=True), kind, total=len(missing), console=Console(stderr=True)
    ):
        shown, faults, lost = verdict.demonstration is not None, list[str](), None
        seconds = time.process_time() - begun
        if shown:
            faults = _faults(task, verdict, scene)
            lost = _lost(task, verdict, scene) if options.replay else None
        result = Result(
            kind, options.seed, index, str(task), shown, verdict.restarts, verdict.causes.get(PRESSED, 0),
            verdict.nearest or ("" if shown else verdict.reason), round(seconds, 2), faults, lost,
        )  # fmt: skip
        if options.log is not None:
            with options.log.open("a", encoding="utf-8") as file:
                file.write(json.dumps(asdict(result)) + "\n")
        yield result
        begun = time.process_time()


def _faults(task: Task, verdict: Verdict, scene: Scene) -> list[str]:
    """Return the faults of a demonstration and its witness."""
    shown = verdict.demonstration
    assert shown is not None and verdict.witness is not None
    kinds = [scene.robots[name].kind for name in shown.robots]
    initial = [str(fluent) for fluent, value in task.initial.items() if value]
    record = json.loads(write_line(Record(task, None, verdict.witness.to_json())))
    world = world_of(replace(shown.sized_scene(scene), ranges={}))
    return [
        *problems(record, record["witness"], world, ways=True),
        *overloaded(shown, world.masses),
        *loosened(shown, world.robots),
        *above_limits(shown.joints, kinds),
        *above_limits(shown.commands[..., :7], kinds),
        *unwanted(shown, list(map(str, task.actions)), initial, world.masses),
        *check_demonstration(task, shown, scene),
    ]


def _lost(task: Task, verdict: Verdict, scene: Scene) -> list[str]:
    """Return the facts that are missed where a recording is replayed in MuJoCo, the first with each change."""
    from second_simulator import Change, replay  # noqa: PLC0415 - only --replay needs MuJoCo

    shown = verdict.demonstration
    assert shown is not None
    states = [{str(fluent): value for fluent, value in state.items()} for state in (task.initial, *task.states)]
    sized = replace(shown.sized_scene(scene), ranges={})
    missed = [(change, replay(states, shown, sized, Change(*change))) for change in CHANGES]
    return [f"friction and masses x {change}: not replayed: {texts[0]}" for change, texts in missed if texts]


def _table(found: Mapping[str, list[Result]], options: argparse.Namespace) -> Table:
    """Return the table of demonstrations."""
    table = Table(
        title=f"demonstrations of tasks of {', '.join(map(str, options.lengths))} actions, seed {options.seed}"
    )
    columns = ("domain", "tasks", "demonstrated", "interval", "without restart", "rejected for a contact", "faults")
    for name in (*columns, "replayed", "s a task"):
        table.add_column(name, justify="left" if name == "domain" else "right")
    for kind, results in [*found.items(), ("all", [each for some in found.values() for each in some])]:
        shown = [each for each in results if each.shown]
        low, high = Rate(len(shown), len(results)).interval()
        replayed = [each for each in shown if each.lost is not None]
        table.add_row(
            kind, str(len(results)), str(len(shown)), f"{low:.0%} to {high:.0%}",
            str(sum(each.restarts == 1 for each in shown)), str(sum(each.contacts for each in results)),
            str(sum(len(each.faults) for each in results)),
            f"{sum(not each.lost for each in replayed)} of {len(replayed)}",
            f"{sum(each.seconds for each in results) / max(len(results), 1):.1f}",
        )  # fmt: skip
    return table


if __name__ == "__main__":
    main()
