"""Read the triangles of meshes in formats that trimesh knows: .ply, .glb, .gltf, .dae and .off."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from io import BytesIO
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from prag_asp.errors import SceneError
from prag_asp.safe_reading import read_bytes

Floats = NDArray[np.float64]

LARGEST = 32_000_000
"""The largest size in bytes of a file that a mesh refers to, such as a buffer of a .gltf."""


class FilesBeside(Mapping[str, bytes]):
    """The files in the folder of a mesh, by their names; they are read when they are looked up."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder

    def __getitem__(self, name: str) -> bytes:
        try:
            return read_bytes(self._folder / name, within=self._folder, at_most=LARGEST)
        except OSError as error:
            raise KeyError(name) from error

    def __iter__(self) -> Iterator[str]:
        return iter(())

    def __len__(self) -> int:
        return 0


def read_parts(path: str, content: bytes) -> list[Floats]:
    """Return the triangles (n, 3, 3) of each part of a mesh file, in the unit of the file.

    Raises:
        SceneError: trimesh is not installed.
        ValueError: the file is not a mesh.
    """
    try:
        import trimesh  # noqa: PLC0415 - an extra
    except ImportError:
        remedy = 'install it: pip install "prag_asp[meshes]", or give an .obj or an .stl'
        raise SceneError(f"{path}: meshes of this format need trimesh; {remedy}") from None
    kind = Path(path).suffix.lower().removeprefix(".")
    try:
        scene = trimesh.load_scene(BytesIO(content), file_type=kind, resolver=FilesBeside(Path(path).parent))
        meshes = [each for each in scene.dump() if isinstance(each, trimesh.Trimesh)]
    except Exception as error:  # its readers raise whatever they meet in a broken file
        raise ValueError(" ".join(str(error).split())[:200] or type(error).__name__) from error
    return [np.asarray(mesh.triangles, dtype=float) for mesh in meshes]
