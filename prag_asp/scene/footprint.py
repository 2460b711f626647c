"""The footprints of bodies on the table, seen from above."""

from __future__ import annotations

import math
from typing import NamedTuple

from prag_asp.scene.forms import Outline, Point, rectangle
from prag_asp.scene.scene import Shape

Place = tuple[float, float, float]
"""x and y in metres, and the yaw in radians."""

TOUCHING = 0.0015
"""The depth in metres by which two bodies may overlap, whether or not they are fixed."""


class Footprint(NamedTuple):
    """An upright body and its position and yaw."""

    shape: Shape
    place: Place = (0.0, 0.0, 0.0)


def corners(footprint: Footprint) -> Outline:
    """Return the corners of a footprint, counter-clockwise; for a round body, those of its bounding square."""
    (x, y, yaw), (half_x, half_y, _) = footprint.place, footprint.shape.half
    return rectangle(x, y, half_x, half_y, 0.0 if footprint.shape.traits.round else yaw)


def apart(one: Footprint, two: Footprint, touching: float) -> bool:
    """Return whether two bodies overlap by less than `touching` metres, using the separating axis theorem."""
    for direction in (*_axes(one, two), *_axes(two, one)):
        (low, high), (other_low, other_high) = _shadow(one, direction), _shadow(two, direction)
        if max(other_low - high, low - other_high) >= -touching:
            return True
    return False


def _axes(footprint: Footprint, other: Footprint) -> list[Point]:
    """Return the unit normals of a body's sides; for a round body, the direction from another body's nearest point."""
    x, y, yaw = footprint.place
    if not footprint.shape.traits.round:
        cosine, sine = math.cos(yaw), math.sin(yaw)
        return [(cosine, sine), (-sine, cosine)]
    nearest = other.place[:2]
    if not other.shape.traits.round:
        nearest = min(corners(other), key=lambda corner: math.dist(corner, (x, y)))
    length = math.dist(nearest, (x, y))
    return [((nearest[0] - x) / length, (nearest[1] - y) / length)] if length > 0.0 else []


def _shadow(footprint: Footprint, direction: Point) -> tuple[float, float]:
    """Return the interval that a body covers along a unit vector, in metres."""
    if footprint.shape.traits.round:
        middle = direction[0] * footprint.place[0] + direction[1] * footprint.place[1]
        return middle - footprint.shape.half[0], middle + footprint.shape.half[0]
    along = [direction[0] * x + direction[1] * y for x, y in corners(footprint)]
    return min(along), max(along)
