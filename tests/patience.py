"""A test that waits for what never comes fails, and tells what it waited for: else nobody would learn which one it was.

It is interrupted where it stands, so that what it cleans up is cleaned up, and the other tests go on.
"""

from __future__ import annotations

import faulthandler
import os
import signal
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from types import FrameType

import pytest

from tests.processes import family

AGAIN = 60.0
"""Seconds after which a test that goes on waiting is interrupted once more."""

DEAF = 300.0
"""Seconds after which one that hears nothing, for foreign code has the interpreter, is ended with its process."""


@contextmanager
def patience(seconds: float, complaints: int) -> Iterator[None]:
    """Let a test take so long, and no longer; where it hears nothing, a file descriptor is told where it stands."""
    if not hasattr(signal, "setitimer"):  # as on Windows
        yield
        return

    def interrupt(number: int, frame: FrameType | None) -> None:
        raise pytest.fail.Exception(f"it has taken {seconds:g} s, and goes on; there are the processes\n{_processes()}")

    usual = signal.signal(signal.SIGALRM, interrupt)
    signal.setitimer(signal.ITIMER_REAL, seconds, AGAIN)
    faulthandler.dump_traceback_later(seconds + DEAF, exit=True, file=complaints)
    try:
        yield
    finally:
        faulthandler.cancel_dump_traceback_later()
        signal.setitimer(signal.ITIMER_REAL, 0)
        signal.signal(signal.SIGALRM, usual)


def _processes() -> str:
    """Return a line for each process that is ours: its number, its state, what of the kernel it is in, its command."""
    lines = []
    for process in family(os.getpid()):
        with suppress(OSError):
            folder = Path("/proc", str(process))
            state = (folder / "stat").read_text().rpartition(")")[2].split()[0]
            command = (folder / "cmdline").read_bytes().replace(b"\0", b" ").decode(errors="replace")
            lines.append(f"{process} {state} {(folder / 'wchan').read_text()} {command[:500]!r}")
    return "\n".join(lines)
