"""A journal: lines that a run has finished since it last wrote a result, for the next run to resume from there.

Each line has a checksum, so a kill or a loss of power at any moment costs the lines that were not flushed: the next run
believes those before the first damaged one. The first line names the run; a journal of another run is emptied.
"""

from __future__ import annotations

import os
import zlib
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path
from time import monotonic

from prag_asp.output.atomic_file import open_locked, output_errors, write_at

INTERVAL = 1.0
"""Seconds between flushes, which cost some milliseconds each: what a loss of power takes at most."""

CHECKSUM = 8
"""Hexadecimal digits before each line."""


class Journal:
    """The journal of a run, locked until it is closed."""

    def __init__(self, file: Path, run: str) -> None:
        """Open the journal with the lines that an interrupted run of the same name has left, or create it.

        Raises:
            OutputError: it cannot be written, or another run is writing it.
        """
        self._file, self._header = file, _checked(run.encode())
        with output_errors(file):
            self._descriptor = open_locked(file)
            try:
                self.lines = [*self._left()]
                self._size = len(self._header) + sum(len(_checked(line)) for line in self.lines)
                if self.lines:
                    os.ftruncate(self._descriptor, self._size)
                else:
                    self._begin()
            except BaseException:
                os.close(self._descriptor)
                raise
        self._next = monotonic() + INTERVAL

    def write(self, line: bytes) -> None:
        """Append a line, which has no line end.

        Raises:
            OutputError: it cannot be written.
        """
        content = _checked(line)
        with output_errors(self._file):
            write_at(self._descriptor, content, self._size)
            self._size += len(content)
            if monotonic() >= self._next:
                os.fsync(self._descriptor)
                self._next = monotonic() + INTERVAL

    def clear(self) -> None:
        """Forget all lines.

        Raises:
            OutputError: it cannot be written.
        """
        with output_errors(self._file):
            self._begin()

    def close(self) -> None:
        """Release the lock; a journal without lines is removed."""
        if self._size == len(self._header):
            with suppress(OSError):
                self._file.unlink()
        os.close(self._descriptor)

    def _begin(self) -> None:
        """Write the name of the run alone."""
        os.ftruncate(self._descriptor, 0)
        write_at(self._descriptor, self._header, 0)
        self._size = len(self._header)

    def _left(self) -> Iterator[bytes]:
        """Yield the lines that an interrupted run has left, as far as they can be believed."""
        with open(self._descriptor, "rb", closefd=False) as file:
            if file.readline() != self._header:
                return
            for content in file:
                line = content[CHECKSUM:-1]
                if content != _checked(line):
                    return
                yield line


def _checked(line: bytes) -> bytes:
    """Return a line with its checksum and a line end."""
    return b"%08x%b\n" % (zlib.crc32(line), line)
