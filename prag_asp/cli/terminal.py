"""Print lines on stdout and stderr, tables, and progress on a terminal."""

from __future__ import annotations

import sys
from collections.abc import Iterable, Iterator, Sequence
from contextlib import ExitStack, contextmanager
from time import monotonic
from typing import TYPE_CHECKING, Any, Protocol

from prag_asp.errors import one_line, plain
from prag_asp.processes.progress_events import Note, hear, note, so_far

if TYPE_CHECKING:
    from rich.progress import Progress, TaskID

PATIENCE = 2.0
"""Seconds before a terminal shows progress."""


def say(text: object) -> None:
    """Print lines on stdout; on a terminal, escape control characters other than tabs."""
    import click

    click.echo(for_terminal(str(text)) if sys.stdout is not None and sys.stdout.isatty() else str(text))


def tell_line(text: str) -> None:
    """Print one line on stderr, shortened, with control characters escaped."""
    import click  # not above: the supervisor imports this module, and a fork copies all loaded modules

    click.echo(one_line(text), err=True)


def for_terminal(text: str) -> str:
    """Return lines with control characters other than tabs escaped."""
    return "\n".join("\t".join(map(plain, line.split("\t"))) for line in text.split("\n"))


def aligned(rows: Iterable[Sequence[str]]) -> Iterator[str]:
    """Yield the lines of a table with the first column left-aligned, others right-aligned; rows have equal lengths."""
    listed = list(rows)
    widths = [max(map(len, column)) for column in zip(*listed, strict=True)]
    for first, *others in listed:
        cells = [f"{cell:>{width}}" for cell, width in zip(others, widths[1:], strict=True)]
        yield "  ".join([f"{first:<{widths[0]}}", *cells])


class Tell(Protocol):
    """Reports progress: a message and, if they are known, the number done and the total."""

    def __call__(self, words: str, done: float = 0, total: int | None = None) -> None:
        """Report progress."""


@contextmanager
def progress() -> Iterator[Tell]:
    """Yield a function that reports progress; a terminal shows it after two seconds.

    A note is a permanent line, on a terminal and elsewhere; equal notes are printed once.
    """
    printed: set[str] = set()

    def forward(words: str) -> None:
        so_far(_first_line(words))
        if isinstance(words, Note) and words not in printed:
            printed.add(words)
            note(words)

    if not sys.stderr.isatty():
        yield lambda words, done=0, total=None: forward(words)
        return
    begun = monotonic()
    shown: list[tuple[Progress, TaskID]] = []
    with ExitStack() as bars:

        def tell(words: str, done: float = 0, total: int | None = None) -> None:
            forward(words)
            first = not shown
            if first:
                if monotonic() - begun <= PATIENCE:
                    return
                bar = bars.enter_context(_bar())
                shown.append((bar, bar.add_task("", total=None)))
            bar, number = shown[0]
            bar.update(number, description=plain(_first_line(words)), completed=done, total=total, refresh=first)

        yield tell


hear(lambda words: tell_line(_first_line(words)) if isinstance(words, Note) else None)


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
    return Progress(*columns, console=Console(stderr=True), transient=True)
