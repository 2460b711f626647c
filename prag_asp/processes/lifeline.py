"""A line between two processes: where the one that holds it ends, in whatever way, the kernel ends the other at once.

Foreign code may keep the interpreter for hours, so that no thread of ours runs; the kernel, it cannot keep off.
Elsewhere than on Linux there is no such line, and a process ends when it next looks.
"""

from __future__ import annotations

import os
import sys
from signal import SIGKILL

OWN_SIGNAL = 10
"""What Linux calls F_SETSIG, which Python has no name for before 3.11."""


def held_line() -> tuple[int, int]:
    """Return two descriptors: for the process that hangs on the line, and for the one that holds it to its end."""
    return tuple(map(above_the_standard_ones, os.pipe()))  # type: ignore[return-value]


def hang_on(descriptor: int) -> None:
    """End this process when the line is let go, by SIGKILL; at once where it is already."""
    os.set_inheritable(descriptor, False)
    if sys.platform == "linux":
        import fcntl  # noqa: PLC0415  there is none on Windows

        fcntl.fcntl(descriptor, fcntl.F_SETOWN, os.getpid())
        fcntl.fcntl(descriptor, OWN_SIGNAL, SIGKILL)
        fcntl.fcntl(descriptor, fcntl.F_SETFL, os.O_ASYNC | os.O_NONBLOCK)
        try:
            os.read(descriptor, 1)
        except BlockingIOError:
            return
        os._exit(1)


def above_the_standard_ones(descriptor: int) -> int:
    """Return the same with a number above 2: where a standard stream is closed, a new descriptor takes its place."""
    if descriptor > 2:
        return descriptor
    import fcntl  # noqa: PLC0415

    moved = fcntl.fcntl(descriptor, fcntl.F_DUPFD_CLOEXEC, 3)
    os.close(descriptor)
    return moved
