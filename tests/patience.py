"""A test that waits for what never comes fails, and tells what it waited for: else nobody would learn which one it was.

It is interrupted where it stands, so that what it cleans up is cleaned up, and the other tests go on. A machine that is
suspended for a while is no fault of a test: its clock then jumps, and the jump does not count.
"""

from __future__ import annotations

import faulthandler
import os
import signal
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from time import monotonic
from types import FrameType

import pytest

from tests.processes import family

TICK = 30.0
"""Seconds between two looks at the clock; between them at most twice as many count."""

AGAIN = 60.0
"""Seconds after which a test that goes on waiting is interrupted once more."""

DEAF = 3600.0
"""Seconds after which one that hears nothing, for foreign code has the interpreter, is ended with its process.

A jump of the clock cannot be told from that, so it is longer than most jumps.
"""


class Patience:
    """The seconds that a test may still take, and whether the clock has jumped."""

    def __init__(self, seconds: float) -> None:
        self.left, self.jumped = seconds, False
        self._seen = monotonic()

    def look(self) -> None:
        """Count the time since the last look."""
        now = monotonic()
        elapsed, self._seen = now - self._seen, now
        self.jumped |= elapsed > 2 * TICK
        self.left -= min(elapsed, 2 * TICK)


@contextmanager
def patience(seconds: float, complaints: int) -> Iterator[Patience]:
    """Let a test take so long, and no longer; where it hears nothing, a file descriptor is told where it stands."""
    given = Patience(seconds)
    if not hasattr(signal, "setitimer"):  # as on Windows
        yield given
        return

    def tick(number: int, frame: FrameType | None) -> None:
        given.look()
        faulthandler.dump_traceback_later(TICK + DEAF, exit=True, file=complaints)
        if given.left <= 0:
            given.left = AGAIN
            raise pytest.fail.Exception(
                f"it has taken {seconds:g} s, and goes on; there are the processes\n{_processes()}"
            )

    first = min(TICK, seconds)
    usual = signal.signal(signal.SIGALRM, tick)
    signal.setitimer(signal.ITIMER_REAL, first, TICK)
    faulthandler.dump_traceback_later(first + DEAF, exit=True, file=complaints)
    try:
        yield given
    finally:
        faulthandler.cancel_dump_traceback_later()
        signal.setitimer(signal.ITIMER_REAL, 0)
        signal.signal(signal.SIGALRM, usual)
        given.look()


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
