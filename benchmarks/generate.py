"""The cost of generating a dataset compared with validating the same tasks, its memory, and the time to open it.

``python benchmarks/generate.py [--tasks 300] [--workers 2] [--rounds 3] [--large 100000]`` samples tasks of `tabletop`,
lengths 3-6, and prints ratios of alternating measurements; then, without physics, the memory for datasets of two sizes,
and the time to open a dataset and read one task.
"""

from __future__ import annotations

import argparse
import json
import resource
import subprocess
import sys
import time
from collections.abc import Callable
from functools import partial
from itertools import islice
from pathlib import Path
from statistics import median
from tempfile import TemporaryDirectory

from prag_asp import Dataset, TaskSpace, load_domain
from prag_asp.dataset import generate
from prag_asp.dataset.scenes import scene_of
from prag_asp.physics import validate_tasks
from prag_asp.space.without_replacement import Division, ordered_parts, with_tasks

LENGTHS = range(3, 7)
MEASURE = """
import json, resource, sys, time
from prag_asp import TaskSpace, load_domain
from prag_asp.dataset import generate
folder, tasks = sys.argv[1], int(sys.argv[2])
begun = time.perf_counter()
generate(TaskSpace(load_domain("tabletop"), range(3, 7)), folder, tasks=tasks, physics=False)
print(json.dumps([time.perf_counter() - begun, resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1000]))
"""


def say(line: str) -> None:
    """Print a line and flush."""
    sys.stdout.write(f"{line}\n")
    sys.stdout.flush()


def computed(work: Callable[[], object]) -> float:
    """Return the processor seconds of a function in this process and in workers that have ended."""

    def now() -> float:
        each = (resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN))
        return sum(used.ru_utime + used.ru_stime for used in each)

    begun = now()
    work()
    return now() - begun


def seconds(work: Callable[[], object]) -> float:
    """Return the wall-clock seconds that a function takes."""
    begun = time.perf_counter()
    work()
    return time.perf_counter() - begun


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--tasks", type=int, default=300)
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--large", type=int, default=100_000)
    options = parser.parse_args()
    spaces = TaskSpace(load_domain("tabletop"), LENGTHS)
    (part,) = ordered_parts(spaces, Division.parse(None), seed=0, weights=spaces.weights()).values()

    def validated(draws: int) -> None:
        tasks = (task for _, task in islice(with_tasks(spaces, part.draws()), draws))
        for _ in validate_tasks(tasks, scene_of(spaces.domain), seed=0, workers=options.workers):
            pass

    def one(folder: Path) -> None:
        generate(spaces, folder, tasks=1)

    def whole(folder: Path) -> None:
        generate(spaces, folder, tasks=options.tasks, workers=options.workers)

    with TemporaryDirectory() as temporary:
        folder = Path(temporary)
        pairs = []
        validated(options.tasks)  # fills the caches, which are not measured
        for number in range(options.rounds):
            along = computed(partial(whole, folder / str(number)))
            (note,) = Dataset.open(folder / str(number)).manifest.parts
            alone = computed(partial(validated, note.draws))  # including the infeasible tasks, which take longest
            pairs.append(along / alone)
            say(f"{options.tasks} tasks, CPU seconds: validation {alone:.2f}, total {along:.2f}, ratio {pairs[-1]:.3f}")
        say(f"median ratio {median(pairs):.3f}")
        say(f"a dataset of one task takes {computed(partial(one, folder / 'one')):.2f} s")
        for tasks in (options.large // 10, options.large):
            process = subprocess.run(
                [sys.executable, "-c", MEASURE, str(folder / f"large{tasks}"), str(tasks)], check=True,
                capture_output=True, text=True,
            )  # fmt: skip
            duration, memory = json.loads(process.stdout)
            say(f"{tasks} tasks without physics: {duration:.1f} s, peak memory {memory:.0f} MB")
        last = folder / f"large{options.large}"
        number = 77_777 * options.large // 100_000

        def read() -> None:
            Dataset.open(last).task(number)

        read()
        say(f"opening and reading task {number}: {1000 * median(seconds(read) for _ in range(9)):.1f} ms")


if __name__ == "__main__":
    main()
