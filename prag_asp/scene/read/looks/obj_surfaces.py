"""Read the surfaces in a Wavefront .obj file and its material libraries."""

from __future__ import annotations

import math
from collections.abc import Container, Mapping
from itertools import pairwise
from pathlib import Path, PureWindowsPath
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from prag_asp.errors import SceneError
from prag_asp.safe_reading import is_inside, read_bytes
from prag_asp.scene.read.asset_paths import find_asset
from prag_asp.scene.read.looks.surface import Floats, Surface, hex_color

LARGEST_LIBRARY, LARGEST_TEXTURE = 1_000_000, 64_000_000
"""The largest sizes of a material library and of a texture, in bytes."""

TEXTURES = (".png", ".jpg", ".jpeg", ".bmp", ".tga")
"""The texture formats that PyBullet can read."""

Corner = tuple[int, int, int]
"""The indices of a corner's point, texture coordinates and normal, counting from 0, or -1 if one is missing."""


class ObjMaterial(NamedTuple):
    """A material: a colour ``#rrggbb``, and the path of a texture; each may be empty."""

    color: str = ""
    texture: str = ""


def read_obj(content: bytes, path: Path, folder: Path) -> tuple[Surface, ...]:
    """Return the surfaces in an .obj file, one for each material; libraries and textures must be inside `folder`.

    Raises:
        ValueError: the file is malformed.
    """
    values: dict[str, list[list[float]]] = {"v": [], "vt": [], "vn": []}
    faces: dict[str, list[tuple[Corner, Corner, Corner]]] = {}
    libraries: list[str] = []
    used = ""
    text = content.decode("utf-8", "replace").replace("\\\r\n", " ").replace("\\\n", " ")
    for line in text.splitlines():
        word, _, rest = line.strip().partition(" ")
        if word in values:
            values[word].append([float(each) for each in rest.split()[: 2 if word == "vt" else 3]])
        elif word == "f":
            first, *others = (_corner(each, values) for each in rest.split())
            faces.setdefault(used, []).extend((first, one, two) for one, two in pairwise(others))
        elif word == "usemtl":
            used = rest.strip()
        elif word == "mtllib":
            libraries.append(rest.strip())
    materials: dict[str, ObjMaterial] = {}
    for name in libraries:
        materials |= read_materials(name, path, folder, faces)
    tables = [np.array(values[word], dtype=float).reshape(-1, 2 if word == "vt" else 3) for word in values]
    return tuple(
        _surface(np.array(triangles), tables, materials.get(name, ObjMaterial()), folder)
        for name, triangles in faces.items()
        if triangles
    )


def read_materials(name: str, model: Path, folder: Path, needed: Container[str]) -> Mapping[str, ObjMaterial]:
    """Return the needed materials in a library that a model names.

    There are none if the library is missing or outside `folder`.
    """
    path = _beside(name, model, folder)
    if path is None:
        return {}
    try:
        content = read_bytes(path, within=folder, at_most=LARGEST_LIBRARY).decode("utf-8", "replace")
    except OSError:
        return {}
    materials: dict[str, ObjMaterial] = {}
    used = ""
    for line in content.splitlines():
        word, _, rest = line.strip().partition(" ")
        if word == "newmtl":
            used = rest.strip()
            if used in needed:
                materials[used] = ObjMaterial()
        elif word == "Kd" and used in materials:
            parts = _floats(rest.split())
            color = hex_color(*parts) if len(parts) == 3 else ""
            materials[used] = materials[used]._replace(color=color)
        elif word == "map_Kd" and used in materials:
            # Options such as -s 1 1 1 precede the name, which may contain blanks.
            words = rest.strip() if not rest.strip().startswith("-") else rest.split()[-1]
            texture = _beside(words, path, folder)
            if texture is not None and texture.suffix.lower() in TEXTURES:
                materials[used] = materials[used]._replace(texture=str(texture))
    return materials


def read_texture(path: str, folder: Path) -> bytes:
    """Return the content of a texture, or no bytes if it is missing or outside `folder`."""
    try:
        return read_bytes(path, within=folder, at_most=LARGEST_TEXTURE)
    except OSError:
        return b""


def _beside(name: str, model: Path, folder: Path) -> Path | None:
    """Return the path of a file that a model or a library names, or None if `folder` has no such file."""
    try:
        return find_asset(PureWindowsPath(name).as_posix(), model, folder) if name else None
    except SceneError:
        own = model.parent / PureWindowsPath(name).name
        return own if own.is_file() and is_inside(own, folder) else None


def _corner(word: str, values: Mapping[str, list[list[float]]]) -> Corner:
    """Return the indices of a corner such as 3/1/2, which count forwards from 1 or backwards from -1."""
    numbers = []
    for text, table in zip([*word.split("/"), "", ""], values.values(), strict=False):
        number = int(text) if text else 0
        if not -len(table) <= number <= len(table):
            raise ValueError(f"a face has the corner {word}, which it does not define")
        numbers.append(number - 1 if number >= 0 else len(table) + number)
    return numbers[0], numbers[1], numbers[2]


def _surface(triangles: NDArray[np.int64], tables: list[Floats], material: ObjMaterial, folder: Path) -> Surface:
    """Return the surface for triangles (n, 3, 3) that hold the indices of points, texture coordinates and normals."""
    own = [None if (triangles[:, :, k] < 0).any() else tables[k][triangles[:, :, k]] for k in (1, 2)]
    content = read_texture(material.texture, folder) if material.texture and own[0] is not None else b""
    suffix = Path(material.texture).suffix.lower()
    return Surface(tables[0][triangles[:, :, 0]], own[1], own[0], material.color, content, suffix)


def _floats(words: list[str]) -> list[float]:
    """Convert words to finite numbers; return nothing if a word is not a finite number."""
    try:
        numbers = [float(word) for word in words]
    except ValueError:
        return []
    return numbers if all(map(math.isfinite, numbers)) else []
