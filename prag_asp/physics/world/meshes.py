"""Meshes as PyBullet reads them, written from what was read and measured: it has that body and no other.

Its own readers count points that no face uses, and a face of two corners or an .stl that is text ends the process.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import lru_cache
from hashlib import sha256
from itertools import chain

from prag_asp.scene.read.mesh import Part, mesh_parts, state_of
from prag_asp.scene.scene import Solid


def mesh_file(solid: Solid) -> tuple[str, bytes]:
    """Return an .obj with a mesh in metres, of which each object collides as its hull, and a name that is its alone.

    Raises:
        SceneError: the mesh cannot be read.
    """
    return _file(solid.mesh, solid.size, state_of(solid.mesh))


@lru_cache(maxsize=32)
def _file(mesh: str, scale: tuple[float, float, float], _state: tuple[int, int]) -> tuple[str, bytes]:
    """Return an .obj and its name; a mesh that is in another state is another one.

    Raises:
        SceneError: the mesh cannot be read.
    """
    content = ("\n".join(_lines(mesh_parts(mesh, scale))) + "\n").encode("ascii")
    return f"{sha256(content).hexdigest()[:32]}.obj", content


def _lines(parts: Sequence[Part]) -> Iterator[str]:
    """Yield the lines of an .obj: all points, then the faces of each part as an object of its own."""
    numbers = {point: i for i, point in enumerate(dict.fromkeys(chain.from_iterable(chain.from_iterable(parts))), 1)}
    for x, y, z in numbers:
        yield f"v {x!r} {y!r} {z!r}"
    for i, part in enumerate(parts):
        yield f"o part_{i}"
        for one, two, three in part:
            yield f"f {numbers[one]} {numbers[two]} {numbers[three]}"
