"""The only place where files are opened for reading: regular files of a bounded size, within their folder.

An untrusted folder may hold links, pipes, devices and endless files in place of files. A refusal is an `OSError` with
the reason in `strerror`, as for any file that cannot be read.
"""

from __future__ import annotations

import errno
import io
import os
import stat
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import BinaryIO, TextIO

LARGEST_TEXT = 64_000_000
"""The maximum number of bytes in a file that is read as a whole."""

LONGEST_LINE = 16_000_000
"""The maximum number of characters in a line of a file that is read line by line."""

STANDARD_INPUT = "-"
"""The name that stands for standard input in place of a file."""

OPEN_ALREADY = ("/proc/", "/dev/fd/")
"""The prefixes of paths that are already open in the process, such as ``/dev/stdin`` and ``<(command)``."""


STANDARD_INPUTS = ("/dev/stdin", "/dev/fd/0", "/proc/self/fd/0")
"""The paths of standard input."""


class Refused(OSError):
    """A file that is refused regardless of its permissions."""


def is_inside(path: str | Path, folder: str | Path) -> bool:
    """Return whether a path leads into a folder, or to the folder itself, after following all links.

    A path with a null character is never inside.
    """
    return "\0" not in str(path) and Path(os.path.realpath(path)).is_relative_to(os.path.realpath(folder))


def read_bytes(path: str | Path, *, within: str | Path | None = None, at_most: int = LARGEST_TEXT) -> bytes:
    """Return the content of a file; `within` is the folder that must contain it, or None if the user named the file.

    Raises:
        OSError: the file is missing, unreadable, not a regular file, too large, or outside `within`.
    """
    with open_binary(path, within=within, at_most=at_most) as file:
        content = file.read(at_most + 1)
    if len(content) > at_most:  # the file has grown, or is a pipe
        raise _too_large(path, at_most)
    return content


def open_binary(path: str | Path, *, within: str | Path | None = None, at_most: int | None = None) -> BinaryIO:
    """Open a file for reading; `within` is as in `read_bytes`, and without `at_most`, the file may have any size.

    A pipe without a writer does not block, and no device is opened. A pipe that is already open, such as
    ``<(command)``, is read if the user named it.

    Raises:
        OSError: the file is missing, unreadable, not a regular file, too large, or outside `within`.
    """
    if str(path) in STANDARD_INPUTS and sys.stdin is None:
        raise Refused(errno.EBADF, "standard input is closed", str(path))
    try:
        found = Path(path).stat()
    except ValueError:
        raise Refused(errno.EINVAL, "the path has a character that no path has", str(path)) from None
    if within is not None and not is_inside(path, within):
        raise Refused(errno.EPERM, f"it leads out of the folder {within}", str(path))
    _require_kind(path, found)
    waits = 0 if stat.S_ISFIFO(found.st_mode) else os.O_NONBLOCK
    descriptor = os.open(path, os.O_RDONLY | os.O_CLOEXEC | waits)
    try:
        found = os.fstat(descriptor)
        _require_kind(path, found)
        if at_most is not None and found.st_size > at_most:
            raise _too_large(path, at_most)
        return os.fdopen(descriptor, "rb")
    except BaseException:
        os.close(descriptor)
        raise


def _require_kind(path: str | Path, found: os.stat_result) -> None:
    """Check that a file can be read to its end.

    Raises:
        OSError: the path is a folder, a pipe, a device or a socket.
    """
    mode = found.st_mode
    if stat.S_ISREG(mode):
        return
    if stat.S_ISDIR(mode):
        raise IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR), str(path))
    open_already = os.path.realpath(path).startswith(OPEN_ALREADY)
    nothing = stat.S_ISCHR(mode) and found.st_rdev == Path(os.devnull).stat().st_rdev
    if not (nothing or (stat.S_ISFIFO(mode) and open_already)):
        raise Refused(errno.EINVAL, "it is not a regular file", str(path))


def _too_large(path: str | Path, at_most: int) -> Refused:
    return Refused(errno.EFBIG, f"it is larger than {at_most / 10**6:,.0f} MB", str(path))


@contextmanager
def open_text(path: str | Path) -> Iterator[TextIO]:
    """Open a file that the user has named, or standard input, as text; invalid UTF-8 is replaced with U+FFFD.

    Raises:
        OSError: the file is missing, unreadable, or not a regular file.
    """
    if str(path) == STANDARD_INPUT:
        if sys.stdin is None:
            raise Refused(errno.EBADF, "standard input is closed", STANDARD_INPUT)
        yield sys.stdin
        return
    with io.TextIOWrapper(open_binary(path), encoding="utf-8", errors="replace") as lines:
        yield lines


def lines_of(stream: TextIO) -> Iterator[str]:
    """Yield the lines of a stream; stop after the first `LONGEST_LINE` + 1 characters of a longer line."""
    while line := stream.readline(LONGEST_LINE + 1):
        yield line
        if len(line) > LONGEST_LINE:
            return
