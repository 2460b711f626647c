"""A folder of computed arrays, each file under the key of what it was computed from.

A file is what `numpy.savez` writes, its key and texts as JSON in an array of bytes, and then a checksum of all that,
for those of the archive cover the arrays, but not their names. What cannot be read, is cut short, was changed, or
belongs to another key is taken as absent, and what cannot be written is not kept. Nothing in a file is ever run.
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

from prag_asp.output.cache_files import keep, read_kept

HEADER = "header"
SUFFIX = ".arrays"

LARGEST_FILE, LARGEST_FOLDER = 200_000_000, 1_000_000_000
"""Bytes; the files read longest ago go first."""


@dataclass(frozen=True)
class CacheEntry:
    """Texts as JSON allows them, and arrays by name."""

    texts: Mapping[str, Any]
    arrays: Mapping[str, NDArray[Any]]


def read_entry(folder: Path, key: str, names: Collection[str]) -> CacheEntry | None:
    """Return what was kept under a key, of its arrays those of some names; or None."""
    content = read_kept(folder / f"{key}{SUFFIX}", LARGEST_FILE)
    if content is None:
        return None
    from prag_asp.array_archive import BadArchive, read_arrays  # zipfile is not loaded where there is no entry

    try:
        arrays = read_arrays(BytesIO(content), (HEADER, *names), LARGEST_FILE)
        header = json.loads(arrays.pop(HEADER).tobytes())
        return CacheEntry(header["texts"], arrays) if header["key"] == key else None
    except (BadArchive, ValueError, KeyError, TypeError, RecursionError):
        return None


def write_entry(folder: Path, key: str, entry: CacheEntry) -> bool:
    """Keep something under a key, in one stroke; return whether that was possible."""
    header = np.frombuffer(json.dumps({"key": key, "texts": entry.texts}).encode(), np.uint8)
    arrays: dict[str, Any] = {HEADER: header, **entry.arrays}
    buffer = BytesIO()
    np.savez(buffer, **arrays)
    if buffer.tell() > LARGEST_FILE:
        return False
    if not keep(folder / f"{key}{SUFFIX}", buffer.getvalue()):
        return False
    with suppress(OSError):
        _shrink(folder)
    return True


def _shrink(folder: Path) -> None:
    """Remove the files read longest ago until the folder is small enough."""
    files = sorted(((path.stat().st_mtime, path, path.stat().st_size) for path in folder.glob(f"*{SUFFIX}*")),
                   reverse=True)  # fmt: skip
    for (_, path, _), total in zip(files, accumulate(size for _, _, size in files), strict=True):
        if total > LARGEST_FOLDER:
            path.unlink(missing_ok=True)
