"""Processes that tests interrupt."""

from __future__ import annotations

import os
import signal
import subprocess
import time
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path


@contextmanager
def interruptible(command: Sequence[str], cwd: Path) -> Iterator[subprocess.Popen[str]]:
    """Start a command in a session of its own that hears SIGINT, even where the tests run in the background.

    Whatever is left of the session is killed afterwards.
    """
    heard = signal.signal(signal.SIGINT, signal.default_int_handler)
    try:
        process = subprocess.Popen(
            command, cwd=cwd, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, start_new_session=True
        )
    finally:
        signal.signal(signal.SIGINT, heard)
    try:
        yield process
    finally:
        with suppress(ProcessLookupError):
            os.killpg(process.pid, signal.SIGKILL)
        process.communicate()


def interrupt(process: subprocess.Popen[str]) -> str:
    """Press Ctrl-C, and return what the process then says on stderr."""
    os.killpg(process.pid, signal.SIGINT)
    return process.communicate(timeout=300)[1]


def terminate(process: subprocess.Popen[str]) -> str:
    """Ask a process alone to end, as `kill` does, and return what it then says on stderr."""
    process.terminate()
    return process.communicate(timeout=300)[1]


def until_it_works(process: subprocess.Popen[str], output: Path | None = None, seconds: float = 2.0) -> None:
    """Wait until a process has written to a file or, without one, has computed for some seconds with its children.

    That takes as long as it takes on a busy machine, but at most five minutes.
    """
    latest = time.monotonic() + 300
    while process.poll() is None and time.monotonic() < latest:
        if output is not None and output.exists() and output.stat().st_size:
            return
        if output is None and sum(map(computed, family(process.pid))) > seconds:
            return
        time.sleep(0.05)


def computed(pid: int) -> float:
    """Return for how many seconds a process has computed; one that is gone has not."""
    try:
        text = Path(f"/proc/{pid}/stat").read_text()
    except (FileNotFoundError, ProcessLookupError):
        return 0.0
    user, system = text.rpartition(")")[2].split()[11:13]
    return (int(user) + int(system)) / os.sysconf("SC_CLK_TCK")


def children(of: int | str = "self") -> list[int]:
    """Return the processes that a process has started and not seen end."""
    found: list[int] = []
    for thread in Path(f"/proc/{of}/task").iterdir():
        with suppress(FileNotFoundError, ProcessLookupError):  # Threads end meanwhile.
            found += map(int, (thread / "children").read_text().split())
    return found


def family(of: int) -> list[int]:
    """Return a process and all that were started by it or by one that it has started."""
    found = [of]
    for process in found:
        with suppress(FileNotFoundError, ProcessLookupError):
            found += children(process)
    return found


def workers(command: int) -> list[int]:
    """Return what a command has started, without itself and the supervisor that it was started as."""
    return family(command)[2:]


def gone(processes: Iterable[int], seconds: float = 120) -> bool:
    """Wait until processes have ended, for so long at most, and tell whether they have."""
    until = time.monotonic() + seconds
    while (left := any(map(_runs, processes))) and time.monotonic() < until:
        time.sleep(0.02)
    return not left


def _runs(process: int) -> bool:
    """Tell whether a process does anything still; one that nobody has seen end is a zombie, and does not."""
    try:
        return Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()[0] != "Z"
    except (FileNotFoundError, ProcessLookupError):
        return False
