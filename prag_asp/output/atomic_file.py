"""Atomic files: a file is written next to its target, flushed, and renamed, while a lock excludes other writers.

A rename is atomic, and data that were flushed before it survive a power failure, so a reader always sees either the old
or the new content. If the process is killed, the old file and ``NAME.part`` remain.
"""

from __future__ import annotations

import errno
import fcntl
import os
import stat
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from time import monotonic, sleep

from prag_asp.errors import OutputError

SUFFIX = ".part"
"""The suffix of files and folders that are being written."""

EVERYBODY = 0o666
"""The permissions of a new file, reduced by the user's umask."""

PATIENCE = 3.0
"""Seconds to wait for another writer of the same file, because a killed process may take that long to disappear."""

POLL = 0.02
"""Seconds between two attempts to lock a file."""

FULL = (errno.ENOSPC, errno.EDQUOT, errno.EFBIG)
"""The errors for a full disk, an exceeded quota, or a file that has reached the maximum size."""

NO_LOCKS = (errno.ENOLCK, errno.ENOTSUP, errno.ENOSYS)
"""The errors of a file system that has no locks."""

NO_FLUSH = (errno.EINVAL, errno.ENOTSUP, errno.EACCES)
"""The errors of a file system that cannot flush a folder."""


class AtomicFile:
    """A file being written as ``NAME.part``, which is locked against other runs."""

    def __init__(self, target: Path, mode: int = EVERYBODY) -> None:
        """Create ``NAME.part`` or empty an existing one, and lock it.

        Raises:
            OutputError: the file cannot be written, another run is writing it, or it is not a regular file.
        """
        self.target = target
        self.path = target.with_name(target.name + SUFFIX)
        self._size = 0
        with output_errors(target):
            self._descriptor = open_locked(self.path, mode)
            try:
                os.ftruncate(self._descriptor, 0)
            except BaseException:
                self.discard()
                self.close()
                raise

    def write(self, content: bytes) -> None:
        """Append bytes.

        Raises:
            OutputError: the bytes cannot be written.
        """
        with output_errors(self.target):
            write_at(self._descriptor, content, self._size)
        self._size += len(content)

    def replace(self) -> None:
        """Flush the file and rename it to its target, with the permissions of the target.

        Raises:
            OutputError: the file cannot be written.
        """
        with output_errors(self.target):
            with suppress(OSError):
                os.fchmod(self._descriptor, stat.S_IMODE(self.target.stat().st_mode))
            os.fsync(self._descriptor)
            self.path.replace(self.target)
            flush_folder(self.target.parent)

    def discard(self) -> None:
        """Remove the file."""
        with suppress(OSError):
            self.path.unlink()

    def close(self) -> None:
        """Release the lock."""
        os.close(self._descriptor)


@contextmanager
def open_atomic(file: str | Path, *, mode: int = EVERYBODY, follow: bool = True) -> Iterator[AtomicFile]:
    """Yield a file to write, which replaces its target when the block ends, and is removed if the block fails.

    With `follow`, a symbolic link is followed; otherwise, the link itself is replaced. `mode` holds the permissions of
    a new file.

    Raises:
        OutputError: the file cannot be written, or another run is writing it.
    """
    path = Path(file)
    part = AtomicFile(path.resolve() if follow and path.is_symlink() else path, mode)
    try:
        yield part
        part.replace()
    except BaseException:
        part.discard()
        raise
    finally:
        part.close()


def replace_file(file: str | Path, content: bytes, *, mode: int = EVERYBODY, follow: bool = True) -> None:
    """Write a file atomically, so that after an interruption, the file has either the old or the new content.

    A device or a pipe is written directly. `mode` and `follow` have the same meaning as in `open_atomic`.

    Raises:
        OutputError: the file cannot be written.
    """
    path = Path(file)
    if is_stream(path):
        with output_errors(path), path.open("wb") as stream:
            stream.write(content)
        return
    with open_atomic(path, mode=mode, follow=follow) as part:
        part.write(content)


@contextmanager
def whole_file(file: Path) -> Iterator[Path]:
    """Yield the path of an empty file for a library to write, which replaces `file` when the block ends.

    Raises:
        OutputError: the file cannot be written, another run is writing it, or it exists and is not a regular file.
    """
    if is_stream(file):
        raise OutputError(f"{file}: is not a regular file; give a file")
    with open_atomic(file) as part, output_errors(file):
        yield part.path


def is_stream(path: Path) -> bool:
    """Return whether a path exists but cannot be replaced, because it is a device, a pipe or a folder."""
    return path.exists() and not path.is_file()


@contextmanager
def output_errors(path: Path | str) -> Iterator[None]:
    """Turn system errors into one-line errors that name the file.

    Raises:
        OutputError: the system refused to write.
    """
    try:
        yield
    except BrokenPipeError:
        raise
    except OSError as error:
        if error.errno == errno.EBADF:  # the stream was closed by the caller
            raise OutputError(f"{path}: {error.strerror}") from None
        hint = "free some space" if error.errno in FULL else "choose another file"
        raise OutputError(f"{path}: cannot be written: {error.strerror or error}; {hint}") from None


def open_locked(path: Path, mode: int = EVERYBODY) -> int:
    """Return the descriptor of a regular file, locked against other writers; create the file if it is missing.

    Raises:
        OutputError: another run is writing the file, or the path is not a regular file.
        OSError: the file cannot be opened.
    """

    def open_file() -> int:
        descriptor = os.open(path, os.O_RDWR | os.O_CREAT | os.O_CLOEXEC | os.O_NOFOLLOW | os.O_NONBLOCK, mode)
        if stat.S_ISREG(os.fstat(descriptor).st_mode):
            return descriptor
        os.close(descriptor)
        raise OutputError(f"{path}: is not a regular file, but one has to be written there; remove it")

    return locked(path, open_file)


def locked(path: Path, open_path: Callable[[], int]) -> int:
    """Open a path with `open_path`, lock it once no other run holds the lock, and return the descriptor.

    Raises:
        OutputError: another run holds the lock for longer than `PATIENCE`.
        OSError: the path cannot be opened.
    """
    until = monotonic() + PATIENCE
    while True:
        descriptor = open_path()
        try:
            with suppress(FileNotFoundError):  # the previous writer may have renamed the file in the meantime
                if _lock(descriptor) and os.path.samestat(os.fstat(descriptor), path.lstat()):
                    return descriptor
        except BaseException:
            os.close(descriptor)
            raise
        os.close(descriptor)
        if monotonic() > until:
            raise OutputError(f"{path}: another run is writing it; wait until it ends, or choose another file")
        sleep(POLL)


def write_at(descriptor: int, content: bytes, position: int) -> None:
    """Write bytes at a byte offset in a file; after an interruption, the call can be repeated."""
    rest = memoryview(content)
    while rest:
        written = os.pwrite(descriptor, rest, position)
        rest, position = rest[written:], position + written


def flush_folder(folder: Path) -> None:
    """Flush a folder, if the file system supports that, so that a rename in it survives a power failure."""
    try:
        descriptor = os.open(folder, os.O_RDONLY | os.O_CLOEXEC)
        try:
            os.fsync(descriptor)
        finally:
            os.close(descriptor)
    except OSError as error:
        if error.errno not in NO_FLUSH:
            raise


def _lock(descriptor: int) -> bool:
    """Lock a file, and return whether that succeeded; on a file system without locks, return True."""
    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        return False
    except OSError as error:
        return error.errno in NO_LOCKS
    return True
