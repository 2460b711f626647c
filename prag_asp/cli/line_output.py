"""Write lines to stdout, or atomically to a file."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any, Protocol

from prag_asp.cli.terminal import for_terminal, hide_progress
from prag_asp.errors import OutputError
from prag_asp.output import new_folder, open_atomic
from prag_asp.output.atomic_file import AtomicFile, is_stream, output_errors

BUFFER = 1 << 20
"""The number of bytes of lines that are buffered before they are written to a file."""


class Writer(Protocol):
    """A writer of lines."""

    def write(self, line: str, *, flush: bool = False) -> None:
        """Write a line; with `flush`, a stream is flushed after it."""
        ...


class _StreamWriter:
    """A writer of lines to a stream."""

    def __init__(self, stream: Any, name: str) -> None:
        self._stream, self._name = stream, name
        self._shown = stream is not None and stream is sys.stdout and stream.isatty()

    def write(self, line: str, *, flush: bool = False) -> None:
        """Write a line."""
        if self._shown:
            hide_progress()
        with output_errors(self._name):
            self._stream.write(f"{for_terminal(line) if self._shown else line}\n")
            if flush:
                self._stream.flush()


class _FileWriter:
    """A writer of lines to a file, in batches."""

    def __init__(self, file: AtomicFile) -> None:
        self._file, self._buffer = file, bytearray()

    def write(self, line: str, *, flush: bool = False) -> None:
        """Write a line."""
        self._buffer += f"{line}\n".encode()
        if len(self._buffer) >= BUFFER:
            self.flush()

    def flush(self) -> None:
        """Write the buffered lines."""
        self._file.write(bytes(self._buffer))
        self._buffer.clear()


@contextmanager
def writer(output: str | None) -> Iterator[Writer]:
    """Yield a writer of lines to a file, or to stdout; the file is replaced as a whole when the block ends.

    Raises:
        OutputError: the file cannot be written.
    """
    if output is None or is_stream(Path(output)):
        with _stream(output) as stream:
            yield stream
    else:
        with open_atomic(output) as file:
            lines = _FileWriter(file)
            yield lines
            lines.flush()


@contextmanager
def _stream(output: str | None) -> Iterator[_StreamWriter]:
    name = output or "stdout"
    with output_errors(name):
        stream = open(output, "w", encoding="utf-8") if output else sys.stdout  # noqa: PTH123, SIM115
    try:
        yield _StreamWriter(stream, name)
    finally:
        with output_errors(name):
            stream.flush()
            if output:
                stream.close()


@contextmanager
def recordings_folder(folder: str | None) -> Iterator[Path | None]:
    """Yield a folder for recordings, which is written atomically, or None if `folder` is None.

    Raises:
        OutputError: the folder exists and is not empty, or cannot be written.
    """
    if folder is None:
        yield None
        return
    with new_folder(Path(folder)) as recordings:
        yield recordings


def require_writable(output: str | None) -> None:
    """Check that a file can be written, without changing it; None means stdout.

    Raises:
        OutputError: the file cannot be written.
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
