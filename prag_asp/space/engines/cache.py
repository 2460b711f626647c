"""A folder of computed arrays, each file under the key of what it was computed from.

A file is what `numpy.savez` writes, its key and texts as JSON in an array of bytes, and then a checksum of all that,
for those of the archive cover the arrays, but not their names. What cannot be read, is cut short, was changed, or
belongs to another key is taken as absent, and what cannot be written is not kept. Nothing in a file is ever run.

A checksum is no signature: whoever can write a file can write another count into it. So a folder or a file that is
another user's, or that others may write, is as good as none: nothing is read there, and nothing kept.
"""

from __future__ import annotations

import json
import os
import stat
import zlib
from collections.abc import Collection, Mapping
from contextlib import suppress
from dataclasses import dataclass
from io import BytesIO
from itertools import accumulate
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from prag_asp.arrays import BadArchive, read_arrays
from prag_asp.errors import OutputError
from prag_asp.output import replace_file
from prag_asp.reading import open_binary

HEADER = "header"
CHECKSUM = 4
SUFFIX = ".arrays"

OWN = 0o600
"""The permissions of a file: what one user keeps, no other one reads or writes."""

LARGEST_FILE, LARGEST_FOLDER = 200_000_000, 1_000_000_000
"""Bytes; the files read longest ago go first."""

OURS_ALONE = 0o700
OTHERS_WRITE = stat.S_IWGRP | stat.S_IWOTH


@dataclass(frozen=True)
class Entry:
    """Texts as JSON allows them, and arrays by name."""

    texts: Mapping[str, Any]
    arrays: Mapping[str, NDArray[Any]]


def read_entry(folder: Path, key: str, names: Collection[str]) -> Entry | None:
    """Return what was kept under a key, of its arrays those of some names; or None."""
    path = folder / f"{key}{SUFFIX}"
    try:
        if not _is_ours(folder.stat()):
            return None
        with open_binary(path, within=folder, at_most=LARGEST_FILE + CHECKSUM) as file:
            content = file.read() if _is_ours(os.fstat(file.fileno())) else b""
        entry = _parsed(content, key, names)
    except (OSError, BadArchive, ValueError, KeyError, TypeError, RecursionError):
        return None
    with suppress(OSError):
        os.utime(path)
    return entry


def _is_ours(found: os.stat_result) -> bool:
    """Tell whether a file or a folder is the user's, and nobody else may write to it."""
    return found.st_uid == os.geteuid() and not found.st_mode & OTHERS_WRITE


def _parsed(content: bytes, key: str, names: Collection[str]) -> Entry | None:
    if _checksum(memoryview(content)[:-CHECKSUM]) != content[-CHECKSUM:]:
        return None
    arrays = read_arrays(BytesIO(content), (HEADER, *names), LARGEST_FILE)
    header = json.loads(arrays.pop(HEADER).tobytes())
    return Entry(header["texts"], arrays) if header["key"] == key else None


def write_entry(folder: Path, key: str, entry: Entry) -> bool:
    """Keep something under a key, in one stroke; return whether that was possible."""
    header = np.frombuffer(json.dumps({"key": key, "texts": entry.texts}).encode(), np.uint8)
    arrays: dict[str, Any] = {HEADER: header, **entry.arrays}
    buffer = BytesIO()
    np.savez(buffer, **arrays)
    if buffer.tell() > LARGEST_FILE:
        return False
    buffer.write(_checksum(buffer.getvalue()))
    try:
        folder.mkdir(OURS_ALONE, parents=True, exist_ok=True)
        if not _is_ours(folder.stat()):
            return False
        replace_file(folder / f"{key}{SUFFIX}", buffer.getvalue(), mode=OWN, follow=False)
        _shrink(folder)
    except (OSError, OutputError):
        return False
    return True


def _shrink(folder: Path) -> None:
    """Remove the files read longest ago until the folder is small enough."""
    files = sorted(((path.stat().st_mtime, path, path.stat().st_size) for path in folder.glob(f"*{SUFFIX}*")),
                   reverse=True)  # fmt: skip
    for (_, path, _), total in zip(files, accumulate(size for _, _, size in files), strict=True):
        if total > LARGEST_FOLDER:
            path.unlink(missing_ok=True)


def _checksum(content: bytes | memoryview) -> bytes:
    return zlib.crc32(content).to_bytes(CHECKSUM, "little")
