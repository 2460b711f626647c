"""How a command is asked to end before it is done, by whom, and what it says then.

A command may run alone, in the process of whoever calls it, or beside a supervisor (`prag_asp.cli.supervision`). Both
share a board, on which the command writes its limits and what it is just doing, for the supervisor to read where the
command cannot speak any more.
"""

from __future__ import annotations

import errno
import os
import signal
import sys
from _thread import start_new_thread
from threading import main_thread
from time import monotonic, sleep
from typing import TYPE_CHECKING, NoReturn

from prag_asp.errors import PragError
from prag_asp.processes.lifeline import above_the_standard_ones
from prag_asp.processes.machine import SHARE, memory_in_use, most_addresses, usual_memory
from prag_asp.processes.progress_events import Note, hear

if TYPE_CHECKING:
    from types import FrameType

LONGEST = 300
"""Characters of what a command is just doing."""

STAGE, LIMITS, DONE, SIZE = 128, 64, 1, 2048
"""Where on the board the stage, the limits and the own end stand; its first byte says how far an end has come."""


LATER = 0.05
"""Seconds after which an interruption that was dropped, or could not be, comes again."""

DEADLY = frozenset(["_pyclingo_solve_event_callback", "_pyclingo_logger_callback"])
"""Functions that clingo calls, and for whose errors it ends the process."""


NO_MEMORY = (MemoryError, SystemError)
"""What is raised where the system refuses memory; the second by native code that does not say why it failed."""

REFUSALS = (
    "can't allocate lock", "can't start new thread", "Cannot allocate memory", "failed to map segment",
    "not PosixPath",  # which is a path all the same: there was no memory for its text
    "error in callback",  # of clingo, whose other errors come with what it was told
    "A loop/promoter has already been registered",  # of NumPy, which could not take down that it has
)  # fmt: skip
"""What Python, its libraries and the loader of these say of it in other errors."""

GENERATED = "<"
"""How the name of a file begins that is none: code that Python writes for itself has no mistake but want of memory."""

LEAST_ROOM = 64_000_000
"""Bytes of addresses that are few: what is asked for at once may be as much."""


class Terminated(KeyboardInterrupt):
    """Another process has asked this one to end, which it does as after Ctrl-C."""


class Struck(BaseException):
    """A limit on the whole command is reached, which ends as after Ctrl-C, and says so."""


ASKED: dict[int, type[BaseException]] = {
    signal.SIGINT: KeyboardInterrupt,
    signal.SIGTERM: Terminated,
    signal.SIGALRM: Struck,
}
"""The signals that ask for an end, and what they raise in the command. The last comes from the supervisor alone."""


class Board:
    """What a command tells its supervisor, in memory that both have; each line is written by one call."""

    def __init__(self) -> None:
        self._file = above_the_standard_ones(os.memfd_create("prag-asp", os.MFD_CLOEXEC))
        os.ftruncate(self._file, SIZE)

    def tell_stage(self, words: str) -> None:
        """Write what the command is just doing."""
        os.pwrite(
            self._file, " ".join(words.split())[:LONGEST].encode(errors="replace").ljust(4 * LONGEST, b"\0"), STAGE
        )

    def stage(self) -> str:
        """Return what the command was doing last."""
        return os.pread(self._file, 4 * LONGEST, STAGE).rstrip(b"\0").decode(errors="replace")

    def tell_limits(self, seconds: float | None, memory: int | None) -> None:
        """Write the limits that the command line gives; None stands for those that hold anyway."""
        os.pwrite(self._file, f"{seconds or 0} {memory or 0}".encode().ljust(STAGE - LIMITS, b"\0"), LIMITS)

    def limits(self) -> tuple[float | None, int | None]:
        """Return the limits that the command line gives, as far as it has been read."""
        seconds, _, memory = os.pread(self._file, STAGE - LIMITS, LIMITS).rstrip(b"\0").partition(b" ")
        return float(seconds or 0) or None, int(memory or 0) or None

    def tell_end(self, *, said: bool) -> None:
        """Write that the command has heard that it is to end, or has said so itself."""
        os.pwrite(self._file, b"s" if said else b"h", 0)

    def tell_done(self) -> None:
        """Write that the command has come to its own end, whatever that is."""
        os.pwrite(self._file, b"d", DONE)

    @property
    def done(self) -> bool:
        """Whether the command has come to its own end."""
        return os.pread(self._file, 1, DONE) == b"d"

    @property
    def heard(self) -> bool:
        """Whether the command has heard that it is to end."""
        return os.pread(self._file, 1, 0) != b"\0"

    @property
    def said(self) -> bool:
        """Whether the command has said itself why it ends."""
        return os.pread(self._file, 1, 0) == b"s"


class _Command:
    """The command of this process: when it began, what it was told, and what it does."""

    def __init__(self) -> None:
        self.begun = monotonic()
        self.seconds: float | None = None
        self.memory: int | None = None
        self.board: Board | None = None
        self.asked: int | None = None
        self.stage = ""


_command = _Command()


def begin(board: Board | None = None) -> None:
    """Begin a command; with a board, it is told what happens, and answers SIGINT and SIGTERM once, whoever sends it.

    Ctrl-C reaches all processes of a terminal, and a supervisor hands on what it hears: they are one wish.
    """
    global _command  # noqa: PLW0603  a process runs one command at a time
    if board is None and _command.board is not None:
        return
    _command = _Command()
    _command.board = board
    if board is not None:
        for number in ASKED:
            if signal.getsignal(number) is not signal.SIG_IGN or number == signal.SIGALRM:
                signal.signal(number, _answer)


def _answer(number: int, frame: FrameType | None) -> None:
    """Raise what a signal asks for, the first time; where foreign code does not survive that, a little later."""
    if _command.asked is None and _in_callback(frame):
        start_new_thread(send_later, (number,))
    elif _command.asked is None:
        _command.asked = number
        if _command.board is not None:
            _command.board.tell_end(said=False)
        raise ASKED[number]


def _in_callback(frame: FrameType | None) -> bool:
    """Tell whether foreign code that ends the process for an error has called what a frame is part of."""
    while frame is not None:
        if frame.f_code.co_name in DEADLY:
            return True
        frame = frame.f_back
    return False


def send_later(number: int) -> None:
    """Send the main thread a signal when Python has come to do something else."""
    sleep(LATER)
    main = main_thread().ident
    if main is not None:
        signal.pthread_kill(main, number)


def answer_again() -> None:
    """Answer the next signal too: what was raised has been dropped."""
    _command.asked = None


def supervised() -> bool:
    """Tell whether a supervisor watches over this command."""
    return _command.board is not None


def asked_for() -> type[BaseException] | None:
    """Return what this command was asked to end by, whatever has become of it in foreign code, or None."""
    return None if _command.asked is None else ASKED[_command.asked]


def limit(seconds: float | None = None, memory: int | None = None) -> None:
    """Limit the command that has begun: to seconds since then, and to bytes of all its processes."""
    _command.seconds, _command.memory = seconds or _command.seconds, memory or _command.memory
    if _command.board is not None:
        _command.board.tell_limits(_command.seconds, _command.memory)


def limits() -> tuple[float | None, int, float]:
    """Return the seconds and the bytes that the command may take, and when it began, on the monotonic clock."""
    return _command.seconds, _command.memory or usual_memory(), _command.begun


def ignore(number: int) -> None:
    """Hear a signal no more; where memory is refused, that is so all the same, or it ends what is ending."""
    try:
        signal.signal(number, signal.SIG_IGN)
    except NO_MEMORY:  # mostly for the name of what heard it before
        return


def deafen() -> None:
    """Hear nothing more: the command is about to say why it ends, and ends by that alone.

    Where it was asked to end, neither is told what comes of values that were torn half-way, when they are freed.
    """
    if _command.board is None:
        return
    for number in ASKED:
        ignore(number)
    if _command.asked is not None:
        sys.unraisablehook = lambda dropped: None


def said() -> None:
    """Note that the command has said why it ends."""
    if _command.board is not None:
        _command.board.tell_end(said=True)


def done() -> None:
    """Note that the command has come to its own end: native code that ends the process does not come here."""
    if _command.board is not None:
        _command.board.tell_done()


def doing() -> str:
    """Return what the command is just doing."""
    return _command.stage


def _hear(words: str) -> None:
    if isinstance(words, Note):
        return
    _command.stage = words
    if _command.board is not None:
        _command.board.tell_stage(words)


hear(_hear)


def time_reached(seconds: float, stage: str, taken: int) -> str:
    """Return the line that says that the limit of time was reached, with how much memory, and what to do."""
    took = f", with {taken / 10**6:,.0f} MB" if taken else ""
    return f"the time limit of {seconds:g} s was reached{_while(stage)}{took}; allow more with --time"


def memory_reached(memory: int | None, stage: str) -> str:
    """Return the line that says that the limit of memory was reached, the usual one or a given one, and what to do."""
    usual = "" if memory else f" ({SHARE} % of the machine's)"
    amount = (memory or usual_memory()) / 10**6
    return f"the memory limit of {amount:,.0f} MB{usual} was reached{_while(stage)}; allow more with --memory"


def struck() -> str:
    """Return the line of the limit that a supervisor says was reached."""
    seconds = _command.seconds
    if seconds is not None and monotonic() - _command.begun > seconds:
        return time_reached(seconds, _command.stage, memory_in_use())
    return memory_reached(_command.memory, _command.stage)


def out_of_memory() -> str:
    """Return the line that says that the system has refused memory."""
    return f"there is no more memory{_while(_command.stage)}; ask for less, or free some"


def memory_refused(error: BaseException) -> bool:
    """Tell whether an error that nobody expects comes of memory that the system has refused, whatever it is called.

    Native code, and what imports it, give errors of many kinds then. Where the system allows only so many addresses,
    and nearly all were taken, what nobody expects comes of that.
    """
    return caused_by_memory(error) or _near_the_last_address()


def caused_by_memory(error: BaseException | None) -> bool:
    """Tell whether memory was refused where an error, or one that it came of, was raised."""
    seen: list[int] = []
    while error is not None and id(error) not in seen:
        seen.append(id(error))
        if isinstance(error, NO_MEMORY) or getattr(error, "errno", None) == errno.ENOMEM:
            return True
        if not isinstance(error, PragError) and any(words in str(error) for words in REFUSALS):
            return True
        if isinstance(error, SyntaxError) and (error.filename or GENERATED).startswith(GENERATED):
            return True
        error = error.__cause__ or error.__context__
    return False


def _near_the_last_address() -> bool:
    """Tell whether this process has had nearly all addresses that the system allows."""
    import resource

    allowed, _ = resource.getrlimit(resource.RLIMIT_AS)
    if allowed == resource.RLIM_INFINITY:
        return False
    return allowed - most_addresses() < max(allowed // 10, LEAST_ROOM)


def too_deep() -> str:
    """Return the line that says that something is nested deeper than we can follow."""
    return f"something is nested too deeply{_while(_command.stage)}; make it flatter"


def crashed(name: str, stage: str) -> str:
    """Return the line of a process that a signal of this name has ended, and what that most often means."""
    reason = {
        "SIGKILL": "most likely the machine had no memory left; give it less with --memory",
        "SIGABRT": "most likely it got no more memory; ask for less",
        "SIGSEGV": "most likely something is nested too deeply; make it flatter",
    }.get(name, "native code of a library has failed")
    return f"the command was ended by {name}{_while(stage)}: {reason}"


def gave_up(stage: str) -> str:
    """Return the line of a process that native code has ended with a code of its own."""
    reason = "most likely it got no more memory; ask for less"
    return f"native code of a library has ended the command{_while(stage)}: {reason}"


def _while(stage: str) -> str:
    return f" while {stage}" if stage else ""


def write_line(text: str) -> None:
    """Write a line on stderr without a buffer, wherever that leads; in a terminal, in place of what is shown there."""
    try:
        clear = "\r\x1b[K\x1b[?25h" if os.isatty(2) and os.environ.get("TERM") != "dumb" else ""
        os.write(2, f"{clear}{text}\n".encode(errors="replace"))
    except OSError:
        return


def leave(code: int) -> NoReturn:
    """End this process at once."""
    sys.stdout = sys.stderr = None
    os._exit(code)
