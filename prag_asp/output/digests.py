"""Digests of values and files, for cache keys and for the fingerprint of a resumable run.

A digest is a 160-bit BLAKE2b hash in hexadecimal. Datasets use SHA-256 instead, because other tools can compute it as
well.
"""

from __future__ import annotations

import json
from collections.abc import Iterable
from pathlib import Path

try:
    from _blake2 import blake2b  # hashlib would load OpenSSL, which takes longer than a small count needs
except ImportError:
    from hashlib import blake2b

from prag_asp.safe_reading import open_binary

BYTES = 20
"""The number of bytes in a digest."""

BLOCK = 1 << 20
"""The number of bytes that are read at a time."""


def digest(values: object) -> str:
    """Return a digest of plain values; the digest of a dict depends on the order of its entries."""
    return blake2b(json.dumps(values, default=str).encode(), digest_size=BYTES).hexdigest()


def files_digest(paths: Iterable[Path], folder: Path) -> str:
    """Return a digest of the contents of files and of their paths below a folder.

    Raises:
        OSError: a file cannot be read.
    """
    return digest([(str(path.relative_to(folder)), _content_digest(path)) for path in sorted(paths)])


def _content_digest(path: Path) -> str:
    """Return a digest of the content of a file, which may be larger than the memory."""
    content = blake2b(digest_size=BYTES)
    with open_binary(path) as file:
        while block := file.read(BLOCK):
            content.update(block)
    return content.hexdigest()
