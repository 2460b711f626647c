"""A call of one function in a separate process with limits on time and memory, for domains from untrusted sources.

The command line has a supervisor for this purpose; this module is for Python programs.
"""

from __future__ import annotations

import pickle
from collections.abc import Callable, Iterator
from time import monotonic
from typing import Any, TypeVar

from prag_asp.errors import LimitReached, QueryError
from prag_asp.processes.machine import family_of, memory_of, usual_memory
from prag_asp.processes.workers import WorkerEnded, WorkerGroup
from prag_asp.stop_reason import LimitCheck, StopKind, StopReason

POLL = 0.05
"""Seconds between two checks of the memory of the process and of `stop`."""

Returned = TypeVar("Returned")


def bounded(
    function: Callable[..., Returned],
    *arguments: Any,
    seconds: float | None = None,
    memory_bytes: int | None = None,
    stop: LimitCheck | None = None,
) -> Returned:
    """Call a function in a separate process, which is killed at a limit or when this process ends; return its value.

    The function is pickled by its module and name, so it must be defined in a module, not in a script or a notebook;
    the arguments and the value are also pickled. `memory_bytes` limits the process and all its descendants together;
    None stands for 80 % of the machine's memory. `stop` may return another reason to end the call.

    Raises:
        LimitReached: the call exceeds a limit, `stop` ends it, or its process dies, for example from a stack overflow.
        QueryError: the function cannot be found by its name.
        Exception: the function raises it.
    """
    if function.__module__ == "__main__" or "<" in function.__qualname__:
        raise QueryError(f"{function.__qualname__}: another process cannot find it; put the function into a module")
    limit, until = memory_bytes or usual_memory(), None if seconds is None else monotonic() + seconds
    with WorkerGroup(__name__) as group:
        try:
            worker = group.start()
            worker.send(pickle.dumps((function, arguments)))
            while True:
                left = POLL if until is None else min(POLL, until - monotonic())
                try:
                    value: Returned = worker.receive(max(left, 0))
                    return value
                except TimeoutError:
                    if until is not None and monotonic() > until:
                        raise
                other = stop() if stop else None
                if other is not None:
                    raise LimitReached(f"{other.prose()} ended the call", 0, other)
                if memory_of(family_of(worker.process.pid)) > limit:
                    raise MemoryError
        except TimeoutError:
            reason = StopReason(StopKind.TIME, seconds)
            raise LimitReached(f"{reason.prose()} was reached; allow more seconds", 0, reason) from None
        except MemoryError:
            reason = StopReason(StopKind.MEMORY, limit)
            raise LimitReached(f"{reason.prose()} was reached; allow more memory_bytes", 0, reason) from None
        except WorkerEnded as ended:
            what = f"the process ended {ended}: too little memory, or too deep a term"
            raise LimitReached(what, 0, StopReason(StopKind.CRASH)) from None


def answers(messages: Iterator[bytes]) -> Iterator[Any]:
    """Answer in the worker: yield the value of each call."""
    for message in messages:
        function, arguments = pickle.loads(message)
        yield function(*arguments)
