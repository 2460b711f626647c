"""A process that watches over the command, which runs in one of its own: its time, its memory, and how it ends.

    prag-asp ... ── fork ──> the command, with the same streams, folder, terminal and process group
        │                        │ tells its limits and what it is just doing, on a board that both have
        └── waits, looks, hands on signals, and says the one line that the command cannot say any more

Foreign code (clingo's grounder, solvers, PyBullet) hears neither Ctrl-C nor a limit, and may end the process without a
word. So the command is asked first, by a signal, and ends as it does after Ctrl-C; where it does not within 2 s, or
8 s from when it has heard so, it is killed with all its workers. Where the supervisor is killed itself, the kernel
ends the command.

This is for Linux; elsewhere the command runs unsupervised, and limits hold where our own code looks at them.
"""

from __future__ import annotations

import os
import signal
import sys
from threading import active_count
from time import monotonic

from prag_asp.cli import exit_control
from prag_asp.cli.exit_control import Board
from prag_asp.cli.exits import Exit
from prag_asp.processes.lifeline import hang_on, held_line
from prag_asp.processes.machine import family_of, memory_of, usual_memory

POLL = 0.05
"""Seconds between two looks at time and memory."""

UNHEARD, HEARD = 2.0, 8.0
"""Seconds that the command has to end once it is asked to, before and after it has heard so.

Only those count in which this process runs itself: a machine that stood still, or a terminal that stopped both with
Ctrl-Z, takes nothing of them.
"""

SOON = 0.3
"""Seconds within which signals are one wish; a later one ends the command at once."""

LEAST_GRACE, MOST_GRACE = 1.0, 10.0
"""Seconds after its limit that a command has of its own to tell what it has found; otherwise a tenth of the limit."""

LEAST_ADDRESSES = 200_000_000
"""Bytes of addresses that clingo and NumPy take before anything is done with them."""

TOO_MUCH = 1.1
"""Times the limit of memory from which the command is not asked any more."""


def supervise() -> None:
    """Go on in a new process, and watch over it in this one, which ends when that does and with the same code."""
    if sys.platform != "linux" or active_count() > 1:
        return
    _require_addresses()
    watched = {each for each in (signal.SIGINT, signal.SIGTERM) if signal.getsignal(each) is not signal.SIG_IGN}
    for stream in (sys.stdout, sys.stderr):
        if stream is not None:
            stream.flush()
    usual = signal.pthread_sigmask(signal.SIG_BLOCK, {*watched, signal.SIGCHLD})
    try:
        board, (hanging, held) = Board(), held_line()
        command = os.fork()
    except OSError:  # there is no room for one more process
        signal.pthread_sigmask(signal.SIG_SETMASK, usual)
        return
    if command:
        exit_control.leave(_Supervisor(command, board, watched).code())
    os.close(held)
    hang_on(hanging)
    exit_control.begin(board)
    signal.pthread_sigmask(signal.SIG_SETMASK, usual)


def _require_addresses() -> None:
    """End this process where the system allows it less memory than the libraries take, which would not say so."""
    import resource

    allowed, _ = resource.getrlimit(resource.RLIMIT_AS)
    if allowed != resource.RLIM_INFINITY and allowed < LEAST_ADDRESSES:
        amounts = f"{allowed / 10**6:,.0f} MB of addresses (ulimit -v); allow {LEAST_ADDRESSES / 10**6:,.0f} MB"
        exit_control.write_line(f"the system allows only {amounts} or more")
        exit_control.leave(Exit.LIMIT)


class _Supervisor:
    """Waits for a command, and sees to it that it ends."""

    def __init__(self, command: int, board: Board, watched: set[signal.Signals]) -> None:
        self._command, self._board, self._watched = command, board, watched
        self._begun = monotonic()
        self._usual_memory: int | None = None
        self._asked: tuple[float, int, str] | None = None
        """When the command was asked to end, the code that this gives, and the line; empty words for the stage."""
        self._waited = 0.0
        """Seconds for which it has not ended since."""

    def code(self) -> int:
        """Wait until the command has ended, one way or another, and return the code for it."""
        while True:
            before = monotonic()
            # What a wait returns that a stop has interrupted may be anything, so nothing is read from it.
            signal.sigtimedwait({signal.SIGCHLD}, POLL)
            wish = signal.sigtimedwait(self._watched, 0)
            if wish is not None:  # first: the command may have ended by it already
                self._hand_on(wish.si_signo)
            ended, status = os.waitpid(self._command, os.WNOHANG)
            if ended:
                return self._code_of(os.waitstatus_to_exitcode(status))
            if wish is None:
                self._look()
            if self._asked is not None:
                self._waited += min(monotonic() - before, 2 * POLL)
                if self._waited > (HEARD if self._board.heard else UNHEARD):
                    return self._kill()

    def _hand_on(self, number: int) -> None:
        """Ask the command to end, as somebody asks us to; the second time, do not ask."""
        now = monotonic()
        code, line = (Exit.INTERRUPTED, "interrupted") if number == signal.SIGINT else (Exit.TERMINATED, "terminated")
        if self._asked is None or self._asked[1] == Exit.LIMIT:
            self._asked, self._waited = (now, code, line), 0.0
            os.kill(self._command, number)
        elif now - self._asked[0] > SOON:
            self._asked, self._waited = (now, code, line), HEARD

    def _look(self) -> None:
        """Ask the command to end where a limit is reached; where it takes far too much memory, do not ask."""
        seconds, memory = self._board.limits()
        if self._usual_memory is None:
            self._usual_memory = usual_memory()
        most = memory or self._usual_memory
        taken = memory_of(family_of(self._command))
        now = monotonic()
        if taken > TOO_MUCH * most:
            self._asked = self._asked or (now, Exit.LIMIT, exit_control.memory_reached(memory, self._board.stage()))
            self._waited = HEARD
        elif self._asked is None and taken > most:
            self._ask(exit_control.memory_reached(memory, self._board.stage()))
        elif self._asked is None and seconds is not None and now - self._begun > seconds + grace(seconds):
            self._ask(exit_control.time_reached(seconds, self._board.stage(), taken))

    def _ask(self, line: str) -> None:
        self._asked = (monotonic(), Exit.LIMIT, line)
        os.kill(self._command, signal.SIGALRM)

    def _kill(self) -> int:
        """End the command and all that it has started, and return the code for it."""
        assert self._asked is not None
        for process in family_of(self._command):
            try:
                os.kill(process, signal.SIGKILL)
            except ProcessLookupError:
                continue
        os.waitpid(self._command, 0)
        return self._as_asked()

    def _as_asked(self) -> int:
        """Return the code for what the command was asked to end by, and say so where it has not."""
        assert self._asked is not None
        _, code, line = self._asked
        if not self._board.said:
            exit_control.write_line(line)
        return code

    def _code_of(self, ended: int) -> int:
        """Return the code of a command that has ended by itself, and say how where something else ended it.

        Foreign code that is asked to end may end the process instead: that is no crash. Where an error comes to clingo
        that it cannot hand on, it ends the process with the code of an answer, which this is not.
        """
        if ended > 0 and not self._board.done and self._asked is None:
            exit_control.write_line(exit_control.gave_up(self._board.stage()))
            return Exit.LIMIT
        if ended >= 0:
            return ended
        if self._asked is not None:
            return self._as_asked()
        if -ended in (signal.SIGINT, signal.SIGTERM):
            interrupted = -ended == signal.SIGINT
            exit_control.write_line("interrupted" if interrupted else "terminated")
            return Exit.INTERRUPTED if interrupted else Exit.TERMINATED
        try:
            name = signal.Signals(-ended).name
        except ValueError:
            name = f"signal {-ended}"
        exit_control.write_line(exit_control.crashed(name, self._board.stage()))
        return Exit.LIMIT


def grace(seconds: float) -> float:
    """Return for how long after its limit of time a command may go on, to tell what it has found."""
    return min(max(seconds / 10, LEAST_GRACE), MOST_GRACE)
