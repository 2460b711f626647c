"""Measure a cavity with vertical walls exactly, along the walls, which may be turned in the file of the body.

The walls are the largest planes that face the cavity in four perpendicular directions. The space between them counts as
the cavity only if it is about as large as the cavity on the grid, and if nothing of the body is in it, except at its
vertical edges, where walls may be rounded.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from prag_asp.scene.scene import Cavity

Floats = NDArray[np.float64]

VERTICAL = 1e-3
"""The largest slope of a vertical wall, and the largest angle in radians between parallel walls."""

SAME_PLANE = 1e-5
"""The distance in metres within which parallel walls are in the same plane, and a wall may be inside the cavity."""

ROUNDED = 0.2
"""The largest share of a side, at each of its ends, that rounded walls take up."""

FREE = 1.0 - 2 * ROUNDED
"""The share of a side on which the wall must be straight."""

QUARTERS = ((1, 0), (0, 1), (-1, 0), (0, -1))
"""The four directions, along the axes of a cavity, in which it has walls."""


def boxed_cavity(triangles: Floats, cavity: Cavity, cell: float, gap: float) -> Cavity | None:
    """Return a cavity with the exact sides between its vertical walls, or None if it is not between four of them.

    `triangles` (n, 3, 3) form the body. The given cavity was found on a grid with cells of `cell` metres, after gaps of
    `gap` metres were closed, which also takes up the corners of a turned cavity.
    """
    narrower = 2 * gap + 4 * cell
    middle, sides = np.array(cavity.middle), np.array(cavity.sides)
    points, inward = _walls(triangles - middle, sides + narrower * np.array([1.0, 1.0, 0.0]))
    if not len(points):
        return None
    yaw = _main_direction(points, inward)
    cosine, sine = math.cos(yaw), math.sin(yaw)
    turn = np.array([(cosine, -sine, 0.0), (sine, cosine, 0.0), (0.0, 0.0, 1.0)])
    places = [_wall_place(points @ turn, inward @ turn[:2, :2], np.array(quarter)) for quarter in QUARTERS]
    far_x, far_y, near_x, near_y = (math.nan if place is None else place for place in places)
    exact = np.array([far_x + near_x, far_y + near_y])
    if not np.isfinite(exact).all():
        return None
    # The box around a turned cavity is wider than the cavity.
    around = np.abs(turn[:2, :2]) @ exact
    more = around - sides[:2]
    if min(exact) <= 0.0 or more.max() > narrower or more.min() < -2 * cell:
        return None
    centre = np.array([(far_x - near_x) / 2, (far_y - near_y) / 2, 0.0])
    local = (triangles - middle) @ turn - centre
    if not all(_is_free(local, exact * share / 2, float(sides[2])) for share in ((1.0, FREE), (FREE, 1.0))):
        return None
    x, y, z = (turn @ centre + middle).tolist()
    return Cavity((x, y, z), (float(exact[0]), float(exact[1]), float(sides[2])), yaw)


def _walls(triangles: Floats, sides: Floats) -> tuple[Floats, Floats]:
    """Return the vertical triangles (n, 3, 3) that face a cavity whose floor is at the origin, and their area vectors.

    They are within given sides. The area vectors (n, 2) are horizontal and point into the cavity.
    """
    areas = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0]) / 2
    lengths = np.linalg.norm(areas, axis=1)
    facing = np.einsum("ij,ij->i", areas[:, :2], triangles[:, 0, :2]) < 0.0
    low, high = np.array([*-sides[:2] / 2, SAME_PLANE]), np.array([*sides[:2] / 2, sides[2] - SAME_PLANE])
    near = ((triangles.min(1) <= high) & (triangles.max(1) >= low)).all(1)
    chosen = facing & near & (np.abs(areas[:, 2]) <= VERTICAL * lengths)
    return triangles[chosen], areas[chosen, :2]


def _main_direction(points: Floats, inward: Floats) -> float:
    """Return the direction of the largest wall, in radians from -45 to 45 degrees from an axis of the body."""
    angles, areas = np.arctan2(inward[:, 1], inward[:, 0]), np.linalg.norm(inward, axis=1)
    apart = np.abs(np.exp(4j * angles)[:, None] - np.exp(4j * angles)[None])
    best = int(((apart <= 4 * VERTICAL) * areas).sum(1).argmax())
    yaw = float(angles[best]) % (math.pi / 2)
    yaw = yaw - math.pi / 2 if yaw > math.pi / 4 else yaw
    return 0.0 if abs(yaw) < SAME_PLANE else yaw


def _wall_place(points: Floats, inward: Floats, outward: NDArray[np.int_]) -> float | None:
    """Return how far, in metres, the largest wall in a direction is from the origin, or None if there is none."""
    areas = np.linalg.norm(inward, axis=1)
    across = -inward @ outward >= (1.0 - VERTICAL**2) * areas
    places = (points[across][:, :, :2] @ outward).mean(1)
    if not len(places):
        return None
    order = np.argsort(places)
    begins = np.flatnonzero(np.diff(places[order], prepend=-np.inf) > SAME_PLANE)
    sums = np.add.reduceat(areas[across][order], begins)
    return float(places[order][begins[int(sums.argmax())]])


def _is_free(triangles: Floats, half: Floats, height: float) -> bool:
    """Return whether no triangle is in a box on the origin, given by half of its sides and its height in metres."""
    low = np.array([*-half, 0.0]) + SAME_PLANE
    high = np.array([*half, height]) - SAME_PLANE
    near = (triangles.min(1) < high).all(1) & (triangles.max(1) > low).all(1)
    return not any(_meets(triangle, low, high) for triangle in triangles[near])


def _meets(triangle: Floats, low: Floats, high: Floats) -> bool:
    """Return whether a triangle (3, 3) has a point in a box (Sutherland and Hodgman, 1974)."""
    polygon = list(triangle)
    for axis in range(3):
        for sign, end in ((1.0, high[axis]), (-1.0, -low[axis])):
            cut = []
            for i, point in enumerate(polygon):
                before, here, there = polygon[i - 1], end - sign * point[axis], end - sign * polygon[i - 1][axis]
                if (here >= 0.0) != (there >= 0.0):
                    cut.append(before + there / (there - here) * (point - before))
                if here >= 0.0:
                    cut.append(point)
            polygon = cut
    return bool(polygon)
