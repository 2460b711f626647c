"""Mesh files for PyBullet, written from the meshes that we have read and measured, so that both agree.

PyBullet's own readers include points that no face uses, and crash on a face of two corners or on an ASCII .stl.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import lru_cache
from hashlib import sha256
from itertools import chain

from prag_asp.scene.read.mesh import Part, mesh_parts, state_of
from prag_asp.scene.scene import Solid


def mesh_file(solid: Solid) -> tuple[str, bytes]:
    """Return a unique name and an .obj with a mesh in metres, each object of which collides as its convex hull.

    Raises:
        SceneError: the mesh cannot be read.
    """
    return _file(solid.mesh, solid.size, state_of(solid.mesh))


@lru_cache(maxsize=32)
def _file(mesh: str, scale: tuple[float, float, float], _state: tuple[int, int]) -> tuple[str, bytes]:
    """Return a name and an .obj; `_state` is that of the mesh's file, so that a changed file is read again.

    Raises:
        SceneError: the mesh cannot be read.
    """
    content = ("\n".join(_lines(mesh_parts(mesh, scale))) + "\n").encode("ascii")
    return f"{sha256(content).hexdigest()[:32]}.obj", content


def _lines(parts: Sequence[Part]) -> Iterator[str]:
    """Yield the lines of an .obj: all points, then the faces of each part as a separate object."""
    numbers = {point: i for i, point in enumerate(dict.fromkeys(chain.from_iterable(chain.from_iterable(parts))), 1)}
    for x, y, z in numbers:
        yield f"v {x!r} {y!r} {z!r}"
    for i, part in enumerate(parts):
        yield f"o part_{i}"
        for one, two, three in part:
            yield f"f {numbers[one]} {numbers[two]} {numbers[three]}"
