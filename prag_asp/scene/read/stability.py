"""The static stability of a body of solids, upright as its URDF has it.

Its support is the hull of all its points within `CONTACT` of the lowest one. Boxes and meshes are sampled at their
corners, cylinders and balls all around, balls also just above their lowest point.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from itertools import product

from prag_asp.scene.read.mesh import mesh_points
from prag_asp.scene.scene import Size, Solid

Rows = tuple[Size, Size, Size]
CONTACT = 0.002
"""The height in metres up to which a body touches the ground: to PyBullet, bodies that near are in contact."""

STABLE_DEPTH = 0.0025
"""The least distance of the centre of mass from the edge of the support, in metres: a little more than `CONTACT`."""

DIRECTIONS = 64
"""Directions in which the support and round surfaces are sampled: one every 5.6 degrees."""


def falls(solids: Sequence[Solid]) -> bool:
    """Return whether the centre of mass of a body is outside its support, or on an edge of it.

    The solids are relative to the middle. A round foot counts as if it were flat.
    """
    points = [point for solid in solids for point in _surface(solid)]
    lowest = min(z for _, _, z in points)
    foot = [(x, y) for x, y, z in points if z <= lowest + CONTACT]
    return _depth(foot) < STABLE_DEPTH


def _depth(foot: Sequence[tuple[float, float]]) -> float:
    """Return how far within the convex hull of points the origin is in metres, negative outside.

    It is the least distance, of all directions, from the origin to the line that bounds the points there.
    """
    angles = (2 * math.pi * i / DIRECTIONS for i in range(DIRECTIONS))
    return min(max(x * math.cos(a) + y * math.sin(a) for x, y in foot) for a in angles)


def _surface(solid: Solid) -> Iterator[Size]:
    """Yield points of the surface of a solid in the frame of its body, in metres.

    Raises:
        SceneError: its mesh cannot be read.
    """
    rows = rotation(solid.turn)
    for point in _own_points(solid):
        x, y, z = (
            sum(a * b for a, b in zip(row, point, strict=True)) + at for row, at in zip(rows, solid.at, strict=True)
        )
        yield x, y, z


def _own_points(solid: Solid) -> Iterator[Size]:
    """Yield points of the surface of a solid in its own axes, in metres."""
    x, y, z = (side / 2 for side in solid.size)
    angles = [2 * math.pi * i / DIRECTIONS for i in range(DIRECTIONS)]
    circle = [(math.cos(angle), math.sin(angle)) for angle in angles]
    if solid.mesh:
        yield from mesh_points(solid.mesh, solid.size)
    elif solid.kind == "box":
        yield from product((-x, x), (-y, y), (-z, z))
    elif solid.kind == "cylinder":
        yield from ((x * a, x * b, height) for a, b in circle for height in (-z, z))
    else:
        yield from ((x * a * c, x * b * c, x * d) for a, b in circle for c, d in circle)
        low = 0.99 * min(CONTACT, x)
        wide = math.sqrt(low * (2 * x - low))
        yield from ((wide * a, wide * b, low - x) for a, b in circle)


def rotation(turn: Size) -> Rows:
    """Return the rotation matrix of roll, pitch and yaw about the fixed axes, in radians."""
    (a, b), (c, d), (e, f) = ((math.cos(angle), math.sin(angle)) for angle in turn)
    return (
        (e * c, e * d * b - f * a, e * d * a + f * b),
        (f * c, f * d * b + e * a, f * d * a - e * b),
        (-d, c * b, c * a),
    )
