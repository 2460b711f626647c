"""Spawn objects so that relations hold, by three methods: success and time over numbers of objects and relations.

    python benchmarks/spawning.py --count 100

The paper compares spawning by volumes with images of DALL-E 2. Here it is compared with simpler methods: (a) sample all
objects uniformly in the box; (b) sample each object, in the order of the names, from the intersection of the volumes of
its relations to objects that are already placed; (c) the placement of the package, which also inverts relations and
orders objects. The relations hold in some random arrangement, so that every scene is possible. A scene is correct if
every relation passes its predicate's check, all objects are in the box, and nothing collides in PyBullet. Methods (b)
and (c) restart a scene at most --restarts times, (a) at most --draws times.
"""

from __future__ import annotations

import argparse
import json
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import plots
from rich.console import Console
from rich.progress import track
from rich.table import Table
from spawning_ways import (
    BOX,
    COLORS,
    DIRECTIONS,
    MOST,
    SHAPES,
    by_placement,
    by_volumes,
    correct,
    kind_of,
    random_task,
    uniform,
)

from prag_asp.physics.pictures.camera import picture
from prag_asp.physics.pictures.views import view_from
from prag_asp.physics.search.attempt import Search
from prag_asp.physics.search.foresight import foresee
from prag_asp.physics.situation import Situation
from prag_asp.physics.symbolic_facts import PhysicalTask
from prag_asp.physics.witness import Arm, Moment
from prag_asp.physics.world.simulator import open_simulator
from prag_asp.scene.scene import Scene, Shape

HERE = Path(__file__).parent
SIZE = (560, 470)
"""The size of an image, in pixels."""


@dataclass
class Cell:
    """The results for one method and one number of objects and relations."""

    scenes: int = 0
    spawned: int = 0
    seconds: float = 0.0

    @property
    def percent(self) -> float:
        """The share of spawned scenes."""
        return 100 * self.spawned / self.scenes

    @property
    def milliseconds(self) -> float:
        """Processor time for each scene, spawned or not."""
        return 1000 * self.seconds / self.scenes


Way = Callable[[Search, PhysicalTask, int], Situation | None]
Cells = dict[tuple[str, int, int], Cell]


def main() -> None:
    """Measure all methods, print the tables, and write the figures and images."""
    options = _options()
    scene = Scene(
        shapes={"panda": Shape("robot"), "table": Shape("table"), **{name: SHAPES[kind_of(name)] for name in COLORS}},
        frame="viewer",
        workspace=BOX,
        colors=COLORS,
    )
    ways: dict[str, tuple[Way, int]] = {
        "uniform in a box": (uniform, options.draws),
        "volumes": (by_volumes, options.restarts),
        "volumes, relations ordered": (by_placement, options.restarts),
    }
    cells: Cells = {}
    hardest: list[tuple[Situation, PhysicalTask]] = []
    places = [(objects, relations) for objects in range(1, MOST + 1) for relations in range(MOST + 1)]
    possible = [place for place in places if place[1] <= place[0] * (place[0] - 1)]
    with open_simulator(scene) as simulator:
        for objects, relations in track(possible, "scenes", console=Console(stderr=True)):
            for number in range(options.count):
                key = [options.seed, objects, relations, number]
                task = random_task(simulator.scene, np.random.default_rng(key), objects, relations)
                for name, (way, tries) in ways.items():
                    search = Search(simulator, task.objects, np.random.default_rng([*key, 1]), foresee(task, scene))
                    situation = _measure(cells.setdefault((name, objects, relations), Cell()), way, search, task, tries)
                    if situation is not None and way is by_placement and objects == relations == MOST:
                        hardest.append((situation, task))
    _report(list(ways), cells, possible, options)
    if hardest:
        _pictures(scene, hardest[:3], options.output / "spawning_scenes.png")


def _options() -> argparse.Namespace:
    """Read the command line."""
    parser = argparse.ArgumentParser(description="Spawn objects so that relations hold, by three methods.")
    parser.add_argument("--count", type=int, default=100, help="scenes for each number of objects and relations")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--draws", type=int, default=500, help="samples of the uniform method for each scene")
    parser.add_argument("--restarts", type=int, default=100, help="restarts of the other methods for each scene")
    parser.add_argument("--output", type=Path, default=HERE / "figures", help="folder for figures and results")
    return parser.parse_args()


def _measure(cell: Cell, way: Way, search: Search, task: PhysicalTask, tries: int) -> Situation | None:
    """Spawn a scene, and count it if it is correct; only the method is timed."""
    begun = time.process_time()
    situation = way(search, task, tries)
    cell.seconds += time.process_time() - begun
    cell.scenes += 1
    if situation is None or not correct(search, situation, task.initial):
        return None
    cell.spawned += 1
    return situation


def _report(
    ways: Sequence[str], cells: Cells, possible: Sequence[tuple[int, int]], options: argparse.Namespace
) -> None:
    """Print the tables, and write the results and the figures."""
    console = Console()
    for what in ("percent", "milliseconds"):
        titles = {"percent": "% of scenes spawned", "milliseconds": "processor ms for each scene"}
        table = Table(title=f"{titles[what]}, mean over all numbers of relations; {options.count} scenes each")
        table.add_column("objects")
        for name in ways:
            table.add_column(name, justify="right")
        for objects in range(1, MOST + 1):
            rows = [[cells[name, n, r] for n, r in possible if n == objects] for name in ways]
            table.add_row(str(objects), *(f"{np.mean([getattr(cell, what) for cell in row]):.1f}" for row in rows))
        table.add_section()
        table.add_row(f"{MOST}, with {MOST} relations", *(f"{getattr(cells[n, MOST, MOST], what):.1f}" for n in ways))
        console.print(table)
    options.output.mkdir(parents=True, exist_ok=True)
    results = [
        {"way": name, "objects": objects, "relations": relations, "scenes": cell.scenes, "spawned": cell.spawned,
         "milliseconds": round(cell.milliseconds, 2)}
        for (name, objects, relations), cell in cells.items()
    ]  # fmt: skip
    (options.output / "spawning.json").write_text(json.dumps(results, indent=0) + "\n", encoding="utf-8")
    plots.draw(_panels(ways, cells), "Objects spawned so that relations hold", options.output / "spawning.png")


def _panels(ways: Sequence[str], cells: Cells) -> list[plots.Curves | plots.Heat]:
    """Return heat maps of success, followed by heat maps of time."""
    names = [f"({letter}) {name}" for letter, name in zip("abc", ways, strict=True)]
    counts, rows = [str(n) for n in range(MOST + 1)], range(MOST, 0, -1)
    slowest = max(cell.milliseconds for cell in cells.values())
    panels: list[plots.Curves | plots.Heat] = []
    for what, high, unit in (("percent", 100.0, "% spawned"), ("milliseconds", slowest, "ms a scene")):
        for name, title in zip(ways, names, strict=True):
            values = [
                [getattr(cells[name, n, r], what) if (name, n, r) in cells else None for r in range(MOST + 1)]
                for n in rows
            ]
            shown = "{:.0f}".format if what == "percent" else _short
            panels.append(
                plots.Heat(
                    f"{title}: {unit}", "relations", "objects", counts, [str(n) for n in rows], values, high, shown
                )
            )
    return panels


def _short(value: float) -> str:
    """Return a time with two digits."""
    return f"{value:.0f}" if value >= 9.95 else f"{value:.1f}"


def _pictures(scene: Scene, shown: Sequence[tuple[Situation, PhysicalTask]], file: Path) -> None:
    """Write images of scenes with their relations as captions."""
    with open_simulator(scene, visual=True) as simulator:
        home = {name: Arm(arm.robot.home, arm.robot.opening) for name, arm in simulator.arms.items()}
        images, captions = [], []
        for situation, task in shown:
            moment = Moment(situation.poses, home)
            images.append(picture(simulator, moment, SIZE, view_from(simulator.scene, SIZE[0] / SIZE[1])))
            beside = [fact for fact in task.initial if fact.predicate.name in DIRECTIONS]
            captions.append([fact.sentence() for fact in beside])
    plots.gallery(images, captions, file)


if __name__ == "__main__":
    main()
