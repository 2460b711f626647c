"""The supervisor, a process that watches the time, the memory and the end of a command.

    prag-asp ... ── fork ──> the command, with the same streams, folder, terminal and process group
        │       <── pipe ──    │ its limits, its stage, its exit code
        └── waits, checks limits, passes on signals, and prints the line that the command can no longer print

Native code (clingo's grounder, solvers, PyBullet) reacts neither to Ctrl-C nor to a limit, and may end the process
without a message. The supervisor therefore first sends a signal, after which the command should end as after Ctrl-C. A
command that does not end within 2 s, or within 8 s if it has handled the signal, is killed with all its workers. If the
supervisor is killed, the kernel ends the command.

This works on Linux only; on other systems, limits are checked only by prag_asp's own code.
"""

from __future__ import annotations

import os
import signal
import sys
from contextlib import suppress
from threading import active_count
from time import monotonic
from typing import NoReturn

from prag_asp.cli import exit_control
from prag_asp.cli.exit_control import DONE, ENDS, LIMITS, SIGNALLED, STAGE, while_
from prag_asp.cli.exits import Exit
from prag_asp.processes.lifeline import hang_on, held_line
from prag_asp.processes.machine import SHARE, family_of, memory_of, signal_name, usual_memory

POLL = 0.05
"""The time in seconds between two checks of time and memory."""

UNHEARD, HEARD = 2.0, 8.0
"""The times in seconds within which the command has to end after a signal, before and after handling the signal.

Only the time in which the supervisor runs counts, not the time in which it is suspended.
"""

SOON = 0.3
"""The time in seconds within which several signals count as one; a later signal kills the command."""

LEAST_GRACE, MOST_GRACE = 1.0, 10.0
"""Bounds in seconds on the time for reporting results after the time limit; see `grace`."""

LEAST_ADDRESSES = 200_000_000
"""The address space in bytes that clingo and NumPy need for loading; with less, they crash."""

TOO_MUCH = 1.1
"""The multiple of the memory limit at which the command is killed without a prior signal."""


def supervise() -> None:
    """Continue in a child process; the parent process watches it, and exits with the exit code of the child.

    The process exits with an error if `ulimit -v` allows less address space than the libraries need.
    """
    if sys.platform != "linux" or active_count() > 1:
        return
    import resource

    allowed, _ = resource.getrlimit(resource.RLIMIT_AS)
    if allowed != resource.RLIM_INFINITY and allowed < LEAST_ADDRESSES:
        least = f"{LEAST_ADDRESSES / 10**6:,.0f} MB"
        _write_line(f"the system allows only {allowed / 10**6:,.0f} MB of addresses (ulimit -v); allow {least} or more")
        _exit(Exit.LIMIT)
    watched = {each for each in (signal.SIGINT, signal.SIGTERM) if signal.getsignal(each) is not signal.SIG_IGN}
    for stream in (sys.stdout, sys.stderr):
        stream.flush()
    usual = signal.pthread_sigmask(signal.SIG_BLOCK, {*watched, signal.SIGCHLD})
    try:
        (reports, pipe), (hanging, held) = os.pipe(), held_line()
        command = os.fork()
    except OSError:  # the system allows no further process or file
        signal.pthread_sigmask(signal.SIG_SETMASK, usual)
        return
    if command:
        os.close(pipe)
        _exit(_Supervisor(command, reports, watched).wait())
    os.close(held)
    os.close(reports)
    hang_on(hanging)
    exit_control.begin(pipe)
    signal.pthread_sigmask(signal.SIG_SETMASK, usual)


class _Supervisor:
    """The part of a supervisor that waits for a command, and makes sure that it ends."""

    def __init__(self, command: int, reports: int, watched: set[signal.Signals]) -> None:
        os.set_blocking(reports, False)
        self._command, self._reports, self._watched = command, reports, watched
        self._begun = monotonic()
        self._unread = b""
        self._stage = ""
        self._seconds: float | None = None
        self._memory: int | None = None
        self._usual_memory = 0
        self._signalled = False
        """Whether the command has handled a signal."""
        self._done: int | None = None
        """The exit code that the command has reported."""
        self._stop: tuple[float, int, str] | None = None
        """The time of the signal to end, the exit code, and the line that gives the reason; None before that signal."""
        self._waited = 0.0
        """The number of seconds since that signal."""

    def wait(self) -> int:
        """Wait until the command has ended, and return the exit code; kill it and its workers if it does not end."""
        while True:
            before = monotonic()
            # The result is ignored, because it is arbitrary if the process was suspended (Ctrl-Z) while waiting.
            signal.sigtimedwait({signal.SIGCHLD}, POLL)
            sent = signal.sigtimedwait(self._watched, 0)
            if sent is not None:  # comes first, because the command may already have ended for this reason
                self._pass_on(sent.si_signo)
            ended, status = os.waitpid(self._command, os.WNOHANG)
            self._read_reports()
            if ended:
                return self._code_of(os.waitstatus_to_exitcode(status))
            if sent is None and self._stop is None:
                self._check_limits()
            if self._stop is not None:
                self._waited += min(monotonic() - before, 2 * POLL)
                if self._waited > (HEARD if self._signalled else UNHEARD):
                    for process in family_of(self._command):
                        with suppress(ProcessLookupError):
                            os.kill(process, signal.SIGKILL)
                    os.waitpid(self._command, 0)
                    return self._code_of(-signal.SIGKILL)

    def _read_reports(self) -> None:
        try:
            while part := os.read(self._reports, 1 << 16):
                self._unread += part
        except BlockingIOError:
            pass
        *lines, self._unread = self._unread.split(b"\n")
        for line in lines:
            kind, _, text = line.decode(errors="replace").partition(" ")
            if kind == STAGE:
                self._stage = text
            elif kind == LIMITS:
                seconds, _, memory = text.partition(" ")
                self._seconds, self._memory = float(seconds) or None, int(memory) or None
            elif kind == SIGNALLED:
                self._signalled = True
            elif kind == DONE:
                self._done = int(text)

    def _pass_on(self, number: int) -> None:
        """Forward a signal to the command; kill the command at the second signal."""
        now, (line, code) = monotonic(), ENDS[signal.Signals(number)]
        if self._stop is None or self._stop[1] == Exit.LIMIT:
            self._stop, self._waited = (now, code, line), 0.0
            os.kill(self._command, number)
        elif now - self._stop[0] > SOON:
            self._stop, self._waited = (now, code, line), HEARD

    def _check_limits(self) -> None:
        """Stop the command at a limit; kill it if it takes far too much memory."""
        if self._done is not None:
            return
        self._usual_memory = self._usual_memory or usual_memory()
        most, taken, now = self._memory or self._usual_memory, memory_of(family_of(self._command)), monotonic()
        if taken > most:
            usual = "" if self._memory else f" ({SHARE} % of the machine's)"
            reached, option = f"the memory limit of {most / 10**6:,.0f} MB{usual} was reached", "--memory"
            self._waited = HEARD if taken > TOO_MUCH * most else 0.0
        elif self._seconds is not None and now - self._begun > self._seconds + grace(self._seconds):
            reached, option = f"the time limit of {self._seconds:g} s was reached", "--time"
        else:
            return
        used = f", with {taken / 10**6:,.0f} MB" if option == "--time" else ""
        self._stop = (now, Exit.LIMIT, f"{reached}{while_(self._stage)}{used}; allow more with {option}")
        os.kill(self._command, signal.SIGALRM)

    def _code_of(self, status: int) -> int:
        """Return the exit code for the status of an ended command; if none was reported, print the reason."""
        if self._done is not None:
            return status if status >= 0 else self._done
        if self._stop is not None:
            _, code, line = self._stop
        elif -status in ENDS:
            line, code = ENDS[signal.Signals(-status)]
        else:
            what = f"the command was killed by {signal_name(-status)}"
            advice = "native code failed; try a smaller problem"
            if status >= 0:
                what = f"native code ended the command with code {status}"
            elif status == -signal.SIGKILL:
                advice = "if the machine ran out of memory, set a lower --memory"
            line, code = f"{what}{while_(self._stage)}; {advice}", Exit.LIMIT
        _write_line(line)
        return code


def grace(seconds: float) -> float:
    """Return the time in seconds for reporting results after a time limit: a tenth of the limit, within bounds."""
    return min(max(seconds / 10, LEAST_GRACE), MOST_GRACE)


def _write_line(line: str) -> None:
    """Print a line on stderr; on a terminal, remove a progress bar and show the cursor."""
    clear = "\r\x1b[K\x1b[?25h" if os.isatty(2) and os.environ.get("TERM") != "dumb" else ""
    try:
        os.write(2, f"{clear}{line}\n".encode(errors="replace"))
    except OSError:
        return


def _exit(code: int) -> NoReturn:
    """End this process at once, without Python's cleanup, which is left to the command."""
    os._exit(code)
