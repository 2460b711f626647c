"""A folder of computed arrays, each file under the key of what it was computed from.

A file is a line of JSON (a table of its arrays, and texts), then the bytes of the arrays; a checksum covers both. What
cannot be read, is cut short, was changed, or belongs to another key is taken as absent, and what cannot be written
is not kept. Nothing in a file is ever run.
"""

from __future__ import annotations

import json
import os
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass
from hashlib import blake2b
from itertools import accumulate
from math import prod
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

MAGIC = b"prag_asp cache 1\n"
CHECKSUM = 32
SUFFIX = ".arrays"
DTYPES = ("bool", "int32", "int64")

LARGEST_FILE, LARGEST_FOLDER = 200_000_000, 1_000_000_000
"""Bytes; the files read longest ago go first."""


@dataclass(frozen=True)
class Entry:
    """Texts as JSON allows them, and arrays by name."""

    texts: Mapping[str, Any]
    arrays: Mapping[str, NDArray[Any]]


def read_entry(folder: Path, key: str) -> Entry | None:
    """Return what was kept under a key, or None."""
    path = folder / f"{key}{SUFFIX}"
    try:
        content = path.read_bytes()
        entry = _parsed(content, key)
    except (OSError, ValueError, KeyError, TypeError, OverflowError, RecursionError):
        return None
    with suppress(OSError):
        os.utime(path)
    return entry


def _parsed(content: bytes, key: str) -> Entry | None:
    begin = len(MAGIC) + CHECKSUM
    if not content.startswith(MAGIC) or _checksum(content[begin:]) != content[len(MAGIC) : begin]:
        return None
    end = content.index(b"\n", begin)
    header = json.loads(content[begin:end])
    if header["key"] != key:
        return None
    place, arrays = end + 1, {}
    for name, dtype, shape in header["arrays"]:
        if dtype not in DTYPES:
            return None
        array = np.frombuffer(content, dtype=np.dtype(dtype).newbyteorder("<"), count=prod(shape), offset=place)
        arrays[name] = array.astype(dtype, copy=False).reshape(shape)
        place += array.nbytes
    return Entry(header["texts"], arrays) if place == len(content) else None


def write_entry(folder: Path, key: str, entry: Entry) -> bool:
    """Keep something under a key, in one stroke; return whether that was possible."""
    from tempfile import NamedTemporaryFile

    table = [[name, str(array.dtype), list(array.shape)] for name, array in entry.arrays.items()]
    header = json.dumps({"key": key, "texts": entry.texts, "arrays": table})
    parts = [
        np.ascontiguousarray(array, dtype=array.dtype.newbyteorder("<")).tobytes() for array in entry.arrays.values()
    ]
    body = b"".join([header.encode(), b"\n", *parts])
    if len(body) > LARGEST_FILE:
        return False
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with NamedTemporaryFile(dir=folder, prefix=".", suffix=SUFFIX, delete=False) as file:
            try:
                file.write(MAGIC + _checksum(body) + body)
                file.close()
                Path(file.name).replace(folder / f"{key}{SUFFIX}")
            except BaseException:
                Path(file.name).unlink(missing_ok=True)
                raise
        _shrink(folder)
    except OSError:
        return False
    return True


def _shrink(folder: Path) -> None:
    """Remove the files read longest ago until the folder is small enough."""
    files = sorted(((path.stat().st_mtime, path, path.stat().st_size) for path in folder.glob(f"*{SUFFIX}")),
                   reverse=True)  # fmt: skip
    for (_, path, _), total in zip(files, accumulate(size for _, _, size in files), strict=True):
        if total > LARGEST_FOLDER:
            path.unlink(missing_ok=True)


def _checksum(content: bytes) -> bytes:
    return blake2b(content, digest_size=CHECKSUM).digest()
