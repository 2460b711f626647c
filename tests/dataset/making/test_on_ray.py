"""Tasks that are looked at on a Ray cluster: two nodes of one processor each, of which one is lost half-way."""

from __future__ import annotations

import os
import subprocess
import sys
import time
from collections.abc import Iterator
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import pytest

from prag_asp import QueryError, TaskSpace, load_domain
from prag_asp.dataset import generate
from prag_asp.dataset.making import executors
from prag_asp.errors import RayMissingError, WorkerError
from prag_asp.missing import require_ray
from tests.commands import PRAG, run
from tests.output.faults import content
from tests.processes import family, gone, interruptible

needs_ray = pytest.mark.skipif(find_spec("ray") is None, reason="Ray is not installed")

NODES = """
import os, sys
from ray.cluster_utils import Cluster
cluster = Cluster()
soon = {"health_check_initial_delay_ms": 500, "health_check_period_ms": 500, "health_check_failure_threshold": 4}
nodes = [cluster.add_node(num_cpus=1, include_dashboard=False, _system_config=config) for config in (soon, None)]
print(cluster.address, flush=True)
for line in sys.stdin:
    cluster.remove_node(nodes[1], allow_graceful=False)
cluster.shutdown()
"""
"""Starts a cluster, prints its address, kills a node for each line of its input, and ends with its input.

The cluster notices within two seconds that a node is lost.
"""


@pytest.fixture
def cluster() -> Iterator[subprocess.Popen[str]]:
    """Start the cluster, in processes that end with the test."""
    process = subprocess.Popen(
        [sys.executable, "-c", NODES], stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL,
        text=True, env={**os.environ, "RAY_USAGE_STATS_ENABLED": "0"},
    )  # fmt: skip
    try:
        yield process
    finally:
        process.communicate(timeout=300)


def test_places_that_there_are_not_are_refused(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    def refused(kind: type[Exception], match: str, **asked: Any) -> None:
        with pytest.raises(kind, match=match):
            generate(TaskSpace(load_domain("kitchen"), [1]), tmp_path / "none", tasks=1, **asked)
        assert not (tmp_path / "none").exists()

    refused(QueryError, "no executor 'moon'; there is ray", on="moon")
    refused(QueryError, "at least 1 worker; got 0", workers=0)
    monkeypatch.setattr(executors, "require_ray", lambda: None)
    refused(QueryError, "a Ray cluster has as many workers as it has processors", on="ray", workers=2)
    monkeypatch.setattr("prag_asp.missing.find_spec", lambda name: None)
    with pytest.raises(RayMissingError, match=r'install it on every node: pip install "prag_asp\[ray\]"'):
        require_ray()


@needs_ray
@pytest.mark.slow
def test_a_node_that_is_lost_half_way_costs_nothing_but_time(
    cluster: subprocess.Popen[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    spaces, tasks = TaskSpace(load_domain("tabletop"), range(2, 4)), 15
    asked: dict[str, Any] = {"tasks": tasks, "seed": 2, "starts": 2, "shard": 6}
    assert cluster.stdin is not None and cluster.stdout is not None
    monkeypatch.setenv("RAY_ADDRESS", cluster.stdout.readline().strip())
    lost: list[int] = []

    def progress(words: str, done: int, total: int) -> None:
        if not lost and done >= tasks // 3:
            lost.append(done)
            assert cluster.stdin is not None
            cluster.stdin.write("lose a node\n")
            cluster.stdin.flush()

    generate(spaces, tmp_path / "ray", on="ray", progress=progress, **asked)
    assert lost
    generate(spaces, tmp_path / "here", workers=2, **asked)
    assert content(tmp_path / "ray") == content(tmp_path / "here")
    assert capfd.readouterr() == ("", "")


@needs_ray
@pytest.mark.slow
def test_ctrl_c_leaves_no_process_of_a_cluster_on_this_machine(tmp_path: Path) -> None:
    command = [*PRAG, "generate", "tabletop", "-n", "3", "--tasks", "100000", "--on", "ray", "-o", "data"]
    with interruptible(command, tmp_path) as running:
        until = time.monotonic() + 300
        journal = tmp_path / "data" / "journal.part"
        while not (journal.exists() and journal.read_bytes().count(b"\n") > 1):  # the first line identifies the request
            assert running.poll() is None and time.monotonic() < until
            time.sleep(0.1)
        processes = family(running.pid)
        assert len(processes) > 4
        os.killpg(running.pid, 2)
        out, err = running.communicate(timeout=300)
        assert (running.returncode, out) == (130, ""), err
        until = time.monotonic() + 300
        while not gone(processes) and time.monotonic() < until:
            time.sleep(0.1)
        assert gone(processes)


@needs_ray
def test_a_cluster_that_is_not_there_is_told_in_one_line(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("RAY_ADDRESS", "127.0.0.1:1")
    with pytest.raises(WorkerError, match=r"no Ray cluster at 127\.0\.0\.1:1: "):
        generate(TaskSpace(load_domain("tabletop"), [1]), tmp_path / "none", tasks=1, on="ray")
    done = run(
        "generate", "tabletop", "-n", "1", "--tasks", "1", "--on", "ray", "--workers", "2", "-o", "x", cwd=tmp_path
    )
    assert done.returncode == 2 and done.stderr.count("\n") == 1
