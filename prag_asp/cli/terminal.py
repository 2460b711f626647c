"""What the command shows: lines on stdout or in a file, everything else on stderr, errors as one line and a code."""

from __future__ import annotations

import gc
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any, TextIO

import click

from prag_asp.errors import LimitReached, OutputError, PragError

FAILED, BAD_INPUT, LIMITED, INTERRUPTED = 1, 2, 3, 130
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
        try:
            return super().main(*args, **{**kwargs, "standalone_mode": False}) or 0
        except click.exceptions.Exit as stop:
            return stop.exit_code
        except click.ClickException as error:
            error.show()
            return error.exit_code
        except (click.Abort, KeyboardInterrupt, PragError, OSError) as error:
            return _end(error)


def _end(error: BaseException) -> int:
    """Say on stderr why the command ends, and return its exit code."""
    if isinstance(error, BrokenPipeError):
        sys.stdout = None  # nothing more can be flushed into it
        return FAILED
    if isinstance(error, (click.Abort, KeyboardInterrupt)):
        click.echo("interrupted", err=True)
        return INTERRUPTED
    if isinstance(error, OSError):
        click.echo(f"{error.filename or 'output'}: {error.strerror or error}", err=True)
        return FAILED
    click.echo(str(error), err=True)
    if isinstance(error, LimitReached):
        return LIMITED
    return FAILED if isinstance(error, OutputError) else BAD_INPUT


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


@contextmanager
def progress() -> Iterator[Callable[[str], None]]:
    """Yield a function that is told how far things are; a terminal sees it once two seconds have passed."""
    if not sys.stderr.isatty():
        yield lambda words: None
        return
    from time import monotonic

    from rich.console import Console
    from rich.status import Status

    status = Status("", console=Console(stderr=True))
    begun = monotonic()
    started = False

    def tell(words: str) -> None:
        nonlocal started
        if not started and monotonic() - begun > PATIENCE:
            status.start()
            started = True
        if started:
            status.update(words.splitlines()[0])

    try:
        yield tell
    finally:
        status.stop()


@contextmanager
def bar(what: str, total: int) -> Iterator[Callable[[float], None]]:
    """Yield a function that is told how many of `total` are done; a terminal sees a bar once two seconds have passed.

    A part of one counts as a share.
    """
    if not sys.stderr.isatty():
        yield lambda done: None
        return
    from time import monotonic

    from rich.console import Console
    from rich.progress import Progress

    begun = monotonic()
    with Progress(console=Console(stderr=True), transient=True) as shown:
        task = shown.add_task(what, total=total, visible=False)
        yield lambda done: shown.update(task, completed=done, visible=monotonic() - begun > PATIENCE)
