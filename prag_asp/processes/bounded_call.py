"""One call in a process of its own, which ends at a limit whatever it does: for domains from strangers.

The command has a supervisor for that; this is for Python.
"""

from __future__ import annotations

import pickle
from collections.abc import Callable, Iterator
from time import monotonic
from typing import Any, TypeVar

from prag_asp.errors import LimitReached, QueryError
from prag_asp.processes.machine import family_of, memory_of, usual_memory
from prag_asp.processes.workers import Child, Children, Ended
from prag_asp.stop_reason import StopKind, StopReason

POLL = 0.05
"""Seconds between two looks at what the process takes."""

Returned = TypeVar("Returned")


def bounded(
    function: Callable[..., Returned],
    *arguments: Any,
    seconds: float | None = None,
    memory_bytes: int | None = None,
) -> Returned:
    """Return what a function returns, called in a process of its own that is killed at a limit or with this one.

    The function is found by its module and name, as pickle finds it, so it stands in a module, not in a script or a
    notebook; arguments and what is returned are pickled. Memory is that of the process and of all that it starts; None
    is 80 % of the machine's.

    Raises:
        LimitReached: it takes longer, or more memory, or its process has ended without a word, as by a stack that
            overflows.
        QueryError: the function is found by no name.
        Exception: what the function raises.
    """
    if function.__module__ == "__main__" or "<" in function.__qualname__:
        raise QueryError(f"{function.__qualname__}: another process cannot find it; put the function into a module")
    most, until = memory_bytes or usual_memory(), None if seconds is None else monotonic() + seconds
    with Children(__name__) as children:
        child = children.start()
        try:
            child.send(pickle.dumps((function, arguments)))
            returned: Returned = _awaited(child, until, most)
        except TimeoutError:
            reason = StopReason(StopKind.TIME, seconds)
            raise LimitReached(f"{reason.prose()} was reached; allow more seconds", 0, reason) from None
        except MemoryError:
            reason = StopReason(StopKind.MEMORY, most)
            raise LimitReached(f"{reason.prose()} was reached; allow more memory_bytes", 0, reason) from None
        except Ended as ended:
            what = f"the process ended {ended}: too little memory, or too deep a term"
            raise LimitReached(what, 0, StopReason(StopKind.CRASH)) from None
    return returned


def _awaited(child: Child, until: float | None, most: int) -> Any:
    """Return what a child answers.

    Raises:
        TimeoutError: it has not in time.
        MemoryError: it takes too much memory.
        Ended: it is gone.
    """
    while True:
        left = POLL if until is None else min(POLL, until - monotonic())
        try:
            return child.receive(max(left, 0))
        except TimeoutError:
            if until is not None and monotonic() > until:
                raise
        if memory_of(family_of(child.process.pid)) > most:
            raise MemoryError


def answers(messages: Iterator[bytes]) -> Iterator[Any]:
    """Yield what each call returns: this is what the process does."""
    for message in messages:
        function, arguments = pickle.loads(message)
        yield function(*arguments)
