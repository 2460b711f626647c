"""Check that the resident memory of a process that validates many tasks of mixed lengths stays flat.

    python benchmarks/memory.py tabletop --count 20000

Tasks are sampled in this process and validated in another one, whose memory is measured. Exits with code 1 if the
memory has grown by 20 MB or more after the first --warm-up tasks.
"""

from __future__ import annotations

import argparse
import os
import resource
import sys
from collections.abc import Callable, Iterator
from concurrent.futures import ProcessPoolExecutor
from contextlib import ExitStack
from itertools import cycle, islice
from multiprocessing import get_context
from pathlib import Path

import plots
from rich.console import Console
from rich.progress import track
from rich.table import Table

from prag_asp import Task, TaskSpace, load_domain
from prag_asp.dataset.scenes import scene_of
from prag_asp.physics import TIERS, Budget, Verdict, open_validator
from prag_asp.scene.scene import Scene

LIMIT = 20.0
"""The growth that is allowed, in MB."""

STATM = Path("/proc/self/statm")


def main() -> None:
    """Validate tasks, print the memory over time, and check its growth."""
    options = _options()
    domain = load_domain(options.domain)
    spaces = [TaskSpace(domain, length) for length in options.lengths]
    tasks = _mixed([space.stream(seed=options.seed, weights={}) for space in spaces])
    budget = Budget(options.restarts, options.samples, options.tier)
    curve = []
    steps = range(options.every, options.count + 1, options.every)
    with ProcessPoolExecutor(
        1, mp_context=get_context("spawn"), initializer=_open, initargs=(scene_of(domain), options.seed, budget)
    ) as worker:
        for number in track(steps, f"each {options.every:,} tasks", console=Console(stderr=True)):
            group = list(islice(tasks, options.every))
            curve.append((number, worker.submit(_validate, group, number - len(group)).result()))
    first = next(size for number, size in curve if number >= min(options.warm_up, options.count))
    table = Table(title=f"{domain.name}, {budget}: memory")
    table.add_column("tasks", justify="right")
    table.add_column("MB", justify="right")
    for number, size in curve:
        table.add_row(f"{number:,}", f"{size:.1f}")
    console = Console()
    console.print(table)
    grown = curve[-1][1] - first
    console.print(f"growth since task {options.warm_up:,}: {grown:.1f} MB; limit: {LIMIT:.0f} MB")
    if options.output is not None:
        _plot(curve, domain.name, options.output)
    sys.exit(0 if grown < LIMIT else 1)


_resources = ExitStack()
_validators: list[Callable[[Task, int], Verdict]] = []
"""The open resources and the validator of the worker process."""


def _open(scene: Scene, seed: int, budget: Budget) -> None:
    """Open a validator for the lifetime of this process."""
    validator = _resources.enter_context(open_validator(scene))
    _validators.append(lambda task, index: validator.validate(task, seed=seed, index=index, budget=budget))


def _validate(tasks: list[Task], first: int) -> float:
    """Validate tasks and return the memory of this process afterwards."""
    for index, task in enumerate(tasks, first):
        _validators[0](task, index)
    return megabytes()


def megabytes() -> float:
    """Return the resident memory of this process in MB; its peak if the system does not report the current value."""
    if STATM.exists():
        return int(STATM.read_text().split()[1]) * os.sysconf("SC_PAGE_SIZE") / 2**20
    largest = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    return largest / (2**20 if sys.platform == "darwin" else 2**10)


def _options() -> argparse.Namespace:
    """Read the command line."""
    parser = argparse.ArgumentParser(description="Measure the memory of a process that validates tasks.")
    parser.add_argument("domain", nargs="?", default="tabletop")
    parser.add_argument("--lengths", type=int, nargs="+", default=[3, 4, 5, 6])
    parser.add_argument("--count", type=int, default=20_000, help="total number of tasks, lengths in turn")
    parser.add_argument("--every", type=int, default=1000, help="tasks between two measurements")
    parser.add_argument("--warm-up", type=int, default=1000, help="tasks before growth is measured")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--restarts", type=int, default=Budget().restarts)
    parser.add_argument("--samples", type=int, default=Budget().samples)
    parser.add_argument("--tier", choices=TIERS, default=TIERS[0])
    parser.add_argument("--output", type=Path, help="PNG file for the curve")
    return parser.parse_args()


def _mixed(streams: list[Iterator[Task]]) -> Iterator[Task]:
    """Yield tasks from all streams in turn."""
    for stream in cycle(streams):
        yield next(stream)


def _plot(curve: list[tuple[int, float]], name: str, file: Path) -> None:
    """Plot the memory over the number of tasks."""
    step = max(1, len(curve) // 10)
    places = [f"{number / 1000:g}k" if k % step == step - 1 else "" for k, (number, _) in enumerate(curve)]
    top = 50 * (1 + int(max(size for _, size in curve) / 50))
    lines = [("resident memory", [size for _, size in curve])]
    panel = plots.Curves(f"{name}: memory of a worker", "tasks", "MB", places, lines, high=float(top))
    plots.draw([panel], "", file)


if __name__ == "__main__":
    main()
