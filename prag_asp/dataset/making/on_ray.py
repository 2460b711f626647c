"""Validate draws on the nodes of a Ray cluster, as Ray tasks over consecutive draws.

If a node is lost, Ray repeats its tasks elsewhere. Results come back in the order of the draws. A separate process, the
client, talks to Ray, so that its threads, signal handlers and output do not affect this process; when this process
ends, the client and the work on the cluster end too.
"""

from __future__ import annotations

import os
import pickle
import re
import socket
import subprocess
from collections import deque
from collections.abc import Generator, Iterator
from contextlib import ExitStack, suppress
from dataclasses import dataclass, field
from itertools import islice
from time import monotonic, sleep
from typing import Any

from prag_asp.dataset.validation_jobs import JobResult, ValidationJob, ValidationSetup, open_draw_validator
from prag_asp.errors import WorkerError
from prag_asp.processes.progress_events import stage
from prag_asp.processes.workers import WorkerEnded, WorkerGroup, uninterrupted

AHEAD = 2
"""The number of Ray tasks submitted per processor: one running and one waiting, so that no processor is idle."""

SECONDS = 0.5
"""The intended duration of a Ray task in seconds: much longer than its submission, yet cheap to repeat.

While the last tasks run, some processors are idle, but for no longer than this.
"""

LARGEST, GROWTH = 512, 2
"""The maximum number of draws in a Ray task, and the maximum factor by which this number grows from task to task."""

LOST = 20
"""The number of retries of a Ray task whose node was lost."""

PARTING = 10.0
"""The time in seconds within which Ray has to end its processes."""

POLL = 0.5
"""The time in seconds between two queries for the processors of a cluster."""

PATIENCE = 60.0
"""The time limit in seconds for a connection to a cluster, and for its first processor."""

QUIET = {"RAY_USAGE_STATS_ENABLED": "0", "RAY_ACCEL_ENV_VAR_OVERRIDE_ON_ZERO": "0"}
"""Environment variables that disable Ray's usage statistics."""


@dataclass(frozen=True)
class RayExecutor:
    """An executor on the cluster that ``RAY_ADDRESS`` names, or on this machine as a cluster."""

    captions: bool = True

    def run(self, jobs: Iterator[ValidationJob], setup: ValidationSetup) -> Generator[JobResult, None, None]:
        """Yield the results of jobs in order; closing the iterator ends the work at once.

        Raises:
            SceneError: the scene lacks the shape of an entity in a task.
            WorkerError: there is no cluster, or nodes were lost repeatedly.
        """
        from prag_asp.dataset.store.columns import RowReference, unpacked

        stage("validating tasks on the cluster")
        with WorkerGroup(__name__, stderr=subprocess.DEVNULL) as children:
            try:
                client = children.start()
                try:
                    client.send(setup)
                    while (answer := client.receive()) is not None:
                        if isinstance(answer, int):
                            client.send(list(islice(jobs, answer)))
                        else:
                            results, rows = pickle.loads(answer)
                            table = unpacked(rows)
                            yield from (
                                each._replace(row=RowReference(table, place)) for place, each in enumerate(results)
                            )
                finally:
                    with uninterrupted(), suppress(subprocess.TimeoutExpired):
                        client.process.terminate()  # a kill would leave agents of a local cluster behind
                        client.process.wait(PARTING)
            except WorkerEnded as ended:
                message = f"the process that talks to Ray ended {ended}; is there enough memory? Run it again"
                raise WorkerError(message) from None


def answers(messages: Iterator[Any]) -> Iterator[int | bytes | None]:
    """Yield numbers of jobs that the cluster can accept, and pickled results of jobs; None comes last.

    The first message is the `ValidationSetup`; each number is answered with that many jobs, or fewer at the end. A
    result is a list of `JobResult` and their rows, as pickled on the node.

    Raises:
        SceneError: as for `RayExecutor.run`.
        WorkerError: as for `RayExecutor.run`.
    """
    import ray

    _begin(ray)
    setup = ray.put(next(messages))
    run, size, more = os.urandom(8).hex(), 1, True
    remote = ray.remote(validated).options(num_cpus=1, max_retries=LOST)
    waiting: deque[tuple[Any, int]] = deque()
    while more or waiting:
        room = AHEAD * _processors(ray) - len(waiting)
        if more and room > 0:
            yield room * size
            draws = next(messages)
            more = len(draws) == room * size
            groups = [draws[first : first + size] for first in range(0, len(draws), size)]
            waiting.extend((remote.remote(run, setup, group), len(group)) for group in groups)
            continue
        reference, number = waiting.popleft()
        try:
            results, error, seconds = ray.get(reference)
        except ray.exceptions.RayError as failure:
            problem = f"the Ray cluster gave up tasks: {_line(failure)}"
            raise WorkerError(f"{problem}; check its nodes, and run the command again") from None
        if error is not None:
            raise error
        target = int(number * SECONDS / max(seconds, 1e-6))
        size = max(1, min(target, GROWTH * max(number, size), LARGEST))
        yield results
    yield None


def _begin(ray: Any) -> None:
    """Connect to the cluster that ``RAY_ADDRESS`` names, or start one on this machine."""
    os.environ.update(QUIET)
    address = os.environ.get("RAY_ADDRESS") or "local"
    options = {"include_dashboard": False} if address == "local" else {}
    try:
        place = re.fullmatch(r"\[?([^/\[\]]+)\]?:([0-9]{1,5})", address)
        if place is not None:  # Ray itself would retry for minutes if nothing listens there
            socket.create_connection((place[1], int(place[2])), timeout=PATIENCE).close()
        ray.init(address=address, log_to_driver=False, **options)
    except Exception as error:  # Ray has no common error class for this
        remedy = "check RAY_ADDRESS and, if the cluster requires a token, RAY_AUTH_TOKEN on all nodes and in this run"
        raise WorkerError(f"no Ray cluster at {address}: {_line(error)}; {remedy}") from None


def _processors(ray: Any) -> int:
    """Return the number of processors in the cluster, after waiting for the first one."""
    until = monotonic() + PATIENCE
    while not (number := int(ray.cluster_resources().get("CPU", 0))):
        if monotonic() > until:
            raise WorkerError("the Ray cluster has no processor; start a node: ray start --address=HOST:PORT")
        sleep(POLL)
    return number


def _line(error: BaseException) -> str:
    """Return the first line of an error's message."""
    return (str(error).strip() or type(error).__name__).splitlines()[0]


@dataclass
class _NodeState:
    """The state that a Ray process keeps between tasks of the same run."""

    run: str = ""
    validate: Any = None
    resources: ExitStack = field(default_factory=ExitStack)


_NODE = _NodeState()


def validated(run: str, setup: ValidationSetup, jobs: list[ValidationJob]) -> tuple[bytes, Exception | None, float]:
    """Return the pickled results of jobs, the error that was raised, if any, and the duration in s; runs on a node."""
    begun = monotonic()
    try:
        if _NODE.run != run:
            _NODE.resources.close()
            _NODE.run, _NODE.resources = "", ExitStack()
            _NODE.validate, _NODE.run = _NODE.resources.enter_context(open_draw_validator(setup)), run
            begun = monotonic()
        return pickle.dumps(_NODE.validate(jobs)), None, monotonic() - begun
    except Exception as error:
        return b"", error, monotonic() - begun
