"""What the command shows: lines on stdout or in a file, everything else on stderr, errors as one line and a code."""

from __future__ import annotations

import gc
import os
import signal
import sys
import threading
from _thread import start_new_thread
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path
from time import monotonic
from typing import TYPE_CHECKING, Any, NoReturn, Protocol, TextIO

import click

from prag_asp.cli import ending
from prag_asp.cli.ending import (
    ASKED,
    BAD_INPUT,
    FAILED,
    INTERRUPTED,
    LIMITED,
    TERMINATED,
    Struck,
    Terminated,
)
from prag_asp.errors import LimitReached, OutputError, PragError
from prag_asp.stage import so_far

if TYPE_CHECKING:
    from types import FrameType

    from rich.progress import Progress, TaskID

COLLECT = (100_000, 50, 100)
"""A ground program is a great many small values without cycles, among which looking for garbage is a waste of time."""

PATIENCE = 2.0
"""Seconds before a terminal is shown how far things are."""


class Command(click.Group):
    """Turns errors into one line on stderr, and an interruption into a quiet end."""

    def main(self, *args: Any, **kwargs: Any) -> Any:
        """Run the command and return its exit code."""
        if hasattr(sys, "set_int_max_str_digits"):
            sys.set_int_max_str_digits(0)
        gc.set_threshold(*COLLECT)
        ending.begin()
        try:
            with _insisting():
                return super().main(*args, **{**kwargs, "standalone_mode": False}) or 0
        except click.exceptions.Exit as stop:
            return stop.exit_code
        except click.ClickException as error:
            error.show()
            return error.exit_code
        except (click.Abort, KeyboardInterrupt, Struck, PragError, OSError, MemoryError, RecursionError) as error:
            return _end(error)
        except Exception as error:
            if _interruption(error) is None:
                raise
            return _end(error)


@contextmanager
def _insisting() -> Iterator[None]:
    """Have an interruption that Python drops, since it comes while a value is being freed, come again after that."""
    usual = sys.unraisablehook

    def again(dropped: sys.UnraisableHookArgs) -> None:
        number = next((each for each, kind in ASKED.items() if type(dropped.exc_value) is kind), None)
        if number is None:
            usual(dropped)
            return
        if ending.supervised():
            ending.answer_again()
        elif number == signal.SIGTERM:
            signal.signal(signal.SIGTERM, _terminate)
        start_new_thread(ending.send_later, (number,))

    sys.unraisablehook = again
    try:
        yield
    finally:
        sys.unraisablehook = usual


def _end(error: BaseException) -> int:
    """Say on stderr why the command ends, and return its exit code."""
    if isinstance(error, BrokenPipeError):
        sys.stdout = None  # nothing more can be flushed into it
        return FAILED
    interruption = _interruption(error)
    if interruption is not None:
        return _end_asked(interruption)
    if isinstance(error, (MemoryError, RecursionError)):
        click.echo(ending.out_of_memory() if isinstance(error, MemoryError) else ending.too_deep(), err=True)
        return LIMITED if isinstance(error, MemoryError) else BAD_INPUT
    if isinstance(error, OSError):
        click.echo(f"{error.filename or 'output'}: {error.strerror or error}", err=True)
        return BAD_INPUT if isinstance(error, (FileNotFoundError, IsADirectoryError)) else FAILED
    click.echo(str(error), err=True)
    if isinstance(error, LimitReached):
        return LIMITED
    return FAILED if isinstance(error, OutputError) else BAD_INPUT


def _interruption(error: BaseException) -> type[BaseException] | None:
    """Return what interrupted the command, be it that an error of foreign code or of Python wraps it, or None."""
    for each in (error.__cause__, error):
        if each is not None and isinstance(each, (*ASKED.values(), click.Abort)):
            return ending.asked_for() or type(each)
    return ending.asked_for()


def _end_asked(kind: type[BaseException]) -> int:
    """Say that the command ends since it was asked to, and return its exit code."""
    told = {Terminated: ("terminated", TERMINATED), Struck: (ending.struck(), LIMITED)}
    line, code = told.get(kind, ("interrupted", INTERRUPTED))
    click.echo(line, err=True)
    ending.said()
    return code


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

    def write(line: str) -> None:
        with _writing(output):
            stream.write(f"{line}\n")

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
    if sys.stderr is None or not sys.stderr.isatty():
        yield lambda words, done=0, total=None: so_far(_line(words))
        return
    begun = monotonic()
    shown: list[tuple[Progress, TaskID]] = []
    with ExitStack() as bars:

        def tell(words: str, done: float = 0, total: int | None = None) -> None:
            so_far(_line(words))
            first = not shown
            if first:
                if monotonic() - begun <= PATIENCE:
                    return
                bar = bars.enter_context(_bar())
                shown.append((bar, bar.add_task("", total=None)))
            bar, number = shown[0]
            bar.update(number, description=_line(words), completed=done, total=total, refresh=first)

        yield tell


def _line(words: str) -> str:
    return words.partition("\n")[0]


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
