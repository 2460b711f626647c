"""Read the visible surfaces of a mesh: its triangles with colours, textures and normals.

Wavefront .obj files with their material libraries are read here, and other formats by trimesh; an .stl has no colours.
"""

from __future__ import annotations

from functools import lru_cache
from pathlib import Path

import numpy as np

from prag_asp.errors import SceneError
from prag_asp.safe_reading import read_bytes
from prag_asp.scene.read.looks.obj_surfaces import read_obj, read_texture
from prag_asp.scene.read.looks.surface import Surface
from prag_asp.scene.read.looks.trimesh_surfaces import read_surfaces
from prag_asp.scene.read.mesh import LARGEST, file_parts, state_of
from prag_asp.scene.scene import Look, Shape


def mesh_surfaces(path: str, folder: str) -> tuple[Surface, ...]:
    """Return the visible surfaces of a mesh in the unit of its file; the files that it names must be inside a folder.

    A material has its plain colour if its texture is missing, is outside the folder or has an unknown format.

    Raises:
        SceneError: the file cannot be read.
    """
    return _surfaces(path, folder, state_of(path))


@lru_cache(maxsize=64)
def _surfaces(path: str, folder: str, _state: tuple[int, int]) -> tuple[Surface, ...]:
    """Return the surfaces of a mesh; the state of its file is part of the cache key."""
    match Path(path).suffix.lower():
        case ".obj":
            try:
                return read_obj(read_bytes(path, at_most=LARGEST), Path(path), Path(folder))
            except OSError as error:
                raise SceneError(f"{path}: cannot be read: {error.strerror}") from error
            except (ValueError, IndexError) as error:
                raise SceneError(f"{path}: not a mesh: {error}; export it anew") from error
        case ".stl":
            return tuple(Surface(np.array(part, dtype=float)) for part in file_parts(path))
    try:
        return read_surfaces(path, read_bytes(path, at_most=LARGEST))
    except OSError as error:
        raise SceneError(f"{path}: cannot be read: {error.strerror}") from error
    except ValueError as error:
        raise SceneError(f"{path}: not a mesh: {error}; export it anew") from error


def look_surfaces(look: Look) -> tuple[Surface, ...]:
    """Return the visible surfaces of a look that is a mesh, in the unit of its file.

    Raises:
        SceneError: the file cannot be read.
    """
    surfaces = mesh_surfaces(look.solid.mesh, look.folder)
    if not look.color and not look.texture:
        return surfaces
    texture = read_texture(look.texture, Path(look.folder)) if look.texture else b""
    suffix = Path(look.texture).suffix.lower()
    painted = []
    for surface in surfaces:
        plain = not surface.color and not surface.texture
        own = surface._replace(color=look.color) if plain else surface
        fits = texture and plain and surface.places is not None
        painted.append(own._replace(texture=texture, suffix=suffix) if fits else own)
    return tuple(painted)


def is_painted(shape: Shape) -> bool:
    """Return whether a visual part of a body specifies a colour or texture.

    Raises:
        SceneError: a file cannot be read.
    """
    looks = () if shape.model is None else shape.model.looks
    return any(
        look.color or (look.solid.mesh and any(each.color or each.texture for each in look_surfaces(look)))
        for look in looks
    )
