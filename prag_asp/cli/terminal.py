"""Print lines and tables on stdout and stderr, and show progress on a terminal."""

from __future__ import annotations

import sys
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager, suppress
from threading import Event, RLock, Thread
from time import monotonic
from typing import TYPE_CHECKING, Any, Protocol

from prag_asp.errors import one_line, plain
from prag_asp.processes.progress_events import Note, hear, note, so_far

if TYPE_CHECKING:
    from rich.progress import Progress, TaskID

PATIENCE, LOG_EVERY, WATCH = 2.0, 60.0, 0.25
"""The times in seconds without output before a terminal shows progress, between two lines in a log, and between two
checks.
"""


def say(text: object) -> None:
    """Print lines on stdout; on a terminal, escape control characters other than tabs."""
    import click

    hide_progress()
    click.echo(for_terminal(str(text)) if sys.stdout is not None and sys.stdout.isatty() else str(text))


def tell_line(text: str) -> None:
    """Print one line on stderr, shortened, with control characters escaped."""
    import click  # not at the top, because the supervisor imports this module, and a fork copies all loaded modules

    hide_progress()
    click.echo(one_line(text), err=True)


def for_terminal(text: str) -> str:
    """Return lines with control characters other than tabs escaped."""
    return "\n".join("\t".join(map(plain, line.split("\t"))) for line in text.split("\n"))


def aligned(rows: Iterable[Sequence[str]]) -> Iterator[str]:
    """Yield the lines of a table, with the first column left-aligned and the others right-aligned."""
    listed = list(rows)
    widths = [max(map(len, column)) for column in zip(*listed, strict=True)]
    for first, *others in listed:
        cells = [f"{cell:>{width}}" for cell, width in zip(others, widths[1:], strict=True)]
        yield "  ".join([f"{first:<{widths[0]}}", *cells])


class Tell(Protocol):
    """A function that reports progress: a message and, if known, the number of finished items and the total."""

    def __call__(self, words: str, done: float = 0, total: int | None = None) -> None:
        """Report progress."""


class _Display:
    """The display of a command's activity: a line on a terminal, or a line per minute in a log file.

    On a terminal, the line appears once `PATIENCE` seconds have passed without any output. A thread watches the time,
    because native code may run for minutes without a report.
    """

    def __init__(self, on_terminal: bool) -> None:
        self._on_terminal = on_terminal
        self._wait = PATIENCE if on_terminal else LOG_EVERY
        self._lock = RLock()
        self._words, self._done = "starting", 0.0
        self._total: int | None = None
        self._quiet_since = monotonic()
        self._bar: tuple[Progress, TaskID] | None = None
        self._ended = Event()
        self._watching = Thread(target=self._watch, daemon=True)
        self._watching.start()

    def tell(self, words: str, done: float = 0, total: int | None = None) -> None:
        """Set the message and, if known, the number of finished items and the total."""
        with self._lock:
            self._words, self._done, self._total = _first_line(words), done, total
            if self._bar is not None or self._is_due():
                self._show()

    def hide(self) -> None:
        """Remove the progress line before output that may go to the same terminal."""
        with self._lock:
            if self._on_terminal:
                self._quiet_since = monotonic()
            if self._bar is not None:
                self._bar[0].stop()
                self._bar = None

    def end(self) -> None:
        """Remove the line permanently."""
        self._ended.set()
        self.hide()

    def _is_due(self) -> bool:
        return not self._ended.is_set() and monotonic() - self._quiet_since > self._wait

    def _watch(self) -> None:
        while not self._ended.wait(WATCH):
            with self._lock:
                if self._bar is None and self._is_due():
                    self._show()

    def _show(self) -> None:
        if not self._on_terminal:
            self._quiet_since = monotonic()
            done = "" if self._total is None else f" ({self._done:.0f} of {self._total})"
            with suppress(OSError):
                tell_line(f"... {self._words}{done}")
            return
        new = self._bar is None
        if self._bar is None:
            bar = _bar()
            self._bar = (bar, bar.add_task("", total=None))
            bar.start()
        bar, number = self._bar
        bar.update(number, description=plain(self._words), completed=self._done, total=self._total, refresh=new)


_display: _Display | None = None


@contextmanager
def shown_progress() -> Iterator[None]:
    """Show the activity of a command on stderr: on a terminal after 2 s without output, elsewhere once a minute."""
    global _display  # noqa: PLW0603  a process runs one command at a time
    if _display is not None or sys.stderr is None:
        yield
        return
    _display = _Display(sys.stderr.isatty())
    try:
        yield
    finally:
        _display.end()
        _display = None


@contextmanager
def progress() -> Iterator[Tell]:
    """Yield a function that reports progress, which `shown_progress` shows.

    A note is printed as a permanent line; equal notes are printed once.
    """
    printed: set[str] = set()

    def tell(words: str, done: float = 0, total: int | None = None) -> None:
        so_far(_first_line(words))
        if isinstance(words, Note) and words not in printed:
            printed.add(words)
            note(words)
        if _display is not None and not isinstance(words, Note):
            _display.tell(words, done, total)

    with shown_progress():
        yield tell


def end_progress() -> None:
    """Show no more progress, because the command now waits for requests."""
    if _display is not None:
        _display.end()


def hide_progress() -> None:
    """Remove the progress line before output that may go to the same terminal; it reappears after 2 s."""
    if _display is not None:
        _display.hide()


def _on_event(words: str) -> None:
    """Print a note, and show a stage."""
    if isinstance(words, Note):
        tell_line(_first_line(words))
    elif _display is not None:
        _display.tell(words)


hear(_on_event)


def _first_line(words: str) -> str:
    return words.partition("\n")[0]


def _bar() -> Progress:
    """Return a progress line on stderr, which is removed at the end: a spinner, a message, and a bar for a total."""
    from rich.console import Console
    from rich.progress import BarColumn, Progress, SpinnerColumn, Task, TextColumn, TimeRemainingColumn

    class KnownTotalBar(BarColumn):
        """A bar that is hidden while no total is known."""

        def render(self, task: Task) -> Any:
            return "" if task.total is None else super().render(task)

    columns = (SpinnerColumn(), TextColumn("{task.description}", markup=False), KnownTotalBar(), TimeRemainingColumn())
    return Progress(
        *columns, console=Console(stderr=True), transient=True, redirect_stdout=False, redirect_stderr=False
    )
