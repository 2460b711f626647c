"""The speed-up of dataset generation with two single-processor Ray nodes, and the processor time of the driver.

``python benchmarks/nodes.py [--tasks 2000] [--rounds 2]`` starts clusters on this machine and samples tasks
of `tabletop`, lengths 3-6. Each cluster first validates some tasks, so that start-up is not measured. All nodes share
the processors of this machine, which must otherwise be idle.
"""

from __future__ import annotations

import argparse
import os
import resource
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from statistics import median
from tempfile import TemporaryDirectory

from prag_asp import TaskSpace, load_domain
from prag_asp.dataset import generate

NODES = """
import sys
from ray.cluster_utils import Cluster
cluster = Cluster()
cluster.add_node(num_cpus=0)
for _ in range(int(sys.argv[1])):
    cluster.add_node(num_cpus=1)
print(cluster.address, flush=True)
sys.stdin.read()
cluster.shutdown()
"""
"""A program that starts a cluster, prints its address, and stops at the end of its input."""

WARM = 200
"""The number of tasks that a cluster validates before it is measured."""


@contextmanager
def cluster(nodes: int) -> Iterator[None]:
    """Run a cluster of `nodes` single-processor nodes and a head node."""
    process = subprocess.Popen(
        [sys.executable, "-c", NODES, str(nodes)], stdin=subprocess.PIPE, stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL, text=True,
    )  # fmt: skip
    try:
        assert process.stdout is not None
        address = process.stdout.readline().strip()
        if not address:
            raise SystemExit("no cluster has started; install the extra ray: pip install 'prag-asp[ray]'")
        os.environ["RAY_ADDRESS"] = address
        yield
    finally:
        os.environ.pop("RAY_ADDRESS", None)
        process.communicate()


def computed() -> float:
    """Return the processor seconds of this process and of its Ray client."""
    each = (resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN))
    return sum(used.ru_utime + used.ru_stime for used in each)


def measured(nodes: int, tasks: int) -> tuple[float, float]:
    """Return the wall-clock seconds of generating `tasks` on `nodes` nodes, and the processor seconds of the driver.

    They are differences of two runs, because each run has fixed costs: it connects to Ray and renders pictures.
    """
    spaces = TaskSpace(load_domain("tabletop"), range(3, 7))
    with TemporaryDirectory() as folder, cluster(nodes):
        durations = []
        for name, number in (("warm", WARM), ("few", WARM), ("many", WARM + tasks)):
            begun, before = time.perf_counter(), computed()
            generate(spaces, Path(folder) / name, tasks=number, on="ray")
            durations.append((time.perf_counter() - begun, computed() - before))
    (_, (few, little), (many, much)) = durations
    return many - few, much - little


def positive(text: str) -> int:
    """Return a text as a number of at least 1."""
    number = int(text)
    if number < 1:
        raise argparse.ArgumentTypeError(f"{text} is less than 1")
    return number


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--tasks", type=positive, default=2000)
    parser.add_argument("--rounds", type=positive, default=2)
    options = parser.parse_args()
    ratios = []
    for _ in range(options.rounds):
        (one, here), (two, there) = measured(1, options.tasks), measured(2, options.tasks)
        ratios.append(one / two)
        line = f"{options.tasks} tasks: {one:.1f} s on one node, {two:.1f} s on two: speed-up {one / two:.2f}; "
        driver = f"{1000 * here / options.tasks:.2f} and {1000 * there / options.tasks:.2f}"
        line += f"driver {driver} ms of processor time a task\n"
        sys.stdout.write(line)
        sys.stdout.flush()
    sys.stdout.write(f"median {median(ratios):.2f}\n")


if __name__ == "__main__":
    main()
