"""What the command shows: lines on stdout or in a file, everything else on stderr, errors as one line and a code."""

from __future__ import annotations

import errno
import gc
import os
import signal
import sys
import threading
from _thread import start_new_thread
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path
from time import monotonic, sleep
from typing import TYPE_CHECKING, Any, NoReturn, Protocol, TextIO

import click

from prag_asp.errors import LimitReached, OutputError, PragError, one_line, plain
from prag_asp.reading import Refused

if TYPE_CHECKING:
    from types import FrameType

    from rich.progress import Progress, TaskID

FAILED, BAD_INPUT, LIMITED, INTERRUPTED, TERMINATED = 1, 2, 3, 130, 143
COLLECT = (100_000, 50, 100)
"""A ground program is a great many small values without cycles, among which looking for garbage is a waste of time."""

PATIENCE = 2.0
"""Seconds before a terminal is shown how far things are."""

LATER = 0.05
"""Seconds after which an interruption that was dropped comes again."""


UNREADABLE = (FileNotFoundError, IsADirectoryError, NotADirectoryError, Refused)
UNREADABLE_NUMBERS = (errno.ENAMETOOLONG, errno.ELOOP)
"""What is wrong with a path that is given: it leads to no file that is read."""


def say(text: object) -> None:
    """Print lines on stdout; a terminal gets no character that it would obey, but for tabs."""
    click.echo(_for_terminal(str(text)) if sys.stdout.isatty() else str(text))


def tell_line(text: str) -> None:
    """Print one line on stderr, which is short and has no character that a terminal would obey, whatever it quotes."""
    click.echo(one_line(text), err=True)


def _for_terminal(text: str) -> str:
    return "\n".join("\t".join(map(plain, line.split("\t"))) for line in text.split("\n"))


def _show_usage(error: click.ClickException) -> None:
    """Say in one line what is wrong with a command line; one without words gets the help that it asks for."""
    context = error.ctx if isinstance(error, click.UsageError) else None
    if isinstance(error, getattr(click.exceptions, "NoArgsIsHelpError", ())) or context is None:
        error.show()
        return
    told = " ".join(error.format_message().split()).rstrip(".")
    tell_line(f"{context.command_path}: {told}; see {context.command_path} --help")


class Terminated(KeyboardInterrupt):
    """Another process has asked this one to end, which it does as after Ctrl-C."""


class Command(click.Group):
    """Turns errors into one line on stderr, and an interruption into a quiet end."""

    def main(self, *args: Any, **kwargs: Any) -> Any:
        """Run the command and return its exit code."""
        if hasattr(sys, "set_int_max_str_digits"):
            sys.set_int_max_str_digits(0)
        gc.set_threshold(*COLLECT)
        try:
            with _insisting():
                return super().main(*args, **{**kwargs, "standalone_mode": False}) or 0
        except click.exceptions.Exit as stop:
            return stop.exit_code
        except click.ClickException as error:
            _show_usage(error)
            return error.exit_code
        except (click.Abort, KeyboardInterrupt, PragError, OSError) as error:
            return _end(error)
        except RuntimeError as error:
            if isinstance(error.__cause__, KeyboardInterrupt):  # So Python wraps what interrupts the making of a class.
                return _end(error.__cause__)
            raise


@contextmanager
def _insisting() -> Iterator[None]:
    """Have an interruption that Python drops, since it comes while a value is being freed, come again after that."""
    usual = sys.unraisablehook

    def again(dropped: sys.UnraisableHookArgs) -> None:
        if isinstance(dropped.exc_value, Terminated):
            signal.signal(signal.SIGTERM, _terminate)
            start_new_thread(_send_later, (signal.SIGTERM,))
        elif isinstance(dropped.exc_value, KeyboardInterrupt):
            start_new_thread(_send_later, (signal.SIGINT,))
        else:
            usual(dropped)

    sys.unraisablehook = again
    try:
        yield
    finally:
        sys.unraisablehook = usual


def _send_later(number: signal.Signals) -> None:
    """Send the main thread a signal when Python has come to do something else."""
    sleep(LATER)
    main = threading.main_thread().ident
    if main is not None:
        signal.pthread_kill(main, number)


def _end(error: BaseException) -> int:
    """Say on stderr why the command ends, and return its exit code."""
    if isinstance(error, BrokenPipeError):
        sys.stdout = None  # nothing more can be flushed into it
        return FAILED
    if isinstance(error, Terminated) or isinstance(error.__cause__, Terminated):
        click.echo("terminated", err=True)
        return TERMINATED
    if isinstance(error, (click.Abort, KeyboardInterrupt)):
        click.echo("interrupted", err=True)
        return INTERRUPTED
    if isinstance(error, OSError):
        tell_line(f"{error.filename or 'output'}: {error.strerror or error}")
        return BAD_INPUT if isinstance(error, UNREADABLE) or error.errno in UNREADABLE_NUMBERS else FAILED
    assert isinstance(error, PragError)
    for line in error.lines:
        tell_line(line)
    if isinstance(error, LimitReached):
        return LIMITED
    return FAILED if isinstance(error, OutputError) else BAD_INPUT


@contextmanager
def whole_lines() -> Iterator[None]:
    """Let SIGTERM end what is done here as Ctrl-C does: workers end, what is written is whole, figures are told.

    A second one ends the process at once. Elsewhere SIGTERM does so, for there is nothing to lose.

    Raises:
        Terminated: the signal has come.
    """
    usual = signal.getsignal(signal.SIGTERM)
    if usual is not signal.SIG_DFL or threading.current_thread() is not threading.main_thread():
        yield
        return

    signal.signal(signal.SIGTERM, _terminate)
    try:
        yield
    finally:
        signal.signal(signal.SIGTERM, usual)


def _terminate(number: int, frame: FrameType | None) -> NoReturn:
    signal.signal(signal.SIGTERM, signal.SIG_DFL)
    raise Terminated


def require_writable(output: str | None) -> None:
    """Check that a file could be written, without touching it; None is stdout.

    Raises:
        OutputError: it cannot.
    """
    if output is None:
        return
    path = Path(output)
    folder = path.parent
    if path.is_dir():
        raise OutputError(f"{output}: is a folder; give a file in it")
    if not folder.is_dir():
        raise OutputError(f"{output}: cannot be written: there is no folder {folder}; make it, or choose another file")
    if not os.access(path if path.exists() else folder, os.W_OK):
        raise OutputError(f"{output}: cannot be written: no permission; choose another file")


def require_unrecorded(folder: str | None) -> None:
    """Check that a folder has no recordings yet, before anything is written: those of other tasks would be among them.

    Raises:
        OutputError: it has.
    """
    if folder is not None and any(Path(folder).glob("*.npz")):
        raise OutputError(f"{folder}: has recordings already; give a new folder, or remove them")


@contextmanager
def writer(output: str | None) -> Iterator[Callable[[str], None]]:
    """Yield a function that writes a line to a file, or to stdout; what was written stays, whatever happens later.

    Raises:
        OutputError: the file cannot be written.
    """
    try:
        stream: TextIO = open(output, "w", encoding="utf-8") if output else sys.stdout  # noqa: PTH123, SIM115
    except OSError as error:
        raise OutputError(f"{output}: cannot be written: {error.strerror}; choose another file") from None

    shown = not output and stream.isatty()

    def write(line: str) -> None:
        with _writing(output):
            stream.write(f"{_for_terminal(line) if shown else line}\n")

    try:
        with whole_lines():
            yield write
    finally:
        with _writing(output):
            stream.flush()
            if output:
                stream.close()


@contextmanager
def _writing(output: str | None) -> Iterator[None]:
    try:
        yield
    except BrokenPipeError:
        raise
    except OSError as error:
        raise OutputError(f"{output or 'stdout'}: cannot be written: {error.strerror}; free some space") from None


class Tell(Protocol):
    """Is told how far things are, in words and, where it is known, as a number of a total."""

    def __call__(self, words: str, done: float = 0, total: int | None = None) -> None:
        """Show it."""


@contextmanager
def progress() -> Iterator[Tell]:
    """Yield a function that is told how far things are; a terminal sees it once two seconds have passed."""
    if not sys.stderr.isatty():
        yield lambda words, done=0, total=None: None
        return
    begun = monotonic()
    shown: list[tuple[Progress, TaskID]] = []
    with ExitStack() as bars:

        def tell(words: str, done: float = 0, total: int | None = None) -> None:
            first = not shown
            if first:
                if monotonic() - begun <= PATIENCE:
                    return
                bar = bars.enter_context(_bar())
                shown.append((bar, bar.add_task("", total=None)))
            bar, number = shown[0]
            bar.update(number, description=plain(words.splitlines()[0]), completed=done, total=total, refresh=first)

        yield tell


def _bar() -> Progress:
    """Return a line on stderr that is gone in the end: a spinner, words, and a bar where there is a total."""
    from rich.console import Console
    from rich.progress import BarColumn, Progress, SpinnerColumn, Task, TextColumn, TimeRemainingColumn

    class Whole(BarColumn):
        """A bar that is left out where no total is known."""

        def render(self, task: Task) -> Any:
            return "" if task.total is None else super().render(task)

    columns = (SpinnerColumn(), TextColumn("{task.description}", markup=False), Whole(), TimeRemainingColumn())
    return Progress(*columns, console=Console(stderr=True), transient=True)
