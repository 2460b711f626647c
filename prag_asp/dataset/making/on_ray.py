"""Draws that are looked at on the nodes of a Ray cluster, as Ray tasks over some draws in a row.

A node that is lost costs what was done on it: Ray does its tasks again elsewhere. What is found comes back in the order
of the draws. A process of its own talks to Ray, so that nothing of Ray's reaches ours: neither threads, nor handlers of
signals, nor what it prints; and whatever ends ours ends that, and with it what the cluster does for it.
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

from prag_asp.dataset.validation_jobs import Draw, Found, Look, telling_looker
from prag_asp.errors import WorkerError
from prag_asp.processes.progress_events import stage
from prag_asp.processes.workers import Worker, WorkerEnded, WorkerGroup, uninterrupted

AHEAD = 2
"""Tasks of Ray for each processor that are handed out: the one that it does, and one that it need not wait for."""

SECONDS = 0.5
"""How long a task of Ray is to take, about: much longer than it takes to hand it out, and soon done again.

When the last tasks are done, some processors have nothing to do, for so long at most.
"""

LARGEST, GROWTH = 512, 2
"""Draws of a task of Ray at most, and by how much these grow at once."""

LOST = 20
"""How often a task of Ray is done again whose node was lost."""

PARTING = 10.0
"""Seconds that Ray has to end what it does for us."""

PATIENCE = 60.0
"""Seconds to wait for a first processor of a cluster."""

QUIET = {"RAY_USAGE_STATS_ENABLED": "0", "RAY_ACCEL_ENV_VAR_OVERRIDE_ON_ZERO": "0"}
"""What keeps Ray from telling others of its use."""


@dataclass(frozen=True)
class Cluster:
    """The cluster that ``RAY_ADDRESS`` names, or this machine as one."""

    tells: bool = True

    def look(self, draws: Iterator[Draw], look: Look) -> Generator[Found, None, None]:
        """Yield what is known of draws, in their order; closing the iterator ends the work at once.

        Raises:
            SceneError: a task speaks of something for which the scene has no shape.
            WorkerError: there is no cluster, or nodes were lost again and again.
        """
        from prag_asp.dataset.store.columns import Row, unpacked

        stage("looking at tasks on the cluster")
        with WorkerGroup(__name__, stderr=subprocess.DEVNULL) as children:
            try:
                talker = children.start()
                try:
                    talker.send(look)
                    while (answer := talker.receive()) is not None:
                        if isinstance(answer, int):
                            talker.send(list(islice(draws, answer)))
                        else:
                            every, rows = pickle.loads(answer)
                            table = unpacked(rows)
                            yield from (each._replace(row=Row(table, place)) for place, each in enumerate(every))
                finally:
                    with uninterrupted():
                        _let_go(talker)
            except WorkerEnded as ended:
                told = f"the process that talks to Ray ended {ended}; is there enough memory? Run it again"
                raise WorkerError(told) from None


def _let_go(talker: Worker) -> None:
    """Have Ray end all that it does for us, as it does when it is asked to; otherwise a cluster here leaves agents."""
    talker.process.terminate()
    with suppress(subprocess.TimeoutExpired):
        talker.process.wait(PARTING)


def answers(messages: Iterator[Any]) -> Iterator[int | bytes | None]:
    """Yield how many draws are wanted, and get them, fewer where there are no more; yield what is known of some.

    That passes through as the node has pickled it: a list of `Found`, and their rows.

    First of all comes how they are looked at; None comes last.

    Raises:
        SceneError: as `Cluster.look` does.
        WorkerError: so, too.
    """
    import ray

    _begin(ray)
    look = ray.put(next(messages))
    run, size, more = os.urandom(8).hex(), 1, True
    remote = ray.remote(looked_at).options(num_cpus=1, max_retries=LOST)
    waiting: deque[tuple[Any, int]] = deque()
    while more or waiting:
        room = AHEAD * _processors(ray) - len(waiting)
        if more and room > 0:
            yield room * size
            draws = next(messages)
            more = len(draws) == room * size
            groups = [draws[first : first + size] for first in range(0, len(draws), size)]
            waiting.extend((remote.remote(run, look, group), len(group)) for group in groups)
            continue
        reference, number = waiting.popleft()
        found, seconds = _answer(ray, reference)
        right = int(number * SECONDS / max(seconds, 1e-6))
        size = max(1, min(right, GROWTH * max(number, size), LARGEST))
        yield found
    yield None


def _begin(ray: Any) -> None:
    """Connect to the cluster of ``RAY_ADDRESS``, or begin one on this machine.

    Raises:
        WorkerError: there is none at the address.
    """
    os.environ.update(QUIET)
    address = os.environ.get("RAY_ADDRESS") or "local"
    own = {"include_dashboard": False} if address == "local" else {}
    try:
        _knock(address)
        ray.init(address=address, log_to_driver=False, **own)
    except Exception as error:  # Ray has no error of its own for that
        raise WorkerError(f"no Ray cluster at {address}: {_line(error)}; see RAY_ADDRESS") from None


def _knock(address: str) -> None:
    """Connect to HOST:PORT at once: Ray tries for minutes.

    Raises:
        OSError: nobody is there.
    """
    found = re.fullmatch(r"\[?([^/\[\]]+)\]?:([0-9]{1,5})", address)
    if found is not None:
        socket.create_connection((found[1], int(found[2])), timeout=PATIENCE).close()


def _processors(ray: Any) -> int:
    """Return how many processors the cluster has now; wait for a first one.

    Raises:
        WorkerError: none comes.
    """
    until = monotonic() + PATIENCE
    while not (found := int(ray.cluster_resources().get("CPU", 0))):
        if monotonic() > until:
            raise WorkerError("the Ray cluster has no processor; start a node of it: ray start --address=HOST:PORT")
        sleep(0.5)
    return found


def _answer(ray: Any, reference: Any) -> tuple[bytes, float]:
    """Return what a task of Ray has found, pickled, and how long that took.

    Raises:
        WorkerError: Ray has given it up.
        Exception: this was met there.
    """
    try:
        found, error, seconds = ray.get(reference)
    except ray.exceptions.RayError as failure:
        raise WorkerError(f"the Ray cluster gave tasks up: {_line(failure)}; see its nodes, and run it again") from None
    if error is not None:
        raise error
    return found, seconds


def _line(error: BaseException) -> str:
    """Return the first line that an error says."""
    return (str(error).strip() or type(error).__name__).splitlines()[0]


@dataclass
class _Kept:
    """What a process of Ray keeps from one task to the next of the same run."""

    run: str = ""
    look: Any = None
    resources: ExitStack = field(default_factory=ExitStack)


_KEPT = _Kept()


def looked_at(run: str, look: Look, draws: list[Draw]) -> tuple[bytes, Exception | None, float]:
    """Return what is known of draws, pickled, or the error that was met, and how many seconds it took.

    This is run on a node.
    """
    begun = monotonic()
    try:
        if _KEPT.run != run:
            _KEPT.resources.close()
            _KEPT.run, _KEPT.resources = "", ExitStack()
            assert look.telling is not None
            _KEPT.look, _KEPT.run = _KEPT.resources.enter_context(telling_looker(look, look.telling)), run
            begun = monotonic()
        return pickle.dumps(_KEPT.look(draws)), None, monotonic() - begun
    except Exception as error:
        return b"", error, monotonic() - begun
