"""Digests of domains: domains with equal digests have the same tasks with the same verdicts."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from functools import cache
from pathlib import Path
from typing import Any

from prag_asp.domain.load import Domain
from prag_asp.output.digests import digest, file_digest, files_digest
from prag_asp.program.paths import PACKAGE
from prag_asp.safe_reading import is_inside, read_bytes

MESH = re.compile(rb"""filename\s*=\s*["']([^"']+)["']""")
"""The file names of the meshes in a URDF."""


def domain_digest(domain: Domain) -> str:
    """Return a digest of everything that the tasks of a domain and their verdicts depend on, including scene files."""
    settings = domain.settings
    files = {str(path): file_digest(path) for path in scene_files(settings.scene, settings.path.parent)}
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
    return digest([_package_digest(), files_digest(encodings.rglob("*.lp"), encodings)])


@cache
def _package_digest() -> str:
    """Return a digest of the files of this package, computed once per process."""
    return files_digest([*PACKAGE.rglob("*.py"), *(PACKAGE / "grammar").glob("*.toml")], PACKAGE)


def scene_files(table: object, folder: Path) -> Iterator[Path]:
    """Yield the files that the table of a scene names, and the meshes of the URDF files among them."""
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
