"""Lines on stdout or in a file, which is written whole, and goes on where the same run was broken off."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any, Protocol

from prag_asp.cli.terminal import for_terminal, tell_line
from prag_asp.errors import OutputError
from prag_asp.output import Lines
from prag_asp.output.atomic_files import is_stream, told
from prag_asp.wording import plural


class Writer(Protocol):
    """Takes lines; `lines` and `state` say what a run that was broken off has written."""

    @property
    def lines(self) -> int:
        """How many lines there are."""
        ...

    @property
    def state(self) -> Any:
        """The state after them, as it was written, or None."""
        ...

    def write(self, line: str | None, state: Any = None) -> None:
        """Write a line, or none, and what the state is then."""
        ...


class _Stream:
    """Lines that go out as they come, and are not taken back."""

    lines, state = 0, None

    def __init__(self, stream: Any, name: str) -> None:
        self._stream, self._name = stream, name
        self._shown = stream is not None and stream is sys.stdout and stream.isatty()

    def write(self, line: str | None, state: Any = None) -> None:
        """Write a line."""
        if line is not None:
            with told(self._name):
                self._stream.write(f"{for_terminal(line) if self._shown else line}\n")
                if state is not None:  # what takes long is shown at once
                    self._stream.flush()


Fits = Callable[[int, Any], bool]
"""Tells whether a run can go on after so many lines, in a state."""


@contextmanager
def writer(output: str | None, run: str | None = None, fits: Fits = lambda lines, state: True) -> Iterator[Writer]:
    """Yield what writes lines to a file, or to stdout.

    The file is replaced at the end, as a whole. What is written until the block is broken off stays beside it for the
    next run of the same name that it `fits`; without a `run`, nothing stays. What goes to stdout, to a device or to a
    pipe is gone.

    Raises:
        OutputError: the file cannot be written.
    """
    if output is None or is_stream(Path(output)):
        with _stream(output) as stream:
            yield stream
    else:
        yield from _file(output, run, fits)


@contextmanager
def _stream(output: str | None) -> Iterator[_Stream]:
    name = output or "stdout"
    with told(name):
        stream = open(output, "w", encoding="utf-8") if output else sys.stdout  # noqa: PTH123, SIM115
    try:
        yield _Stream(stream, name)
    finally:
        with told(name):
            stream.flush()
            if output:
                stream.close()


def _file(output: str, run: str | None, fits: Fits) -> Iterator[Writer]:
    from prag_asp.processes.workers import uninterrupted

    lines = Lines(output, run)
    try:
        if not fits(lines.lines, lines.state):
            lines.restart()
        if lines.lines:
            tell_line(f"{output}: goes on after {plural(lines.lines, 'line')} of the same run")
        yield lines
        with uninterrupted():
            lines.finish()
    except BaseException:
        with uninterrupted():
            lines.suspend()
        if lines.lines and run is not None:
            kept = f"{lines.part} keeps {plural(lines.lines, 'line')}; the same command goes on from there"
            tell_line(kept)
        raise
    finally:
        lines.close()


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
    if path.exists() and not os.access(path, os.W_OK):
        raise OutputError(f"{output}: cannot be written: no permission; choose another file")
    if not is_stream(path) and not os.access(path.resolve().parent, os.W_OK):
        raise OutputError(f"{output}: cannot be written: no permission for its folder; choose another file")
