"""Run a command in a process of its own, with limits on time and memory, without paying for its start each time.

What the commands import is imported once; then each run is a fork of that process: it shares pages that are never
written to, and nothing else. A run leads a group of processes and is ended with all of it.
"""

from __future__ import annotations

import contextlib
import gc
import importlib
import os
import pkgutil
import resource
import select
import signal
import sys
import traceback
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryFile
from time import monotonic, sleep
from typing import NoReturn

GRACE = 2.0
"""Seconds that processes of a command's own may outlive it."""

BUSY = 100
"""So many tenths of the time that a command may take it gets more, where the machine has had no time for it."""

LONGEST_OUTPUT = 1 << 22
"""Bytes of what a command says that are read."""


@dataclass(frozen=True)
class Limits:
    """What one command may take: seconds, and bytes of memory beyond what every process begins with."""

    seconds: float = 20.0
    memory_bytes: int = 2 * 10**9


@dataclass(frozen=True)
class Ran:
    """What became of a command: `code` is negative where a signal ended it, `outlived` is whether a child did not."""

    code: int
    out: bytes
    err: bytes
    seconds: float
    peak_bytes: int
    hung: bool = False
    outlived: bool = False


NOT_EVERYWHERE = {
    "prag_asp.dataset.formats.rerun",
    "prag_asp.evaluation.lerobot_env",
    "prag_asp.evaluation.vla_eval_benchmark",
}
"""The modules of packages that are not installed everywhere."""


def warm() -> None:
    """Import whatever the commands may need, as quietly as they do."""
    import prag_asp
    from prag_asp.physics.bullet import pybullet  # noqa: F401 - says nothing by way of this module

    for module in pkgutil.walk_packages(prag_asp.__path__, "prag_asp."):
        if not module.name.endswith("__main__") and module.name not in NOT_EVERYWHERE:
            importlib.import_module(module.name)
    for name in (
        "numpy.lib.format",
        "PIL.Image",
        "PIL.GifImagePlugin",
        "PIL.PngImagePlugin",
        "pysat.solvers",
        "rich.table",
        "rich.console",
        "frankik",
    ):
        with contextlib.suppress(ImportError):
            importlib.import_module(name)
    prag_asp.load_domain("prag")  # what the encodings say is read once as well
    gc.collect()
    gc.freeze()  # else the first search for garbage of each run would write to all pages


def command(arguments: tuple[str, ...]) -> Callable[[], None]:
    """Return what runs a command line of ``prag-asp``."""

    def run() -> None:
        from prag_asp.cli import main

        sys.argv = ["prag-asp", *arguments]
        main()

    return run


def run(
    work: Callable[[], None],
    folder: Path,
    limits: Limits,
    given: bytes = b"",
    variables: Mapping[str, str] | None = None,
) -> Ran:
    """Run something in a process of its own that stands in a folder."""
    with TemporaryFile() as out, TemporaryFile() as err, TemporaryFile() as stdin:
        stdin.write(given)
        stdin.seek(0)
        begun = monotonic()
        child = os.fork()
        if child == 0:
            _become(work, folder, limits, (stdin.fileno(), out.fileno(), err.fileno()), variables or {})
        hung = not _ended(child, limits.seconds)
        seconds = monotonic() - begun
        if hung:
            _end_group(child)
        _, status, usage = os.wait4(child, 0)
        outlived = _outlived(child)
        _end_group(child)
        out.seek(0)
        err.seek(0)
        texts = (out.read(LONGEST_OUTPUT), err.read(LONGEST_OUTPUT))
    code = os.waitstatus_to_exitcode(status)
    return Ran(code, *texts, seconds, usage.ru_maxrss * 1024, hung, outlived and not hung)


def _ended(child: int, seconds: float) -> bool:
    """Wait until a process has ended, or has taken so long, and return whether it has ended.

    On a busy machine the clock says little: what counts after so long is the time of a processor that its group has
    had, and whether it is waiting for something that does not come.
    """
    descriptor = os.pidfd_open(child)
    try:
        poll = select.poll()
        poll.register(descriptor, select.POLLIN)
        if poll.poll(seconds * 1000):
            return True
        had = -1.0
        for _ in range(BUSY):
            used, waiting = _used(child)
            if used > seconds or (waiting and used == had):
                return False
            had = used
            if poll.poll(seconds * 100):
                return True
        return False
    finally:
        os.close(descriptor)


def _used(group: int) -> tuple[float, bool]:
    """Return the seconds of processors that a group of processes has had, and whether all of them wait."""
    ticks, states = 0, set()
    for path in Path("/proc").glob("[0-9]*/stat"):
        with contextlib.suppress(OSError):
            state, _, leader, *others = path.read_text(encoding="utf-8", errors="replace").rpartition(")")[2].split()
            if int(leader) == group:
                ticks += sum(map(int, others[8:12]))
                states.add(state)
    return ticks / os.sysconf("SC_CLK_TCK"), states <= {"S"}


def _outlived(group: int) -> bool:
    """Tell whether somebody of a group of processes is left after its leader, and stays."""
    until = monotonic() + GRACE
    with contextlib.suppress(ProcessLookupError, PermissionError):
        while monotonic() < until:
            os.killpg(group, 0)
            sleep(0.01)
        return True
    return False


def _end_group(group: int) -> None:
    with contextlib.suppress(ProcessLookupError, PermissionError):
        os.killpg(group, signal.SIGKILL)


def _become(
    work: Callable[[], None],
    folder: Path,
    limits: Limits,
    descriptors: tuple[int, int, int],
    variables: Mapping[str, str],
) -> NoReturn:
    """Be the process of a command, as Python would be: to the end of `work`, and out by its exit code."""
    code = 1
    try:
        os.setsid()
        for number, descriptor in enumerate(descriptors):
            os.dup2(descriptor, number)
        # Python ignores what it cannot write where a pipe is closed, and so may the process that runs the campaign.
        signal.signal(signal.SIGINT, signal.default_int_handler)
        signal.signal(signal.SIGTERM, signal.SIG_DFL)
        sys.stdin, sys.stdout, sys.stderr = (
            open(number, mode, encoding="utf-8", errors=errors, closefd=False)  # noqa: SIM115
            for number, mode, errors in ((0, "r", "strict"), (1, "w", "strict"), (2, "w", "backslashreplace"))
        )
        os.chdir(folder)
        os.environ.update(variables)
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
        pages_now = int(Path("/proc/self/statm").read_text(encoding="ascii").split()[0])
        most = pages_now * resource.getpagesize() + limits.memory_bytes
        resource.setrlimit(resource.RLIMIT_AS, (most, most))
        work()
        code = 0
    except SystemExit as stop:
        code = stop.code if isinstance(stop.code, int) else int(stop.code is not None)
    except BaseException:
        traceback.print_exc()
    finally:
        with contextlib.suppress(Exception):
            sys.stdout.flush()
        with contextlib.suppress(Exception):
            sys.stderr.flush()
        os._exit(code)
