"""How much longer a data set takes than validation alone of the same tasks, and what memory and opening cost.

``python benchmarks/generate.py [--tasks 300] [--workers 2] [--rounds 3] [--large 100000]`` draws tasks of `tabletop`,
lengths 3-6, and prints ratios of times that were taken by turns; then, without physics, memory of this process for
data sets of two sizes, and how long one takes to be opened and one of its tasks to be read.
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
    """Print a line at once."""
    sys.stdout.write(f"{line}\n")
    sys.stdout.flush()


def computed(work: Callable[[], object]) -> float:
    """Return how many seconds this process and the workers that it has ended compute for something."""

    def now() -> float:
        each = (resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN))
        return sum(used.ru_utime + used.ru_stime for used in each)

    begun = now()
    work()
    return now() - begun


def seconds(work: Callable[[], object]) -> float:
    """Return how long something takes."""
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
    given = parser.parse_args()
    spaces = TaskSpace(load_domain("tabletop"), LENGTHS)
    (part,) = ordered_parts(spaces, Division.parse(None), seed=0, weights=spaces.weights()).values()

    def validated(draws: int) -> None:
        drawn = (task for _, task in islice(with_tasks(spaces, part.draws()), draws))
        for _ in validate_tasks(drawn, scene_of(spaces.domain), seed=0, workers=given.workers):
            pass

    def one(folder: Path) -> None:
        generate(spaces, folder, tasks=1)

    def whole(folder: Path) -> None:
        generate(spaces, folder, tasks=given.tasks, workers=given.workers)

    with TemporaryDirectory() as made:
        folder = Path(made)
        pairs = []
        validated(given.tasks)  # what is explored and kept once is not measured
        for number in range(given.rounds):
            along = computed(partial(whole, folder / str(number)))
            (note,) = Dataset.open(folder / str(number)).manifest.parts
            alone = computed(partial(validated, note.draws))  # those that are refused take longest
            pairs.append(along / alone)
            say(f"{given.tasks} tasks, seconds computed: {alone:.2f} for verdicts, {along:.2f} in all: {pairs[-1]:.3f}")
        say(f"median ratio {median(pairs):.3f}")
        say(f"of which a data set of one task takes {computed(partial(one, folder / 'one')):.2f} s")
        for tasks in (given.large // 10, given.large):
            done = subprocess.run(
                [sys.executable, "-c", MEASURE, str(folder / f"large{tasks}"), str(tasks)], check=True,
                capture_output=True, text=True,
            )  # fmt: skip
            took, memory = json.loads(done.stdout)
            say(f"{tasks} tasks without physics: {took:.1f} s, {memory:.0f} MB at most")
        last = folder / f"large{given.large}"
        number = 77_777 * given.large // 100_000

        def read() -> None:
            Dataset.open(last).task(number)

        read()
        say(f"opened, task {number} read: {1000 * median(seconds(read) for _ in range(9)):.1f} ms")


if __name__ == "__main__":
    main()
