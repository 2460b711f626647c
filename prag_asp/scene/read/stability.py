"""Determine whether a body from a file stands on the ground and, if not, how it comes to rest.

The base of a body is the convex hull of all its points within `CONTACT` of the lowest one. Boxes and meshes are sampled
at their corners, cylinders and balls all around, and balls also just above their lowest point.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from itertools import product

import numpy as np
from numpy.typing import NDArray

from prag_asp.scene.forms import Outline, Point
from prag_asp.scene.geometry import hull, inside_by
from prag_asp.scene.read.mesh import mesh_points
from prag_asp.scene.scene import Size, Solid

Floats = NDArray[np.float64]

Rows = tuple[Size, Size, Size]
CONTACT = 0.002
"""The height in metres up to which a body touches the ground, because PyBullet reports contacts up to this distance."""

STABLE_DEPTH = 0.0025
"""The smallest distance of the centre of mass from the edge of the base, in metres, which is a little more than
`CONTACT`."""

GRAZING, ROLLS = 0.0002, 0.0003
"""The height in metres above the lowest point up to which points support a body, and the horizontal distance in metres
from these points to the centre of mass beyond which the body rolls, as a lemon does until it lies on its side. Both are
positive, because points in files are rounded."""

TOUCHING = 1e-7
"""The height in metres up to which a point is on the ground, apart from rounding errors."""

MOST_STEPS = 500
"""The largest number of edges over which a body tips; a ball sampled in 64 directions has 64 of them."""

TURNS = tuple(2 * math.pi * i / 64 for i in range(64))
"""The directions, in radians, in which bases and round surfaces are sampled: one every 5.6 degrees."""


def surface_points(solids: Sequence[Solid]) -> Floats:
    """Return points (n, 3) on the surface of solids in the frame of their body, in metres.

    Raises:
        SceneError: a mesh cannot be read.
    """
    own = ((np.array(list(own_points(solid))), solid) for solid in solids)
    return np.concatenate([points @ np.array(rotation(solid.turn)).T + solid.at for points, solid in own])


def base_of(points: Floats, height: float = CONTACT) -> Outline:
    """Return the convex outline, seen from above, of points (n, 3) within a height in metres of the lowest point."""
    near = points[points[:, 2] <= points[:, 2].min() + height]
    return hull([(x, y) for x, y, _ in near.tolist()])


def crown_of(points: Floats) -> Outline:
    """Return the convex outline, seen from above, of the highest of the given points (n, 3)."""
    return base_of(points * (1.0, 1.0, -1.0))


def falls(points: Floats, centre: Floats) -> bool:
    """Return whether a body, given by points (n, 3) on its surface, falls over as it stands.

    It falls over if its `centre` of mass (3,) is outside its base or at the edge of the base. It also falls over if it
    rolls, that is, if the centre is more than `ROLLS` outside the outline of its lowest points. The round base of a
    primitive counts as flat.
    """
    at = (float(centre[0]), float(centre[1]))
    return inside_by(base_of(points), at) < STABLE_DEPTH or _beside(base_of(points, GRAZING), at) > ROLLS


def _beside(base: Outline, at: Point) -> float:
    """Return the distance in metres of a point from a convex outline (or a line or a point), or 0 inside it."""
    if len(base) > 2 and inside_by(base, at) >= 0.0:
        return 0.0
    distances = []
    for (ax, ay), (bx, by) in zip(base, base[1:] + base[:1], strict=True):
        square = (bx - ax) ** 2 + (by - ay) ** 2
        along = ((at[0] - ax) * (bx - ax) + (at[1] - ay) * (by - ay)) / square if square > 0.0 else 0.0
        share = min(1.0, max(0.0, along))
        distances.append(math.dist(at, (ax + share * (bx - ax), ay + share * (by - ay))))
    return min(distances)


def settle(points: Floats, centre: Floats) -> Floats | None:
    """Return the rotation (3, 3) by which a body comes to rest on its convex hull, or None if it rolls on.

    The body tips over the edge of the base nearest to the centre of mass until the next point of the surface touches
    the ground: the quasi-static motion of a body that keeps contact (Goldberg et al., "Part pose statistics", 1999).
    Each step lowers the centre of mass, or starts from an edge on which the body cannot stay.
    """
    rows = np.eye(3)
    for _ in range(MOST_STEPS):
        turned = points @ rows.T
        x, y, _ = rows @ centre
        lowest = turned[:, 2].min()
        on_ground = turned[:, 2] <= lowest + TOUCHING
        base = hull([(a, b) for a, b, _ in turned[on_ground].tolist()])
        if inside_by(base, (x, y)) >= 0.0 and not falls(turned, rows @ centre):
            return rows
        (px, py), (dx, dy) = _pivot(base, (float(x), float(y)))
        ahead = (turned[:, 0] - px) * dx + (turned[:, 1] - py) * dy
        angles = np.arctan2(turned[:, 2] - lowest, ahead)
        # Points on the ground ahead of the pivot are on the pivot, except for rounding errors.
        angle = float(angles[~on_ground].min(initial=np.pi))
        rows = _tipping((dx, dy), angle) @ rows
    return None


def _pivot(base: Outline, at: Point) -> tuple[Point, Point]:
    """Return a point of the base around which a body tips, and the direction in which it tips as a unit vector.

    `at` is the projection of the body's centre of mass onto the ground.
    """
    nearest: tuple[float, Point, Point] | None = None
    for (ax, ay), (bx, by) in zip(base, base[1:] + base[:1], strict=True) if len(base) > 1 else ():
        length = math.hypot(bx - ax, by - ay)
        along = ((at[0] - ax) * (bx - ax) + (at[1] - ay) * (by - ay)) / length**2
        outside = ((at[0] - ax) * (by - ay) - (at[1] - ay) * (bx - ax)) / length
        # If the base is only a line, each side of it is an edge; the loop visits the other side on the way back.
        if 0.0 <= along <= 1.0 and (len(base) > 2 or outside >= 0.0):
            found = (abs(outside), (ax, ay), ((by - ay) / length, (ax - bx) / length))
            nearest = found if nearest is None else min(nearest, found)
    corner = min(base, key=lambda point: math.dist(point, at))
    distance = math.dist(corner, at)
    if nearest is not None and (inside_by(base, at) >= 0.0 or nearest[0] <= distance):
        return nearest[1], nearest[2]
    if distance < TOUCHING:
        return corner, (1.0, 0.0)
    return corner, ((at[0] - corner[0]) / distance, (at[1] - corner[1]) / distance)


def _tipping(direction: Point, angle: float) -> Floats:
    """Return the rotation (3, 3) that tips a body towards a horizontal direction by an angle in radians."""
    x, y = direction
    ahead, across, up = np.array([x, y, 0.0]), np.array([-y, x, 0.0]), np.array([0.0, 0.0, 1.0])
    cosine, sine = math.cos(angle), math.sin(angle)
    tilted = np.stack([cosine * ahead - sine * up, across, sine * ahead + cosine * up], axis=1)
    rotated: Floats = tilted @ np.stack([ahead, across, up])
    return rotated


def own_points(solid: Solid) -> Iterator[Size]:
    """Yield points on the surface of a solid in its own frame, in metres."""
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
    """Return the rotation matrix for roll, pitch and yaw about the fixed axes, in radians."""
    (a, b), (c, d), (e, f) = ((math.cos(angle), math.sin(angle)) for angle in turn)
    return (
        (e * c, e * d * b - f * a, e * d * a + f * b),
        (f * c, f * d * b + e * a, f * d * a - e * b),
        (-d, c * b, c * a),
    )
