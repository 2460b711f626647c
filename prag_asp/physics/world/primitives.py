"""Collision and visual shapes of PyBullet from boxes, cylinders and balls."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any, NamedTuple

from prag_asp.errors import SceneError
from prag_asp.physics.geometry import IDENTITY, Quaternion, Vector
from prag_asp.physics.world.bullet import pybullet

NOTHING = -1


class Part(NamedTuple):
    """A primitive of a body: its kind in PyBullet, its sizes and its place in the body in metres.

    A `mesh` is a file, of which the hull is taken, with its `scale`.
    """

    kind: int
    half: Vector = (0.0, 0.0, 0.0)
    radius: float = 0.0
    height: float = 0.0
    at: Vector = (0.0, 0.0, 0.0)
    turn: Quaternion = IDENTITY
    mesh: str = ""
    scale: Vector = (1.0, 1.0, 1.0)


def boxes(places: Iterable[tuple[Vector, Vector]]) -> list[Part]:
    """Return boxes, each given by its centre and half its sides in metres."""
    return [Part(pybullet.GEOM_BOX, half=half, at=at) for at, half in places]


def make_shapes(parts: Sequence[Part], client: int, color: str | None) -> tuple[int, int]:
    """Return the ids of what several primitives collide with and look like; without a colour they cannot be seen.

    Raises:
        SceneError: PyBullet refuses one.
    """
    kinds = [part.kind for part in parts]
    radii, lengths = [part.radius for part in parts], [part.height for part in parts]
    halves, centres = [part.half for part in parts], [part.at for part in parts]
    solid = pybullet.createCollisionShapeArray(
        shapeTypes=kinds,
        radii=radii,
        lengths=lengths,
        halfExtents=halves,
        collisionFramePositions=centres,
        **_turned("collision", parts),
        physicsClientId=client,
    )
    looks = NOTHING
    if color is not None:
        rgba = [int(color[i : i + 2], 16) / 255 for i in (1, 3, 5)] + [1.0]
        looks = pybullet.createVisualShapeArray(
            shapeTypes=kinds,
            radii=radii,
            lengths=lengths,
            halfExtents=halves,
            visualFramePositions=centres,
            **_turned("visual", parts),
            rgbaColors=[rgba] * len(kinds),
            physicsClientId=client,
        )
    if solid < 0 or (looks < 0 and color is not None):
        raise SceneError(f"PyBullet refuses a body of {list(parts)}")
    return int(solid), int(looks)


def _turned(what: str, parts: Sequence[Part]) -> dict[str, Any]:
    """Return the arguments for turned parts and for meshes, none where there are none."""
    if not any(part.mesh or part.turn != IDENTITY for part in parts):
        return {}
    return {
        "fileNames": [part.mesh for part in parts],
        "meshScales": [part.scale for part in parts],
        f"{what}FrameOrientations": [part.turn for part in parts],
    }
