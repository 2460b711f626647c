"""The speed-up of validation with two processes, and a check that the verdicts are identical, byte for byte.

    python benchmarks/workers.py tabletop --count 2000

Speed is measured by wall-clock time, so the machine should be idle: its load is shown. The start of the processes is
excluded: time is measured after the first --warm-up verdicts. The processor time of this process is the sequential
part; that of the workers (including their start) is the parallel part.
"""

from __future__ import annotations

import argparse
import hashlib
import json
import os
import resource
import sys
import time
from collections.abc import Sequence
from typing import NamedTuple

from rich.console import Console
from rich.progress import track
from rich.table import Table

from prag_asp import Task, TaskSpace, load_domain
from prag_asp.dataset.scenes import scene_of
from prag_asp.physics import validate_tasks
from prag_asp.scene.scene import Scene


class Run(NamedTuple):
    """Tasks per second (wall clock), processor seconds of this process and of the workers, and a digest."""

    speed: float
    here: float
    workers: float
    digest: str


def main() -> None:
    """Validate the same tasks with each number of processes, print a table, and compare the verdicts."""
    options = _options()
    domain = load_domain(options.domain)
    tasks = TaskSpace(domain, options.length).sample(options.count, seed=options.seed, weights={})
    load = os.getloadavg()[0]
    measured = {number: _measure(tasks, scene_of(domain), number, options) for number in options.workers}
    table = Table(title=f"{domain.name}, length {options.length}: {os.cpu_count()} cores, load {load:.1f} before")
    for name in ("workers", "tasks/s", "speed-up", "CPU here", "CPU workers", "SHA-256"):
        table.add_column(name, justify="right")
    first = measured[options.workers[0]].speed
    for number, run in measured.items():
        times = (f"{run.speed:.0f}", f"{run.speed / first:.2f}", f"{run.here:.1f}", f"{run.workers:.1f}")
        table.add_row(str(number), *times, run.digest[:8])
    Console().print(table)
    sys.exit(0 if len({run.digest for run in measured.values()}) == 1 else 1)


def _options() -> argparse.Namespace:
    """Read the command line."""
    parser = argparse.ArgumentParser(description="Compare the speed of validation in one and in several processes.")
    parser.add_argument("domain", nargs="?", default="tabletop")
    parser.add_argument("--length", type=int, default=4)
    parser.add_argument("--count", type=int, default=2000)
    parser.add_argument("--workers", type=int, nargs="+", default=[1, 2])
    parser.add_argument("--warm-up", type=int, default=100)
    parser.add_argument("--seed", type=int, default=1)
    return parser.parse_args()


def _measure(tasks: Sequence[Task], scene: Scene, workers: int, options: argparse.Namespace) -> Run:
    """Validate all tasks."""
    digest, begun = hashlib.sha256(), 0.0
    before = [_processor_seconds(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)]
    verdicts = validate_tasks(tasks, scene, seed=options.seed, workers=workers)
    progress = track(verdicts, f"{workers} workers", total=len(tasks), console=Console(stderr=True))
    for number, verdict in enumerate(progress):
        if number == options.warm_up:
            begun = time.perf_counter()
        digest.update(json.dumps(verdict.to_json()).encode())
    speed = (len(tasks) - options.warm_up) / (time.perf_counter() - begun)
    after = [_processor_seconds(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)]
    return Run(speed, after[0] - before[0], after[1] - before[1], digest.hexdigest())


def _processor_seconds(who: int) -> float:
    """Return the processor time of this process, or of its ended child processes."""
    usage = resource.getrusage(who)
    return usage.ru_utime + usage.ru_stime


if __name__ == "__main__":
    main()
