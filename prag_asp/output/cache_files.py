"""The user's cache: files with results that took a long time to compute, for later runs.

A file ends with a checksum, so that a truncated or modified file counts as missing. Failures to write are ignored.

A checksum is not a signature: anyone who can write to a file can forge its content. Folders and files that belong to
another user, or to which others may write, are therefore neither read nor written.
"""

from __future__ import annotations

import os
import stat
import zlib
from contextlib import suppress
from pathlib import Path

from prag_asp.errors import OutputError
from prag_asp.output.atomic_file import replace_file
from prag_asp.safe_reading import open_binary

CHECKSUM = 4
"""The number of bytes in a checksum."""

OWN = 0o600
"""The permissions of a cache file: other users can neither read nor write it."""

OURS_ALONE = 0o700
"""The permissions of the cache folder: other users have no access."""

OTHERS_WRITE = stat.S_IWGRP | stat.S_IWOTH


def cache_folder() -> Path | None:
    """Return the folder that the environment variable ``PRAG_ASP_CACHE`` names, by default one in the user's cache.

    The result is None if the variable is empty or, without the variable, if there is no home folder.
    """
    folder = os.environ.get("PRAG_ASP_CACHE")
    if folder is not None:
        return Path(folder) if folder else None
    try:
        return Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "prag_asp"
    except RuntimeError:  # there is no home folder
        return None


def read_cached(path: Path, at_most: int) -> bytes | None:
    """Return the content of a cache file, or None if it is missing, damaged, or longer than `at_most` bytes."""
    try:
        if not _is_ours(path.parent.stat()):
            return None
        with open_binary(path, within=path.parent, at_most=at_most + CHECKSUM) as file:
            content = file.read() if _is_ours(os.fstat(file.fileno())) else b""
    except OSError:
        return None
    if checksum(memoryview(content)[:-CHECKSUM]) != content[-CHECKSUM:]:
        return None
    with suppress(OSError):
        os.utime(path)
    return content[:-CHECKSUM]


def write_cached(path: Path, content: bytes) -> bool:
    """Write a cache file atomically, and return whether that succeeded."""
    try:
        path.parent.mkdir(OURS_ALONE, parents=True, exist_ok=True)
        if not _is_ours(path.parent.stat()):
            return False
        replace_file(path, content + checksum(content), mode=OWN, follow=False)
    except (OSError, OutputError):
        return False
    return True


def checksum(content: bytes | memoryview) -> bytes:
    """Return the checksum that is appended to the content of a cache file."""
    return zlib.crc32(content).to_bytes(CHECKSUM, "little")


def _is_ours(status: os.stat_result) -> bool:
    """Return whether a file or folder belongs to the user and no other user may write to it."""
    return status.st_uid == os.geteuid() and not status.st_mode & OTHERS_WRITE
