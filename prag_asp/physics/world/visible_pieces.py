"""The visual shapes of bodies in PyBullet: solids of one colour, and meshes with textures.

PyBullet draws one texture for each mesh, multiplied by the colour of the shape. It finds the texture in the material
library that the .obj file names, and computes flat normals if the file has none. A mesh is therefore divided by
material, and rewritten in metres with all files that it names.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import lru_cache
from hashlib import sha256
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from prag_asp.scene.colours import rgb
from prag_asp.scene.read.looks.surface import Floats, Surface
from prag_asp.scene.read.looks.surfaces import look_surfaces
from prag_asp.scene.read.mesh import state_of
from prag_asp.scene.scene import Look, Solid

Integers = NDArray[np.int64]
Rgba = tuple[float, ...]
UNIT = (1.0, 1.0, 1.0)


class VisiblePiece(NamedTuple):
    """A solid and its colour (red, green, blue and opacity from 0 to 1); for a mesh, also its file name and files."""

    solid: Solid
    rgba: Rgba
    mesh: str = ""
    files: Mapping[str, bytes] = {}


def paint(color: str) -> Rgba:
    """Return an opaque colour from a code like ``#e4572e``."""
    red, green, blue = rgb(color)
    return red / 255, green / 255, blue / 255, 1.0


def look_pieces(look: Look, tint: Rgba) -> list[VisiblePiece]:
    """Return the pieces of a look, with their colours multiplied by another colour.

    Raises:
        SceneError: a mesh cannot be read.
    """
    if not look.solid.mesh:
        return [VisiblePiece(look.solid, _tinted(look.color, tint))]
    return [
        VisiblePiece(look.solid, _tinted(color, tint), name, files)
        for color, name, files in _written(look, state_of(look.solid.mesh))
    ]


def _tinted(color: str, tint: Rgba) -> Rgba:
    """Return the product of two colours; an empty colour counts as white."""
    return tuple(a * b for a, b in zip(paint(color), tint, strict=True)) if color else tint


@lru_cache(maxsize=64)
def _written(look: Look, _state: tuple[int, int]) -> tuple[tuple[str, str, Mapping[str, bytes]], ...]:
    """Return the colour, name and files of each surface of a mesh; `_state` is the state of the mesh's file."""
    return tuple(_files(surface, look.solid.size) for surface in look_surfaces(look))


def _files(surface: Surface, scale: tuple[float, float, float]) -> tuple[str, str, Mapping[str, bytes]]:
    """Return the colour of a surface, the name of its .obj file, and that file with the files that it names.

    The names of the files depend on their contents, because PyBullet caches files by path.
    """
    files: dict[str, bytes] = {}
    lines: list[str] = []
    textured = bool(surface.texture) and surface.places is not None
    if textured:
        stem = sha256(surface.texture).hexdigest()[:32]
        files[f"{stem}{surface.suffix}"] = surface.texture
        files[f"{stem}.mtl"] = f"newmtl paint\nKd 1 1 1\nmap_Kd {stem}{surface.suffix}\n".encode("ascii")
        lines += [f"mtllib {stem}.mtl", "usemtl paint"]
    normals = None if surface.normals is None else _unit(surface.normals / scale)
    numbers: list[Integers | None] = [_table(lines, "v", surface.corners * scale)]
    numbers.append(_table(lines, "vt", surface.places) if textured and surface.places is not None else None)
    numbers.append(None if normals is None else _table(lines, "vn", normals))
    columns = [[""] * (3 * len(surface.corners)) if each is None else each.tolist() for each in numbers]
    corners = ["/".join(map(str, each)).rstrip("/") for each in zip(*columns, strict=True)]
    lines += [" ".join(("f", *corners[k : k + 3])) for k in range(0, len(corners), 3)]
    content = ("\n".join(lines) + "\n").encode("ascii")
    name = f"{sha256(content).hexdigest()[:32]}.obj"
    return "" if textured else surface.color, name, {name: content, **files}


def _table(lines: list[str], word: str, values: Floats) -> Integers:
    """Append the distinct rows of values to the lines of an .obj file, and return the number of each row, from 1."""
    rows, numbers = np.unique(values.reshape(-1, values.shape[-1]), axis=0, return_inverse=True)
    lines += [" ".join((word, *(f"{each:.6g}" for each in row))) for row in rows.tolist()]
    return numbers.ravel() + 1


def _unit(normals: Floats) -> Floats:
    """Return vectors scaled to length 1."""
    result: Floats = normals / np.maximum(np.linalg.norm(normals, axis=-1, keepdims=True), 1e-12)
    return result
