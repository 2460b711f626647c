"""Digests of values and files, for cache keys and for recognising a run that is resumed.

They are 160 bits of BLAKE2b in hexadecimal. Datasets use SHA-256 instead, because other tools also compute it.
"""

from __future__ import annotations

import json
from collections.abc import Iterable
from pathlib import Path

try:
    from _blake2 import blake2b  # hashlib would load OpenSSL, which takes longer than a small count needs
except ImportError:
    from hashlib import blake2b

from prag_asp.safe_reading import read_bytes

BYTES = 20
"""The number of bytes in a digest."""


def digest(values: object) -> str:
    """Return a digest of plain values; tables with the same entries in the same order have the same digest."""
    return blake2b(json.dumps(values, default=str).encode(), digest_size=BYTES).hexdigest()


def files_digest(paths: Iterable[Path], folder: Path) -> str:
    """Return a digest of the contents of files and of their paths below a folder.

    Raises:
        OSError: a file cannot be read.
    """
    contents = ((path, blake2b(read_bytes(path), digest_size=BYTES)) for path in sorted(paths))
    return digest([(str(path.relative_to(folder)), content.hexdigest()) for path, content in contents])
