"""Load PyBullet on first use, and keep its C++ output off standard output, which is for results."""

from __future__ import annotations

import ctypes
import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from threading import Lock

from prag_asp.missing import needed

STDOUT, STDERR = 1, 2

_LOCK = Lock()
_MUTED: dict[int, tuple[int, int]] = {}
"""For each muted descriptor, the number of contexts that mute it, and a duplicate of the original.

Threads mute concurrently. If each thread saved the descriptor that it found, the last thread to leave would restore the
null device.
"""


@contextmanager
def mute_output(*descriptors: int) -> Iterator[None]:
    """Discard what the body of the context writes to the given file descriptors, including output buffered by C."""
    flush()
    for descriptor in descriptors:
        with _LOCK:
            users, copy = _MUTED.get(descriptor) or (0, os.dup(descriptor))
            if not users:
                redirect_to_null(descriptor)
            _MUTED[descriptor] = users + 1, copy
    try:
        yield
        flush()
    finally:
        for descriptor in descriptors:
            with _LOCK:
                users, copy = _MUTED.pop(descriptor)
                if users > 1:
                    _MUTED[descriptor] = users - 1, copy
                else:
                    os.dup2(copy, descriptor)
                    os.close(copy)


def redirect_to_null(descriptor: int) -> None:
    """Discard output to a file descriptor for the rest of the process."""
    nowhere = os.open(os.devnull, os.O_WRONLY)
    os.dup2(nowhere, descriptor)
    os.close(nowhere)


def flush() -> None:
    """Flush the buffers of Python and C for standard output and standard error."""
    for stream in (sys.stdout, sys.stderr):
        if stream is not None and not stream.closed:
            stream.flush()
    ctypes.CDLL(None).fflush(None)


with mute_output(STDOUT, STDERR):
    pybullet, pybullet_data = needed("pybullet"), needed("pybullet_data")

__all__ = ["pybullet", "pybullet_data"]
