"""A cache folder of computed arrays, in which each file is named after a key derived from the inputs.

A file is an archive written by `numpy.savez`, with its key and texts as JSON in an array of bytes, and a checksum of
the file, because the checksums of the archive cover the arrays but not their names. A file that is unreadable,
truncated or modified, or that has a different key, counts as absent, and failed writes are ignored. Files are never
executed.
"""

from __future__ import annotations

import json
from collections.abc import Collection, Mapping
from contextlib import suppress
from dataclasses import dataclass
from io import BytesIO
from itertools import accumulate
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from prag_asp.output.cache_files import read_cached, write_cached

HEADER = "header"
SUFFIX = ".arrays"

LARGEST_FILE, LARGEST_FOLDER = 200_000_000, 1_000_000_000
"""Maximum sizes of a file and of the folder in bytes; the least recently used files are removed first."""


@dataclass(frozen=True)
class CacheEntry:
    """The content of a cache entry: named JSON values and named arrays."""

    texts: Mapping[str, Any]
    arrays: Mapping[str, NDArray[Any]]


def read_entry(folder: Path, key: str, names: Collection[str]) -> CacheEntry | None:
    """Return the entry under a key, with the arrays of the given names, or None if there is no valid entry."""
    content = read_cached(folder / f"{key}{SUFFIX}", LARGEST_FILE)
    if content is None:
        return None
    from prag_asp.array_archive import BadArchive, read_arrays  # avoids loading zipfile if there is no entry

    try:
        arrays = read_arrays(BytesIO(content), (HEADER, *names), LARGEST_FILE)
        header = json.loads(arrays.pop(HEADER).tobytes())
        return CacheEntry(header["texts"], arrays) if header["key"] == key else None
    except (BadArchive, ValueError, KeyError, TypeError, RecursionError):
        return None


def write_entry(folder: Path, key: str, entry: CacheEntry) -> bool:
    """Write an entry under a key atomically, and return whether that succeeded."""
    header = np.frombuffer(json.dumps({"key": key, "texts": entry.texts}).encode(), np.uint8)
    arrays: dict[str, Any] = {HEADER: header, **entry.arrays}
    buffer = BytesIO()
    np.savez(buffer, **arrays)
    if buffer.tell() > LARGEST_FILE:
        return False
    if not write_cached(folder / f"{key}{SUFFIX}", buffer.getvalue()):
        return False
    with suppress(OSError):  # remove the least recently used files until the folder is small enough
        status = [(path, path.stat()) for path in folder.glob(f"*{SUFFIX}*")]
        files = sorted(((stat.st_mtime, path, stat.st_size) for path, stat in status), reverse=True)
        for (_, path, _), total in zip(files, accumulate(size for _, _, size in files), strict=True):
            if total > LARGEST_FOLDER:
                path.unlink(missing_ok=True)
    return True
