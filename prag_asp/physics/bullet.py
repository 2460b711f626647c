"""PyBullet, loaded where it is first used; what its C++ prints is kept off standard output, where results go."""

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
"""Of each descriptor that is silent: how many want it so, and a copy of where it led.

Threads silence at once: were each to keep what it found, the last to end would keep nowhere.
"""


@contextmanager
def silenced(*descriptors: int) -> Iterator[None]:
    """Send what is written to file descriptors to nowhere, buffered output of C included."""
    flush()
    for descriptor in descriptors:
        _mute(descriptor)
    try:
        yield
        flush()
    finally:
        for descriptor in descriptors:
            _unmute(descriptor)


def _mute(descriptor: int) -> None:
    """Silence a file descriptor, unless that is so already, for this thread or another one."""
    with _LOCK:
        users, copy = _MUTED.get(descriptor) or (0, os.dup(descriptor))
        if not users:
            silence(descriptor)
        _MUTED[descriptor] = users + 1, copy


def _unmute(descriptor: int) -> None:
    """Give a file descriptor its voice back where nobody else needs it silent."""
    with _LOCK:
        users, copy = _MUTED.pop(descriptor)
        if users > 1:
            _MUTED[descriptor] = users - 1, copy
        else:
            os.dup2(copy, descriptor)
            os.close(copy)


def silence(descriptor: int) -> None:
    """Send what is written to a file descriptor to nowhere, for the rest of the process."""
    nowhere = os.open(os.devnull, os.O_WRONLY)
    os.dup2(nowhere, descriptor)
    os.close(nowhere)


def flush() -> None:
    """Write out what Python and C still hold for standard output and standard error."""
    for stream in (sys.stdout, sys.stderr):
        if stream is not None and not stream.closed:
            stream.flush()
    ctypes.CDLL(None).fflush(None)


with silenced(STDOUT, STDERR):
    pybullet, pybullet_data = needed("pybullet"), needed("pybullet_data")

__all__ = ["pybullet", "pybullet_data"]
