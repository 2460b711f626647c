"""Axis-aligned boxes as plain tuples, which are faster than arrays at this size; all in metres.

A `Box` is given by its centre and its half-extents, `Corners` by the lowest and the highest corner.
"""

from __future__ import annotations

from collections.abc import Iterable

Vector = tuple[float, float, float]
Ends = tuple[float, float]
"""The lower and upper end of an extent along an axis."""

Box = tuple[Vector, Vector]
"""The centre and the half-extents of a box."""

Corners = tuple[Vector, Vector]
"""The lowest and the highest corner of a box."""


def box_between(x: Ends, y: Ends, z: Ends) -> Box:
    """Return the box between two ends along each axis."""
    centre = ((x[0] + x[1]) / 2, (y[0] + y[1]) / 2, (z[0] + z[1]) / 2)
    return centre, ((x[1] - x[0]) / 2, (y[1] - y[0]) / 2, (z[1] - z[0]) / 2)


def box_of(corners: Corners) -> Box:
    """Return the box between two corners."""
    (ax, ay, az), (bx, by, bz) = corners
    return box_between((ax, bx), (ay, by), (az, bz))


def corners_of(box: Box) -> Corners:
    """Return the lowest and the highest corner of a box."""
    (x, y, z), (dx, dy, dz) = box
    return (x - dx, y - dy, z - dz), (x + dx, y + dy, z + dz)


def around(boxes: Iterable[Corners]) -> Corners:
    """Return the box around one or more boxes."""
    lows, highs = zip(*boxes, strict=True)
    (ax, ay, az), (bx, by, bz) = (map(min, zip(*lows, strict=True)), map(max, zip(*highs, strict=True)))
    return (ax, ay, az), (bx, by, bz)


def touch(one: Corners, two: Corners) -> bool:
    """Return whether two boxes have a point in common."""
    (ax, ay, az), (bx, by, bz) = one
    (cx, cy, cz), (dx, dy, dz) = two
    return ax <= dx and cx <= bx and ay <= dy and cy <= by and az <= dz and cz <= bz


def widened(box: Corners, rim: float) -> Corners:
    """Return a box enlarged by a margin on every side."""
    (ax, ay, az), (bx, by, bz) = box
    return (ax - rim, ay - rim, az - rim), (bx + rim, by + rim, bz + rim)
