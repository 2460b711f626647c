"""PyBullet, loaded where it is first used; what its C++ prints is kept off standard output, where results go."""

from __future__ import annotations

import ctypes
import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager

from prag_asp.missing import needed

STDOUT, STDERR = 1, 2


@contextmanager
def silenced(*descriptors: int) -> Iterator[None]:
    """Send what is written to file descriptors to nowhere, buffered output of C included."""
    flush()
    saved = [(descriptor, os.dup(descriptor)) for descriptor in descriptors]
    try:
        for descriptor in descriptors:
            silence(descriptor)
        yield
        flush()
    finally:
        for descriptor, copy in saved:
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
