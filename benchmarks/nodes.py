"""How much sooner two nodes of a Ray cluster of one processor each make a data set than one, and what is computed here.

``python benchmarks/nodes.py [--tasks 2000] [--rounds 2]`` starts clusters on this machine and draws tasks of
`tabletop`, lengths 3-6. Each cluster looks at some tasks first: what its processes load once is not measured. All
share the processors of this machine, so two nodes need a machine with nothing else to do.
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
"""Starts a cluster, says where, and ends with its input."""

WARM = 200
"""Tasks that a cluster looks at before it is measured."""


@contextmanager
def cluster(nodes: int) -> Iterator[None]:
    """Have a cluster of so many nodes of one processor, beside one for what manages it."""
    process = subprocess.Popen(
        [sys.executable, "-c", NODES, str(nodes)], stdin=subprocess.PIPE, stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL, text=True,
    )  # fmt: skip
    try:
        assert process.stdout is not None
        address = process.stdout.readline().strip()
        if not address:
            raise SystemExit("no cluster has started; install the extra: pip install 'prag-asp[ray]'")
        os.environ["RAY_ADDRESS"] = address
        yield
    finally:
        os.environ.pop("RAY_ADDRESS", None)
        process.communicate()


def computed() -> float:
    """Return how many seconds this process, and that which talks to Ray for it, have computed."""
    each = (resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN))
    return sum(used.ru_utime + used.ru_stime for used in each)


def measured(nodes: int, tasks: int) -> tuple[float, float]:
    """Return the seconds that a data set takes on so many nodes, and those that are computed here for it.

    What two data sets take that differ in `tasks` alone is subtracted: each run connects and draws pictures.
    """
    spaces = TaskSpace(load_domain("tabletop"), range(3, 7))
    with TemporaryDirectory() as made, cluster(nodes):
        took = []
        for name, wanted in (("warm", WARM), ("few", WARM), ("many", WARM + tasks)):
            begun, before = time.perf_counter(), computed()
            generate(spaces, Path(made) / name, tasks=wanted, on="ray")
            took.append((time.perf_counter() - begun, computed() - before))
    (_, (few, little), (many, much)) = took
    return many - few, much - little


def positive(text: str) -> int:
    """Return a number of one or more."""
    number = int(text)
    if number < 1:
        raise argparse.ArgumentTypeError(f"{text} is less than 1")
    return number


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--tasks", type=positive, default=2000)
    parser.add_argument("--rounds", type=positive, default=2)
    given = parser.parse_args()
    ratios = []
    for _ in range(given.rounds):
        (one, here), (two, there) = measured(1, given.tasks), measured(2, given.tasks)
        ratios.append(one / two)
        line = f"{given.tasks} tasks: {one:.1f} s on one node, {two:.1f} s on two: {one / two:.2f} times as fast; "
        line += f"computed here {1000 * here / given.tasks:.2f} and {1000 * there / given.tasks:.2f} ms a task\n"
        sys.stdout.write(line)
        sys.stdout.flush()
    sys.stdout.write(f"median {median(ratios):.2f}\n")


if __name__ == "__main__":
    main()
