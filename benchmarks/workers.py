"""How much faster two processes validate than one, and that they find the same, byte for byte.

    python benchmarks/workers.py tabletop --count 2000

Speed is by the clock, so the machine should be idle: its load is shown. The start of the processes is left out: the
clock runs from the first --warm-up verdicts on.
"""

from __future__ import annotations

import argparse
import hashlib
import json
import os
import sys
import time
from collections.abc import Sequence

from rich.console import Console
from rich.progress import track
from rich.table import Table

from prag_asp import Task, TaskSpace, load_domain
from prag_asp.cli.options import scene_of
from prag_asp.domain.scene import Scene
from prag_asp.physics import validate_tasks


def main() -> None:
    """Validate the same tasks with each number of processes, print a table, compare the verdicts."""
    options = _options()
    domain = load_domain(options.domain)
    tasks = TaskSpace(domain, options.length).sample(options.count, seed=options.seed, weights={})
    load = os.getloadavg()[0]
    measured = {number: _measure(tasks, scene_of(domain), number, options) for number in options.workers}
    table = Table(title=f"{domain.name}, length {options.length}: {os.cpu_count()} cores, load {load:.1f} before")
    for name in ("workers", "tasks/s", "times as fast", "verdicts and witnesses (SHA-256)"):
        table.add_column(name, justify="right")
    slowest = measured[options.workers[0]][0]
    for number, (speed, digest) in measured.items():
        table.add_row(str(number), f"{speed:.0f}", f"{speed / slowest:.2f}", digest[:16])
    Console().print(table)
    sys.exit(0 if len({digest for _, digest in measured.values()}) == 1 else 1)


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


def _measure(tasks: Sequence[Task], scene: Scene, workers: int, options: argparse.Namespace) -> tuple[float, str]:
    """Return how many tasks a second are validated, and the digest of all verdicts."""
    digest, begun = hashlib.sha256(), 0.0
    verdicts = validate_tasks(tasks, scene, seed=options.seed, workers=workers)
    told = track(verdicts, f"{workers} workers", total=len(tasks), console=Console(stderr=True))
    for number, verdict in enumerate(told):
        if number == options.warm_up:
            begun = time.perf_counter()
        digest.update(json.dumps(verdict.to_json()).encode())
    return (len(tasks) - options.warm_up) / (time.perf_counter() - begun), digest.hexdigest()


if __name__ == "__main__":
    main()
