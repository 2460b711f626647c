"""End a command after a result, an error, a signal or a limit, with at most one line on stderr and an exit code.

On Linux, the command runs as the child of a supervisor (`prag_asp.cli.supervision`). The command reports its limits,
its stage and its end through a pipe, so that the supervisor can print the line when the command cannot.
"""

from __future__ import annotations

import errno
import os
import signal
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from threading import Timer, current_thread, main_thread
from time import monotonic
from typing import TYPE_CHECKING

from prag_asp.cli.exits import Exit, exit_of
from prag_asp.cli.terminal import tell_line
from prag_asp.errors import LimitReached, PragError
from prag_asp.integers import with_short_numbers
from prag_asp.processes.progress_events import Note, hear

if TYPE_CHECKING:
    from types import FrameType

    from prag_asp.space.limits import Limits

AGAIN = 0.01
"""The time in seconds until a signal is sent again, after the end of the callback that dropped the exception."""

LONGEST_REPORT = 1000
"""The maximum size of a report in bytes, which is below the 4096 bytes that a pipe accepts atomically."""

STAGE, LIMITS, SIGNALLED, DONE = "stage", "limits", "signalled", "done"
"""The kinds of reports to the supervisor."""


class Terminated(KeyboardInterrupt):
    """The command has received SIGTERM."""


class LimitStruck(BaseException):
    """The supervisor has stopped the command at a limit on time or memory, and will print the line about it."""


SIGNALS: dict[int, type[BaseException]] = {
    signal.SIGINT: KeyboardInterrupt,
    signal.SIGTERM: Terminated,
    signal.SIGALRM: LimitStruck,
}
"""The exception that each signal raises in a command; only the supervisor sends SIGALRM."""

ENDS = {signal.SIGINT: ("interrupted", Exit.INTERRUPTED), signal.SIGTERM: ("terminated", Exit.TERMINATED)}
"""The message and the exit code of a command that is ended by a signal from the user."""

ERRORS = (Exception, KeyboardInterrupt, LimitStruck)
"""The types of errors that `report_end` accepts."""


@dataclass
class _CommandState:
    """The state of the command in this process: its limits, its stage, and the signal received."""

    pipe: int | None = None
    begun: float = field(default_factory=monotonic)
    seconds: float | None = None
    memory: int | None = None
    stage: str = ""
    signal: int | None = None


_state = _CommandState()


def begin(pipe: int) -> None:
    """Begin a command under a supervisor, which reads reports from `pipe` and forwards signals."""
    global _state  # noqa: PLW0603  a process runs one command at a time
    os.set_blocking(pipe, False)
    _state = _CommandState(pipe)
    for number in SIGNALS:
        if number == signal.SIGALRM or signal.getsignal(number) is not signal.SIG_IGN:
            signal.signal(number, _on_signal)


@contextmanager
def running() -> Iterator[None]:
    """Handle signals while a command runs without a supervisor; do nothing if it has one."""
    global _state  # noqa: PLW0603
    if _state.pipe is not None or current_thread() is not main_thread():
        yield
        return
    _state = _CommandState()
    usual = {number: signal.getsignal(number) for number in ENDS}
    for number, handler in usual.items():
        if handler is not signal.SIG_IGN:
            signal.signal(number, _on_signal)
    try:
        yield
    finally:
        for number, handler in usual.items():
            signal.signal(number, handler)


def _on_signal(number: int, frame: FrameType | None) -> None:
    """Raise the exception for a signal, but only once: Ctrl-C arrives from the terminal and from the supervisor.

    From then on, errors from objects that the exception left incomplete are not reported. If Python drops the
    exception, because it was raised in a finalizer or a callback of a weak reference, it is raised again.
    """
    if _state.signal is not None and _state.pipe is not None:
        return
    _state.signal = number
    _report(SIGNALLED)
    if _state.pipe is not None:
        sys.unraisablehook = _raise_again
    raise SIGNALS[number]


def _raise_again(dropped: sys.UnraisableHookArgs) -> None:
    """Send the signal again soon if Python has dropped the exception for it; ignore any other dropped error."""
    number = _state.signal
    if number is not None and dropped.exc_type is SIGNALS[number]:
        # Until then, further signals are ignored, because an exception raised in this hook would be printed.
        again = Timer(AGAIN, _send_again, (number,))
        again.daemon = True
        again.start()


def _send_again(number: int) -> None:
    _state.signal = None
    os.kill(os.getpid(), number)


def interrupted() -> bool:
    """Return whether the command has received a signal to end."""
    return _state.signal is not None


def set_limits(seconds: float | None = None, memory: int | None = None) -> None:
    """Limit the time in seconds since the command began, and the total memory in bytes of all its processes."""
    _state.seconds, _state.memory = seconds or _state.seconds, memory or _state.memory
    _report(LIMITS, f"{_state.seconds or 0} {_state.memory or 0}")


def limits(*, cached: bool = True) -> Limits:
    """Return the limits of the command; by default, a share of the machine's memory and no time limit."""
    from prag_asp.processes.machine import usual_memory
    from prag_asp.space.limits import Limits

    return Limits(_state.memory or usual_memory(), _state.seconds, cached, _state.begun)


def report_end(error: BaseException) -> int:
    """Print the reason why the command ends, and return its exit code.

    After a signal, any error counts as an interruption, because native code may raise other errors when it is
    interrupted.

    Raises:
        BaseException: the error itself, if it is a bug of this package.
    """
    _ignore_signals()
    lines: tuple[str, ...] = ()
    if isinstance(error, LimitStruck) or _state.signal == signal.SIGALRM:
        code = Exit.LIMIT  # the supervisor prints the line
    elif isinstance(error, KeyboardInterrupt) or _state.signal is not None:
        terminated = isinstance(error, Terminated) or _state.signal == signal.SIGTERM
        line, code = ENDS[signal.SIGTERM if terminated else signal.SIGINT]
        lines = (line,)
    elif isinstance(error, BrokenPipeError):
        sys.stdout = None  # Python would flush it at the end
        code = Exit.OUTPUT
    elif _out_of_memory(error) and not isinstance(error, LimitReached):
        lines, code = (f"out of memory{while_(_state.stage)}; use a smaller problem, or free some memory",), Exit.LIMIT
    elif isinstance(error, PragError):
        is_answer = isinstance(error, LimitReached)  # this error contains a count, which is printed in full
        lines = error.lines if is_answer else tuple(map(with_short_numbers, error.lines))
        code = exit_of(error)
    elif isinstance(error, RecursionError):
        lines, code = (f"the input is nested too deeply{while_(_state.stage)}; make it flatter",), Exit.BAD_INPUT
    elif isinstance(error, OSError):
        lines = (f"{error.filename or 'stdout'}: {error.strerror or error}",)
        code = Exit.BAD_INPUT if error.filename else Exit.OUTPUT
    else:
        raise error
    for line in lines:
        tell_line(line)
    return code


def finish(code: int) -> None:
    """Ignore signals from now on, and report the exit code unless the supervisor has stopped the command at a limit."""
    _ignore_signals()
    try:
        if sys.stdout is not None:
            sys.stdout.flush()
    except OSError:
        sys.stdout = None  # the error was reported when it first occurred
    if _state.pipe is not None and _state.signal != signal.SIGALRM:
        os.set_blocking(_state.pipe, True)
        _report(DONE, str(int(code)))


def while_(stage: str) -> str:
    """Return `` while STAGE`` for a message, or "" if there is no stage."""
    return f" while {stage}" if stage else ""


def reopen_closed_streams() -> None:
    """Open /dev/null for each closed standard stream; stdout is opened for reading, so that writing to it fails.

    Otherwise, the next file that is opened would get the file descriptor of the closed stream. `sys.stdin` remains
    None, so that a command that reads standard input is refused.
    """
    for number, name, flags in ((0, "stdin", os.O_RDONLY), (1, "stdout", os.O_RDONLY), (2, "stderr", os.O_WRONLY)):
        if getattr(sys, name) is None:
            descriptor = os.open(os.devnull, flags)
            if descriptor != number:
                os.dup2(descriptor, number)
                os.close(descriptor)
            if number:
                setattr(sys, name, os.fdopen(number, "w", closefd=False))


def _ignore_signals() -> None:
    if _state.pipe is not None:
        for number in SIGNALS:
            signal.signal(number, signal.SIG_IGN)


def _out_of_memory(error: BaseException | None) -> bool:
    """Return whether an error, or one of its causes, was raised because the system refused memory."""
    seen: set[int] = set()  # causes that a library sets may form a cycle
    while error is not None and id(error) not in seen:
        if isinstance(error, MemoryError) or (isinstance(error, OSError) and error.errno == errno.ENOMEM):
            return True
        seen.add(id(error))
        error = error.__cause__ or error.__context__
    return False


def _report(kind: str, text: str = "") -> None:
    """Send a report to the supervisor; it is dropped if the pipe is full."""
    if _state.pipe is not None:
        try:
            os.write(_state.pipe, f"{kind} {text}".encode(errors="replace")[:LONGEST_REPORT] + b"\n")
        except OSError:
            return


def _set_stage(words: str) -> None:
    if not isinstance(words, Note):
        _state.stage = " ".join(words.split())
        _report(STAGE, _state.stage)


hear(_set_stage)
