"""A pipe that makes the kernel kill a process as soon as the process that holds the other end is gone.

Native code may hold the interpreter lock for hours, so that no Python thread runs; it cannot delay a signal from the
kernel. Systems other than Linux have no such signal; there, the process ends when it next reads from its parent.
"""

from __future__ import annotations

import os
import sys
from signal import SIGKILL

OWN_SIGNAL = 10
"""The value of F_SETSIG on Linux; the module `fcntl` defines this constant only since Python 3.11."""


def held_line() -> tuple[int, int]:
    """Return the descriptors of a pipe: the read end for the dependent process, the write end for its keeper."""
    return tuple(map(above_the_standard_ones, os.pipe()))  # type: ignore[return-value]


def hang_on(descriptor: int) -> None:
    """Have the kernel kill this process when the write end is closed; exit at once if it is already closed."""
    os.set_inheritable(descriptor, False)
    if sys.platform == "linux":
        import fcntl  # noqa: PLC0415  not on Windows

        fcntl.fcntl(descriptor, fcntl.F_SETOWN, os.getpid())
        fcntl.fcntl(descriptor, OWN_SIGNAL, SIGKILL)
        fcntl.fcntl(descriptor, fcntl.F_SETFL, os.O_ASYNC | os.O_NONBLOCK)
        try:
            os.read(descriptor, 1)
        except BlockingIOError:
            return
        os._exit(1)


def above_the_standard_ones(descriptor: int) -> int:
    """Return a descriptor, moved above 2 if a closed standard stream has left its number to the descriptor."""
    if descriptor > 2:
        return descriptor
    import fcntl  # noqa: PLC0415

    moved = fcntl.fcntl(descriptor, fcntl.F_DUPFD_CLOEXEC, 3)
    os.close(descriptor)
    return moved
