"""Read the surfaces of a mesh with trimesh: textures, and the colours of materials, faces or vertices."""

from __future__ import annotations

from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from prag_asp.scene.read.looks.surface import Floats, Surface, hex_color
from prag_asp.scene.read.mesh import trimesh_parts

SMOOTH = (".glb", ".gltf", ".dae")
"""The formats that contain normals."""

MOST_COLOURS = 4096
"""The maximum number of face colours in the palette of a surface, which is an image of 64 x 64 pixels."""


def read_surfaces(path: str, content: bytes) -> tuple[Surface, ...]:
    """Return the surfaces of the parts of a mesh file in the unit of the file.

    Raises:
        SceneError: trimesh is not installed.
        ValueError: the file is not a mesh.
    """
    smooth = Path(path).suffix.lower() in SMOOTH
    return tuple(_surface(mesh, smooth) for mesh in trimesh_parts(path, content))


def _surface(mesh: Any, smooth: bool) -> Surface:
    """Return the surface of a trimesh mesh."""
    normals = np.asarray(mesh.vertex_normals, dtype=float)[mesh.faces] if smooth else None
    surface = Surface(np.asarray(mesh.triangles, dtype=float), normals)
    looks = mesh.visual
    if looks.kind == "texture":
        return _with_material(surface, looks, mesh.faces)
    if looks.kind in ("vertex", "face"):
        return _with_palette(surface, np.asarray(looks.face_colors)[:, :3])
    return surface


def _with_material(surface: Surface, looks: Any, faces: NDArray[np.int64]) -> Surface:
    """Return a surface with its texture, or with the plain colour of its material."""
    material = looks.material
    picture = getattr(material, "baseColorTexture", None) or getattr(material, "image", None)
    if picture is not None and looks.uv is not None:
        content = BytesIO()
        picture.convert("RGB").save(content, "PNG")
        places: Floats = np.asarray(looks.uv, dtype=float)[faces]
        return surface._replace(places=places, texture=content.getvalue())
    red, green, blue = (float(part) / 255 for part in material.main_color[:3])
    return surface._replace(color=hex_color(red, green, blue))


def _with_palette(surface: Surface, colors: NDArray[np.uint8]) -> Surface:
    """Return a surface with the colours (n, 3) of its triangles, as texture coordinates in an image of all colours.

    PyBullet does not draw face colours. If there are more than `MOST_COLOURS`, they are rounded.
    """
    bits = 0
    while len(found := np.unique(colors >> bits, axis=0)) > MOST_COLOURS:
        bits += 1
    if len(found) == 1:
        red, green, blue = (colors.mean(0) / 255).tolist()
        return surface._replace(color=hex_color(red, green, blue))
    _, numbers = np.unique(colors >> bits, axis=0, return_inverse=True)
    side = int(np.ceil(np.sqrt(len(found))))
    palette = np.zeros((side * side, 3), dtype=np.uint8)
    palette[: len(found)] = (found << bits) + ((1 << bits) >> 1)
    rows, columns = np.divmod(numbers.ravel(), side)
    places = np.stack([(columns + 0.5) / side, 1.0 - (rows + 0.5) / side], 1)
    content = portable_picture(palette.reshape(side, side, 3))
    return surface._replace(places=np.repeat(places[:, None], 3, 1), texture=content, suffix=".tga")


def portable_picture(colors: NDArray[np.uint8]) -> bytes:
    """Return pixels (height, width, 3) as a Targa image file, made without an imaging package."""
    height, width = colors.shape[:2]
    header = bytes([0, 0, 2, 0, 0, 0, 0, 0, 0, 0, 0, 0, width & 255, width >> 8, height & 255, height >> 8, 24, 32])
    return header + colors[:, :, ::-1].tobytes()
