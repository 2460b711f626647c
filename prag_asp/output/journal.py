"""A journal: the lines that a run has completed since it last wrote a result, from which the next run resumes.

Each line has a checksum, so if the process is killed or power fails, only the lines that were not flushed are lost: the
next run uses the lines before the first damaged one. The first line names the run. A journal that names a different run
is emptied.
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
"""Seconds between flushes, which take a few milliseconds each; a power failure loses at most the lines of one interval.
"""

CHECKSUM = 8
"""The number of hexadecimal digits of the checksum before each line."""


class Journal:
    """The journal of a run, locked until it is closed."""

    def __init__(self, file: Path, run: str) -> None:
        """Open the journal with the lines of an interrupted run that has the same name, or create it.

        Raises:
            OutputError: the journal cannot be written, or another run is writing it.
        """
        self._file, self._header = file, _checked(run.encode())
        with output_errors(file):
            self._descriptor = open_locked(file)
            try:
                self.lines = [*self._valid_lines()]
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
        """Append a line, given without its line ending.

        Raises:
            OutputError: the journal cannot be written.
        """
        content = _checked(line)
        with output_errors(self._file):
            write_at(self._descriptor, content, self._size)
            self._size += len(content)
            if monotonic() >= self._next:
                os.fsync(self._descriptor)
                self._next = monotonic() + INTERVAL

    def clear(self) -> None:
        """Remove all lines.

        Raises:
            OutputError: the journal cannot be written.
        """
        with output_errors(self._file):
            self._begin()

    def close(self) -> None:
        """Release the lock, and remove the journal if it has no lines."""
        if self._size == len(self._header):
            with suppress(OSError):
                self._file.unlink()
        os.close(self._descriptor)

    def _begin(self) -> None:
        """Reset the journal to a single line with the name of the run."""
        os.ftruncate(self._descriptor, 0)
        write_at(self._descriptor, self._header, 0)
        self._size = len(self._header)

    def _valid_lines(self) -> Iterator[bytes]:
        """Yield the lines of an interrupted run before the first damaged one."""
        with open(self._descriptor, "rb", closefd=False) as file:
            if file.readline() != self._header:
                return
            for content in file:
                line = content[CHECKSUM:-1]
                if content != _checked(line):
                    return
                yield line


def _checked(line: bytes) -> bytes:
    """Return a line with its checksum and a line ending."""
    return b"%08x%b\n" % (zlib.crc32(line), line)
