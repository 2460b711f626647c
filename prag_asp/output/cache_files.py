"""Files that are kept for the next run, in a folder of the user's: what was long to compute.

A file ends with a checksum: what is cut short or was changed is taken as absent. What cannot be written is not kept.

A checksum is no signature: whoever can write a file can write another content into it. So a folder or a file that is
another user's, or that others may write, is as good as none: nothing is read there, and nothing kept.
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
"""The permissions of a file: what one user keeps, no other one reads or writes."""

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


def read_kept(path: Path, at_most: int) -> bytes | None:
    """Return what a file holds that was kept, of so many bytes at most; None where there is none, or it is damaged."""
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


def keep(path: Path, content: bytes) -> bool:
    """Keep something as a file, in one stroke; return whether that was possible."""
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
    """Tell whether a file or a folder is the user's, and nobody else may write to it."""
    return found.st_uid == os.geteuid() and not found.st_mode & OTHERS_WRITE
