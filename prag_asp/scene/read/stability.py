"""The static stability of a body from a URDF that stands upright.

Its base is the convex hull of all its points within `CONTACT` of the lowest one. Boxes and meshes are sampled at their
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
"""The height in metres up to which a body touches the ground: PyBullet has contacts between bodies that near."""

STABLE_DEPTH = 0.0025
"""The smallest distance of the centre of mass from the edge of the base, in metres: a little more than `CONTACT`."""

TURNS = tuple(2 * math.pi * i / 64 for i in range(64))
"""The directions, in radians, in which the base and round surfaces are sampled: one every 5.6 degrees."""


def falls(solids: Sequence[Solid]) -> bool:
    """Return whether the centre of mass of a body, the origin of its solids, is outside its base or at its edge.

    A round base counts as if it were flat.

    Raises:
        SceneError: a mesh cannot be read.
    """
    points = []
    for solid in solids:
        rows = rotation(solid.turn)
        for point in _own_points(solid):
            turned = (sum(a * b for a, b in zip(row, point, strict=True)) for row in rows)
            points.append([side + at for side, at in zip(turned, solid.at, strict=True)])
    lowest = min(z for _, _, z in points)
    base = [(x, y) for x, y, z in points if z <= lowest + CONTACT]
    # The depth of the centre within the hull of the base: its smallest distance from a line that bounds the base.
    headings = [(math.cos(turn), math.sin(turn)) for turn in TURNS]
    return min(max(x * a + y * b for x, y in base) for a, b in headings) < STABLE_DEPTH


def _own_points(solid: Solid) -> Iterator[Size]:
    """Yield points of the surface of a solid in its own axes, in metres."""
    x, y, z = (side / 2 for side in solid.size)
    circle = [(math.cos(turn), math.sin(turn)) for turn in TURNS]
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
