"""A file beside another one that takes its place when it is whole.

A rename replaces a file in one stroke, and what was flushed before it outlives a loss of power: whoever looks at the
file at whatever moment sees the old one or the new one, whole. A kill leaves the old one, and ``NAME.part`` beside it.
"""

from __future__ import annotations

import errno
import fcntl
import os
import stat
import zlib
from contextlib import suppress
from pathlib import Path
from time import monotonic, sleep

from prag_asp.errors import OutputError

SUFFIX = ".part"
EVERYBODY = 0o666
"""The permissions of a new file, of which the user's mask takes some."""

PATIENCE = 3.0
"""Seconds to wait for another run that writes the same file: one that was killed may take that long to be gone."""

BLOCK = 1 << 20
NO_LOCKS = (errno.ENOLCK, errno.ENOTSUP, errno.ENOSYS)
NO_FLUSH = (errno.EINVAL, errno.ENOTSUP, errno.EACCES)
"""What a file system answers that cannot flush a folder."""


class Part:
    """``NAME.part`` beside a file, open; no other run writes it meanwhile."""

    def __init__(self, target: Path, mode: int = EVERYBODY) -> None:
        """Open it with what it holds, or make it.

        Raises:
            OutputError: another run writes it, or it is no file.
            OSError: it cannot be made.
        """
        self.target = target
        self.path = target.with_name(target.name + SUFFIX)
        self._descriptor = _opened(self.path, mode)

    @property
    def size(self) -> int:
        """How many bytes it holds."""
        return os.fstat(self._descriptor).st_size

    def checksum(self, size: int) -> int:
        """Return the checksum of its first bytes, so many."""
        found = 0
        for begin in range(0, size, BLOCK):
            found = zlib.crc32(os.pread(self._descriptor, min(BLOCK, size - begin), begin), found)
        return found

    def write(self, content: bytes | memoryview, at: int) -> None:
        """Write bytes from a place on: the same once more does no harm."""
        left = memoryview(content)
        while left:
            written = os.pwrite(self._descriptor, left, at)
            left, at = left[written:], at + written

    def cut(self, size: int) -> None:
        """Leave its first bytes alone, so many."""
        os.ftruncate(self._descriptor, size)

    def flush(self) -> None:
        """Have all that was written outlive a loss of power."""
        os.fsync(self._descriptor)

    def replace(self) -> None:
        """Put it into the place of the file, with the permissions of that."""
        with suppress(OSError):
            os.fchmod(self._descriptor, stat.S_IMODE(self.target.stat().st_mode))
        self.flush()
        self.path.replace(self.target)
        flush_folder(self.target.parent)

    def discard(self) -> None:
        """Remove it."""
        with suppress(OSError):
            self.path.unlink()

    def close(self) -> None:
        """Let others write it."""
        os.close(self._descriptor)


def _opened(path: Path, mode: int) -> int:
    """Return the descriptor of a file that is ours alone."""
    until = monotonic() + PATIENCE
    while True:
        descriptor = os.open(path, os.O_RDWR | os.O_CREAT | os.O_CLOEXEC | os.O_NOFOLLOW | os.O_NONBLOCK, mode)
        try:
            if not stat.S_ISREG(os.fstat(descriptor).st_mode):
                raise OutputError(f"{path}: is no file, but one has to be written there; remove it")
            if _locked(descriptor) and _is_at(descriptor, path):
                return descriptor
        except BaseException:
            os.close(descriptor)
            raise
        os.close(descriptor)
        if monotonic() > until:
            raise OutputError(f"{path}: another run is writing it; wait until it ends, or choose another file")
        sleep(0.02)


def _locked(descriptor: int) -> bool:
    """Lock a file, and tell whether nobody else has; where there are no locks, nobody has."""
    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        return False
    except OSError as error:
        return error.errno in NO_LOCKS
    return True


def _is_at(descriptor: int, path: Path) -> bool:
    """Tell whether a file has still its name: who had it before may have put it into its place since it was opened."""
    try:
        return os.path.samestat(os.fstat(descriptor), path.lstat())
    except FileNotFoundError:
        return False


def flush_folder(folder: Path) -> None:
    """Have a rename in a folder outlive a loss of power, where the file system can."""
    try:
        descriptor = os.open(folder, os.O_RDONLY | os.O_CLOEXEC)
        try:
            os.fsync(descriptor)
        finally:
            os.close(descriptor)
    except OSError as error:
        if error.errno not in NO_FLUSH:
            raise
