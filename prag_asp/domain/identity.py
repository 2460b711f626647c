"""Digests of domains: domains with equal digests have the same tasks, and the same verdicts on them."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator, Mapping, Sequence
from functools import cache
from hashlib import blake2b
from pathlib import Path
from typing import Any

from prag_asp.domain.load import Domain
from prag_asp.program.paths import PACKAGE
from prag_asp.safe_reading import is_inside, read_bytes

MESH = re.compile(rb"""filename\s*=\s*["']([^"']+)["']""")
"""Finds the meshes that a URDF names."""


def domain_digest(domain: Domain) -> str:
    """Return a digest of all that tasks of a domain and verdicts on them depend on, with the files of its scene."""
    settings = domain.settings
    files = {str(path): _hashed(path) for path in scene_files(settings.scene, settings.path.parent)}
    content = [
        domain.name,
        domain.program.text,
        dict(domain.constants),
        domain.trusted,
        {key: str(weight) for key, weight in settings.weights.items()},
        dict(settings.grammar),
        settings.scene,
        files,
    ]
    return digest(content)


def code_digest(encodings: Path) -> str:
    """Return a digest of the code of this package and of a folder of encodings, on which every result depends."""
    return digest(sorted([*_own_code(), *((path.name, _hashed(path)) for path in encodings.rglob("*.lp"))]))


@cache
def _own_code() -> list[tuple[str, str]]:
    """Return the names and the digests of the files of this package, read once in a process."""
    files = [*PACKAGE.rglob("*.py"), *(PACKAGE / "grammar").glob("*.toml")]
    return [(path.name, _hashed(path)) for path in files]


def digest(values: object) -> str:
    """Return a digest of plain values; the order of tables matters."""
    return blake2b(json.dumps(values, default=str).encode(), digest_size=20).hexdigest()


def _hashed(path: Path) -> str:
    """Return the digest of a file."""
    return blake2b(read_bytes(path)).hexdigest()


def scene_files(table: object, folder: Path) -> Iterator[Path]:
    """Yield the files that a table of a scene names, and the meshes that these name."""
    for text in sorted(set(_texts(table))):
        path = folder / text
        if len(text) < 256 and "\0" not in text and is_inside(path, folder) and path.is_file():
            yield path
            if path.suffix.lower() == ".urdf":
                meshes = (path.parent / name.decode(errors="replace") for name in MESH.findall(read_bytes(path)))
                yield from (mesh for mesh in meshes if is_inside(mesh, folder) and mesh.is_file())


def _texts(value: Any) -> Iterator[str]:
    if isinstance(value, str):
        yield value
    elif isinstance(value, Mapping):
        for each in value.values():
            yield from _texts(each)
    elif isinstance(value, Sequence):
        for each in value:
            yield from _texts(each)
