"""Files of meshes for PyBullet, written from what was read and measured: it has that body and no other.

Its own readers count points that no face uses, and a face of two corners or an .stl that is text ends the process.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import cache
from hashlib import sha256
from itertools import chain
from pathlib import Path
from tempfile import TemporaryDirectory

from prag_asp.scene.model import Solid
from prag_asp.scene.read.mesh import Part, mesh_parts


def mesh_file(solid: Solid) -> str:
    """Return the path of an .obj with a mesh in metres, of which each object collides as its hull.

    It is written once in a process, and again where the mesh has changed.

    Raises:
        SceneError: the mesh cannot be read.
    """
    parts = mesh_parts(solid.mesh, solid.size)
    about = Path(solid.mesh).stat()
    name = sha256(repr((solid.mesh, about.st_mtime_ns, about.st_size, solid.size)).encode()).hexdigest()
    path = Path(_folder().name) / f"{name[:32]}.obj"
    if not path.exists():
        path.write_text("\n".join(_lines(parts)) + "\n", encoding="ascii")
    return str(path)


@cache
def _folder() -> TemporaryDirectory[str]:
    """Return a folder that is there as long as the process."""
    return TemporaryDirectory(prefix="prag_asp_")


def _lines(parts: Sequence[Part]) -> Iterator[str]:
    """Yield the lines of an .obj: all points, then the faces of each part as an object of its own."""
    numbers = {point: i for i, point in enumerate(dict.fromkeys(chain.from_iterable(chain.from_iterable(parts))), 1)}
    for x, y, z in numbers:
        yield f"v {x!r} {y!r} {z!r}"
    for i, part in enumerate(parts):
        yield f"o part_{i}"
        for one, two, three in part:
            yield f"f {numbers[one]} {numbers[two]} {numbers[three]}"
