"""What the command shows beside its results: errors as one line and a code, how far things are."""

from __future__ import annotations

import gc
import signal
import sys
import threading
from _thread import start_new_thread
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from time import monotonic
from typing import TYPE_CHECKING, Any, NoReturn, Protocol

import click

from prag_asp.cli import exit_control
from prag_asp.cli.exit_control import ASKED, NO_MEMORY, Struck, Terminated
from prag_asp.cli.exits import Exit, exit_of
from prag_asp.errors import LimitReached, PragError, one_line, plain
from prag_asp.processes.progress_events import Note, hear, note, so_far

if TYPE_CHECKING:
    from types import FrameType

    from rich.progress import Progress, TaskID

COLLECT = (100_000, 50, 100)
"""A ground program is a great many small values without cycles, among which looking for garbage is a waste of time."""

PATIENCE = 2.0
"""Seconds before a terminal is shown how far things are."""


def say(text: object) -> None:
    """Print lines on stdout; a terminal gets no character that it would obey, but for tabs."""
    click.echo(for_terminal(str(text)) if sys.stdout is not None and sys.stdout.isatty() else str(text))


def tell_line(text: str) -> None:
    """Print one line on stderr, which is short and has no character that a terminal would obey, whatever it quotes."""
    click.echo(one_line(text), err=True)


def for_terminal(text: str) -> str:
    """Return lines without characters that a terminal would obey, but for tabs."""
    return "\n".join("\t".join(map(plain, line.split("\t"))) for line in text.split("\n"))


def _show_usage(error: click.ClickException) -> None:
    """Say in one line what is wrong with a command line; one without words gets the help that it asks for."""
    context = error.ctx if isinstance(error, click.UsageError) else None
    if isinstance(error, getattr(click.exceptions, "NoArgsIsHelpError", ())) or context is None:
        error.show()
        return
    told = " ".join(error.format_message().split()).rstrip(".")
    tell_line(f"{context.command_path}: {told}; see {context.command_path} --help")


class Command(click.Group):
    """Turns errors into one line on stderr, and an interruption into a quiet end."""

    def invoke(self, ctx: click.Context) -> Any:
        """Run what the line asks for; a closed pipe ends it here, for click would choose another code."""
        try:
            return super().invoke(ctx)
        except BrokenPipeError as error:
            raise click.exceptions.Exit(_end(error)) from None

    def main(self, *args: Any, **kwargs: Any) -> Any:
        """Run the command and return its exit code."""
        if hasattr(sys, "set_int_max_str_digits"):
            sys.set_int_max_str_digits(0)
        gc.set_threshold(*COLLECT)
        exit_control.begin()
        try:
            with _insisting():
                return super().main(*args, **{**kwargs, "standalone_mode": False}) or 0
        except click.exceptions.Exit as stop:
            return stop.exit_code
        except click.ClickException as error:
            _show_usage(error)
            return Exit.USAGE if isinstance(error, click.UsageError) else Exit.BAD_INPUT
        except (click.Abort, KeyboardInterrupt, Struck, PragError, OSError, RecursionError, *NO_MEMORY) as error:
            return _end(error)
        except Exception as error:
            if _interruption(error) is not None:
                return _end(error)
            if not exit_control.memory_refused(error):
                raise
            return _end(MemoryError())


@contextmanager
def _insisting() -> Iterator[None]:
    """Have an interruption that Python drops, since it comes while a value is being freed, come again after that.

    Of memory that is refused just then, nothing is told: what is freed has been of use.
    """
    usual = sys.unraisablehook

    def again(dropped: sys.UnraisableHookArgs) -> None:
        number = next((each for each, kind in ASKED.items() if type(dropped.exc_value) is kind), None)
        if number is None:
            torn = exit_control.asked_for() is not None  # it comes of what was left half-way
            if not torn and not isinstance(dropped.exc_value, NO_MEMORY):
                usual(dropped)
            return
        if exit_control.supervised():
            exit_control.answer_again()
        elif number == signal.SIGTERM:
            signal.signal(signal.SIGTERM, _terminate)
        start_new_thread(exit_control.send_later, (number,))

    sys.unraisablehook = again
    try:
        yield
    finally:
        sys.unraisablehook = usual


def _end(error: BaseException) -> int:
    """Say on stderr why the command ends, once, and return its exit code."""
    if isinstance(error, BrokenPipeError):
        sys.stdout = None  # nothing more can be flushed into it
        return Exit.OUTPUT
    exit_control.deafen()
    code = _tell_end(error)
    exit_control.said()
    return code


def _tell_end(error: BaseException) -> int:
    """Say on stderr why the command ends, and return its exit code."""
    interruption = _interruption(error)
    if interruption is not None:
        return _end_asked(interruption)
    if exit_control.caused_by_memory(error) and not isinstance(error, LimitReached):
        tell_line(exit_control.out_of_memory())
        return Exit.LIMIT
    if isinstance(error, RecursionError):
        tell_line(exit_control.too_deep())
        return Exit.BAD_INPUT
    if isinstance(error, OSError):
        tell_line(f"{error.filename or 'stdout'}: {error.strerror or error}")
        return Exit.BAD_INPUT if error.filename else Exit.OUTPUT
    assert isinstance(error, PragError)
    for line in error.lines:
        tell_line(line)
    return exit_of(error)


def _interruption(error: BaseException) -> type[BaseException] | None:
    """Return what interrupted the command, be it that an error of foreign code or of Python wraps it, or None."""
    for each in (error.__cause__, error):
        if each is not None and isinstance(each, (*ASKED.values(), click.Abort)):
            return exit_control.asked_for() or type(each)
    return exit_control.asked_for()


def _end_asked(kind: type[BaseException]) -> Exit:
    """Say that the command ends since it was asked to, and return its exit code."""
    told = {Terminated: ("terminated", Exit.TERMINATED), Struck: (exit_control.struck(), Exit.LIMIT)}
    line, code = told.get(kind, ("interrupted", Exit.INTERRUPTED))
    click.echo(line, err=True)
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


class Tell(Protocol):
    """Is told how far things are, in words and, where it is known, as a number of a total."""

    def __call__(self, words: str, done: float = 0, total: int | None = None) -> None:
        """Show it."""


@contextmanager
def progress() -> Iterator[Tell]:
    """Yield a function that is told how far things are; a terminal sees it once two seconds have passed.

    A note is a line of its own that stays, on a terminal and elsewhere; the same one is told once.
    """
    noted: set[str] = set()

    def pass_on(words: str) -> None:
        so_far(_line(words))
        if isinstance(words, Note) and words not in noted:
            noted.add(words)
            note(words)

    if sys.stderr is None or not sys.stderr.isatty():
        yield lambda words, done=0, total=None: pass_on(words)
        return
    begun = monotonic()
    shown: list[tuple[Progress, TaskID]] = []
    with ExitStack() as bars:

        def tell(words: str, done: float = 0, total: int | None = None) -> None:
            pass_on(words)
            first = not shown
            if first:
                if monotonic() - begun <= PATIENCE:
                    return
                bar = bars.enter_context(_bar())
                shown.append((bar, bar.add_task("", total=None)))
            bar, number = shown[0]
            bar.update(number, description=plain(_line(words)), completed=done, total=total, refresh=first)

        yield tell


def _tell_note(words: str) -> None:
    if isinstance(words, Note):
        tell_line(_line(words))


hear(_tell_note)


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
