"""Cache files of the user: results that took long to compute, for the next run.

A file ends with a checksum: one that was cut or changed counts as absent. Failures to write are ignored.

A checksum is no signature: whoever can write a file can write another content into it. So a folder or a file that is
another user's, or that others may write, is neither read nor written.
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
"""Bytes of a checksum."""

OWN = 0o600
"""The permissions of a file: no other user reads or writes it."""

OURS_ALONE = 0o700
OTHERS_WRITE = stat.S_IWGRP | stat.S_IWOTH


def cache_folder() -> Path | None:
    """Return the folder of the cache: ``PRAG_ASP_CACHE``, or one in the user's; None where that variable is empty."""
    own = os.environ.get("PRAG_ASP_CACHE")
    if own is not None:
        return Path(own) if own else None
    try:
        return Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "prag_asp"
    except RuntimeError:  # there is no home
        return None


def read_cached(path: Path, at_most: int) -> bytes | None:
    """Return the content of a cache file of `at_most` bytes, None if it is missing or damaged."""
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
    """Write a cache file, whole; return whether that was possible."""
    try:
        path.parent.mkdir(OURS_ALONE, parents=True, exist_ok=True)
        if not _is_ours(path.parent.stat()):
            return False
        replace_file(path, content + checksum(content), mode=OWN, follow=False)
    except (OSError, OutputError):
        return False
    return True


def checksum(content: bytes | memoryview) -> bytes:
    """Return the checksum that a file ends with."""
    return zlib.crc32(content).to_bytes(CHECKSUM, "little")


def _is_ours(found: os.stat_result) -> bool:
    """Return whether a file or a folder belongs to the user, and nobody else may write to it."""
    return found.st_uid == os.geteuid() and not found.st_mode & OTHERS_WRITE
