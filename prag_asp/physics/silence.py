"""Keep what PyBullet's C++ prints off standard output, where results go."""

from __future__ import annotations

import ctypes
import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager

STDOUT = 1


@contextmanager
def silent_stdout() -> Iterator[None]:
    """Send whatever is written to file descriptor 1 to nowhere, buffered output of C included."""
    flush()
    saved = os.dup(STDOUT)
    try:
        silence_stdout()
        yield
        flush()
    finally:
        os.dup2(saved, STDOUT)
        os.close(saved)


def silence_stdout() -> None:
    """Send file descriptor 1 to nowhere, for the rest of the process."""
    nowhere = os.open(os.devnull, os.O_WRONLY)
    os.dup2(nowhere, STDOUT)
    os.close(nowhere)


def flush() -> None:
    """Write out what Python and C still hold for standard output."""
    if sys.stdout is not None and not sys.stdout.closed:
        sys.stdout.flush()
    ctypes.CDLL(None).fflush(None)
