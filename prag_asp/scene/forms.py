"""The primitives box, cylinder and ball: how far they extend, their outlines seen from above, and their volumes.

Other bodies, such as containers, extend as far as their bounding boxes.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import NamedTuple

from prag_asp.scene.boxes import Vector

Point = tuple[float, float]
Outline = tuple[Point, ...]

CIRCLE = tuple(2 * math.pi * i / 16 for i in range(16))
"""The directions from the axis of a cylinder to the corners of its outline, in radians; the error is at most 2 percent
of the radius."""


class Primitive(NamedTuple):
    """The extent of a primitive, as functions of the half-extents of its bounding box, in metres.

    `reach` is the distance from the centre of the primitive to the farthest point along a unit vector, in the
    primitive's own frame. `outline` returns its corners seen from above, counter-clockwise, for a given x, y and yaw of
    its centre; for a ball, it returns the contact point. `volume` is in cubic metres.
    """

    reach: Callable[[Vector, Vector], float]
    outline: Callable[[Vector, float, float, float], Outline]
    volume: Callable[[Vector], float]


def rectangle(x: float, y: float, half_x: float, half_y: float, yaw: float) -> Outline:
    """Return the corners of a rotated rectangle, counter-clockwise."""
    cosine, sine = math.cos(yaw), math.sin(yaw)
    corners = ((half_x, half_y), (-half_x, half_y), (-half_x, -half_y), (half_x, -half_y))
    return tuple((x + cosine * a - sine * b, y + sine * a + cosine * b) for a, b in corners)


BOX = Primitive(
    reach=lambda half, to: abs(to[0]) * half[0] + abs(to[1]) * half[1] + abs(to[2]) * half[2],
    outline=lambda half, x, y, yaw: rectangle(x, y, half[0], half[1], yaw),
    volume=lambda half: 8 * half[0] * half[1] * half[2],
)
CYLINDER = Primitive(
    reach=lambda half, to: abs(to[2]) * half[2] + half[0] * math.sqrt(max(0.0, 1.0 - to[2] * to[2])),
    outline=lambda half, x, y, yaw: tuple((x + half[0] * math.cos(a), y + half[0] * math.sin(a)) for a in CIRCLE),
    volume=lambda half: math.pi * half[0] * half[0] * 2 * half[2],
)
BALL = Primitive(
    reach=lambda half, to: half[0],
    outline=lambda half, x, y, yaw: ((x, y),),
    volume=lambda half: 4 * math.pi * half[0] ** 3 / 3,
)

FORMS: Mapping[str, Primitive] = {"box": BOX, "cylinder": CYLINDER, "sphere": BALL}
"""The primitives that make up bodies; a body from a file can also have meshes."""
