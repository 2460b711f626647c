"""PyBullet's collision and visual shapes of solids, and the mesh files that it reads for them.

The files are written from the meshes that we have read and measured, so that PyBullet sees the same geometry.
PyBullet's own readers include points that no face uses, and crash on a face with two corners or on an ASCII .stl file.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from functools import lru_cache
from hashlib import sha256
from itertools import chain
from typing import Any

from prag_asp.errors import SceneError
from prag_asp.physics.bullet import pybullet
from prag_asp.physics.temporary_files import temporary_folder
from prag_asp.physics.world.visible_pieces import VisiblePiece, look_pieces, paint
from prag_asp.scene.read.mesh import mesh_parts, state_of
from prag_asp.scene.scene import Look, Solid

GEOMETRIES: Mapping[str, int] = {
    "box": pybullet.GEOM_BOX,
    "cylinder": pybullet.GEOM_CYLINDER,
    "sphere": pybullet.GEOM_SPHERE,
    "mesh": pybullet.GEOM_MESH,
}
"""PyBullet's types of solids; for a mesh, PyBullet uses the convex hull of each part."""

NOTHING = -1
SHADE, BELT, SPOT, STANDING_OUT = 0.45, 0.12, 0.5, 0.02
"""The marks on a ball, as shares of its brightness and diameter: their shade, the height of the belt, the size of the
spot, and the distance by which both stand out from the surface."""

ASIDE = (0.6, 0.0, 0.8)
STRAIGHT = (0.0, 0.0, 0.0)


@contextmanager
def open_shapes(
    solids: Sequence[Solid], client: int, color: str | None, looks: Sequence[Look] = ()
) -> Iterator[tuple[int, int]]:
    """Yield the ids of the collision and visual shapes of several solids; without a colour, they are invisible.

    The visual shapes are the `looks`, if there are any. PyBullet reads the files of visual shapes only when it makes a
    body, so the body must be made within the context. Calls with meshes must not be nested.

    Raises:
        SceneError: PyBullet refuses a shape, or a mesh cannot be read.
    """
    meshes = {solid: mesh_file(solid) for solid in solids if solid.mesh}
    seen = [] if color is None else visible_pieces(solids, looks, color)
    written = dict(meshes.values())
    for piece in seen:
        written |= piece.files
    with temporary_folder(written) as folder:
        files = {solid: str(folder / name) for solid, (name, _) in meshes.items()}
        body = pybullet.createCollisionShapeArray(
            **_sizes(solids),
            collisionFramePositions=[solid.at for solid in solids],
            **_turned("collision", solids, [files.get(solid, "") for solid in solids]),
            physicsClientId=client,
        )
        appearance = NOTHING
        if seen:
            shown = [piece.solid for piece in seen]
            appearance = pybullet.createVisualShapeArray(
                **_sizes(shown),
                visualFramePositions=[solid.at for solid in shown],
                **_turned("visual", shown, [str(folder / piece.mesh) if piece.mesh else "" for piece in seen]),
                rgbaColors=[piece.rgba for piece in seen],
                physicsClientId=client,
            )
        if body < 0 or (appearance < 0 and seen):
            raise SceneError(f"PyBullet refuses a body of {list(solids)}")
        yield int(body), int(appearance)


def visible_pieces(solids: Sequence[Solid], looks: Sequence[Look], color: str) -> list[VisiblePiece]:
    """Return the visual shape of a body in PyBullet; the given colour multiplies the colours of the looks.

    Raises:
        SceneError: a mesh cannot be read.
    """
    tint = paint(color)
    if looks:
        return [piece for look in looks for piece in look_pieces(look, tint)]
    pieces = [VisiblePiece(solid, tint, *_own_file(solid)) for solid in solids]
    if [solid.kind for solid in solids] == ["sphere"]:
        dark = (*(SHADE * part for part in tint[:3]), 1.0)
        pieces += [VisiblePiece(solid, dark) for solid in _marks(solids[0])]
    return pieces


def _own_file(solid: Solid) -> tuple[str, dict[str, bytes]]:
    """Return the name of a mesh's collision file, and the file by name; both are empty for other solids."""
    if not solid.mesh:
        return "", {}
    name, content = mesh_file(solid)
    return name, {name: content}


def _sizes(solids: Sequence[Solid]) -> dict[str, Any]:
    """Return PyBullet's arguments for the sizes of solids; each type reads those that it needs."""
    return {
        "shapeTypes": [GEOMETRIES[solid.kind] for solid in solids],
        "radii": [solid.size[0] / 2 for solid in solids],
        "lengths": [solid.size[2] for solid in solids],
        "halfExtents": [tuple(side / 2 for side in solid.size) for solid in solids],
    }


def _marks(ball: Solid) -> list[Solid]:
    """Return the marks on a ball that make its rotation visible from all sides: a belt, and a spot beside it."""
    across, (x, y, z) = ball.size[0], ball.at
    belt, spot = BELT * across, SPOT * across
    off = (1 + STANDING_OUT) * across / 2 - spot / 2
    return [
        Solid("cylinder", ((1 + STANDING_OUT) * across, (1 + STANDING_OUT) * across, belt), ball.at),
        Solid("sphere", (spot, spot, spot), (x + off * ASIDE[0], y + off * ASIDE[1], z + off * ASIDE[2])),
    ]


def _turned(what: str, solids: Sequence[Solid], files: Sequence[str]) -> dict[str, Any]:
    """Return PyBullet's arguments for rotated solids and meshes, which are empty if there are no such solids."""
    if not any(solid.mesh or solid.turn != STRAIGHT for solid in solids):
        return {}
    return {
        "fileNames": files,
        "meshScales": [(1.0, 1.0, 1.0)] * len(solids),
        f"{what}FrameOrientations": [pybullet.getQuaternionFromEuler(solid.turn) for solid in solids],
    }


def mesh_file(solid: Solid) -> tuple[str, bytes]:
    """Return a unique name and an .obj file with a mesh in metres; in collisions, each object is its convex hull.

    Raises:
        SceneError: the mesh cannot be read.
    """
    return _mesh_file(solid.mesh, solid.size, state_of(solid.mesh))


@lru_cache(maxsize=32)
def _mesh_file(mesh: str, scale: tuple[float, float, float], _state: tuple[int, int]) -> tuple[str, bytes]:
    """Return a name and an .obj file; `_state` is the state of the mesh file, so that a changed file is read again."""
    parts = mesh_parts(mesh, scale)
    points = dict.fromkeys(chain.from_iterable(chain.from_iterable(parts)))
    numbers = {point: i for i, point in enumerate(points, 1)}
    lines = [f"v {x!r} {y!r} {z!r}" for x, y, z in points]
    for i, part in enumerate(parts):
        lines.append(f"o part_{i}")
        lines += (f"f {numbers[one]} {numbers[two]} {numbers[three]}" for one, two, three in part)
    content = ("\n".join(lines) + "\n").encode("ascii")
    return f"{sha256(content).hexdigest()[:32]}.obj", content
