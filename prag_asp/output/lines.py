"""A file of lines that is written whole, and goes on where a run that wrote the same was broken off.

Its lines go to ``NAME.part``. Beside that, ``NAME.run`` says of which run they are (a digest of all that has a say in
the bytes), how many bytes of them can be trusted, their checksum, and a state from which the run can go on. It is
written once a second, after what it speaks of was flushed. So a kill or a loss of power at any moment costs what came
since: the next run cuts it off. In the end ``NAME.part`` becomes the file, and ``NAME.run`` goes.
"""

from __future__ import annotations

import json
import zlib
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path
from time import monotonic
from typing import Any

from prag_asp.output.atomic_files import behind, replace_file, told
from prag_asp.output.partial_file import Part
from prag_asp.safe_reading import read_bytes

SUFFIX = ".run"
VERSION = 1

INTERVAL = 1.0
"""Seconds from one note of how far the run is to the next; more where that takes more than a tenth of it."""

HELD = 1 << 20
"""Bytes that are held back at most."""


@dataclass(frozen=True)
class _Written:
    """What is in the file, and the lines that are not yet, each with the state after it.

    It is replaced as one value and only its list grows, so that an interruption at any moment finds it as a whole.
    """

    size: int = 0
    checksum: int = 0
    lines: int = 0
    state: Any = None
    waiting: list[tuple[bytes, Any]] = field(default_factory=list)


class Lines:
    """Writes the lines of a file; `lines` and `state` tell where to go on.

    Whoever writes calls `finish` at the end, or `suspend` where there is to be none yet.
    """

    def __init__(self, file: str | Path, run: str | None = None) -> None:
        """Take up what a broken run has left, or begin anew; without a `run`, nothing is left for another.

        Raises:
            OutputError: the file cannot be written, or another run is writing it.
        """
        self._file, self._run = Path(file), run
        with told(self._file):
            target = behind(self._file)
            self._part = Part(target)
            self._note = target.with_name(target.name + SUFFIX)
            try:
                self._written = self._left() or _Written()
                self._part.cut(self._written.size)
            except BaseException:
                self._part.close()
                raise
        self._held = 0
        self._next = monotonic() + INTERVAL

    @property
    def part(self) -> Path:
        """The file that has them until they are whole."""
        return self._part.path

    @property
    def lines(self) -> int:
        """How many lines were written, by a broken run too."""
        return self._written.lines + sum(1 for content, _ in self._written.waiting if content)

    @property
    def state(self) -> Any:
        """The state after what was written, as it was given; None before anything was."""
        return self._written.waiting[-1][1] if self._written.waiting else self._written.state

    def restart(self) -> None:
        """Forget what a broken run has left."""
        with told(self._file):
            self._written = _Written()
            self._part.cut(0)

    def write(self, line: str | None, state: Any = None) -> None:
        """Write a line, or none, together with the state after it, a value of JSON.

        Raises:
            OutputError: it cannot be written.
        """
        content = b"" if line is None else f"{line}\n".encode()
        self._written.waiting.append((content, state))
        self._held += len(content)
        now = monotonic()
        if self._run is not None and now >= self._next:
            self._note_down()
            self._next = monotonic() + max(INTERVAL, 10 * (monotonic() - now))
        elif self._held >= HELD:
            with told(self._file):
                self._pour()

    def finish(self) -> None:
        """Put what was written into the place of the file.

        Raises:
            OutputError: it cannot be written.
        """
        with told(self._file):
            self._pour()
            self._part.replace()
            self._forget()

    def suspend(self) -> None:
        """Keep what was written for the next run of the same, as far as that can be kept."""
        if self._run is None or not (self._written.size or self.state or self._written.waiting):
            self._part.discard()
            self._forget()
            return
        with suppress(Exception):
            self._note_down()

    def close(self) -> None:
        """Let others write the file."""
        self._part.close()

    def _pour(self) -> None:
        """Write what waits; done once more, it does the same."""
        written = self._written
        taken = written.waiting[:]
        content = b"".join([each for each, _ in taken])
        self._part.write(content, written.size)
        self._written = _Written(
            written.size + len(content),
            zlib.crc32(content, written.checksum),
            written.lines + sum(1 for each, _ in taken if each),
            taken[-1][1] if taken else written.state,
        )
        self._held = 0

    def _note_down(self) -> None:
        """Flush what was written, and note how far that is."""
        with told(self._file):
            self._pour()
            self._part.flush()
        written = self._written
        told_of = [VERSION, self._run, written.size, written.checksum, written.lines, written.state]
        replace_file(self._note, json.dumps([_checked(told_of), *told_of]).encode(), follow=False)

    def _left(self) -> _Written | None:
        """Return what a broken run of the same has left, as far as it can be believed."""
        if self._run is None:
            return None
        try:
            checked, *told_of = json.loads(read_bytes(self._note))
            version, run, *values = told_of
            left = _Written(*values)
            same = (checked, version, run) == (_checked(told_of), VERSION, self._run)
            if same and left.size <= self._part.size and self._part.checksum(left.size) == left.checksum:
                return left
        except (OSError, ValueError, TypeError, RecursionError):
            pass
        return None

    def _forget(self) -> None:
        for path in (self._note, self._note.with_name(f"{self._note.name}.part")):
            with suppress(OSError):
                path.unlink()


def _checked(values: list[Any]) -> int:
    """Return the checksum of what a note says."""
    return zlib.crc32(json.dumps(values).encode())
