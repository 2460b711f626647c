"""Bounding boxes of the convex parts of bodies from files, between which other bodies have room."""

from __future__ import annotations

from functools import lru_cache

from prag_asp.scene.boxes import Box, Vector, box_of
from prag_asp.scene.geometry import Pose, Quaternion, matrix
from prag_asp.scene.scene import Shape
from prag_asp.scene.surfaces import part_surfaces


def part_boxes(shape: Shape, pose: Pose) -> list[Box]:
    """Return the box around each convex part of a body along the axes of the world, in metres."""
    x, y, z = pose.position
    return [((x + a, y + b, z + c), half) for (a, b, c), half in _boxes(shape, pose.quaternion)]


@lru_cache(maxsize=1 << 10)
def _boxes(shape: Shape, quaternion: Quaternion) -> tuple[Box, ...]:
    """Return the box around each convex part of a turned body at the origin."""
    rows = matrix(Pose((0.0, 0.0, 0.0), quaternion))[:3, :3]
    turned = (part.reshape(-1, 3) @ rows.T for part in part_surfaces(shape))
    return tuple(box_of((_vector(part.min(0).tolist()), _vector(part.max(0).tolist()))) for part in turned)


def _vector(values: list[float]) -> Vector:
    """Return three numbers as a tuple."""
    x, y, z = values
    return (x, y, z)
