"""The primitives box, cylinder and ball: their reach, their outline from above, their volume.

Other bodies, such as containers, reach as far as their bounding boxes.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import NamedTuple

from prag_asp.scene.boxes import Vector

Point = tuple[float, float]
Outline = tuple[Point, ...]

CIRCLE_SIDES = 16
"""Corners of the outline of a cylinder: it misses 2 percent of the radius at most."""


class Primitive(NamedTuple):
    """The extent of a primitive, as functions of half the sides of its bounding box, in metres.

    `reach` is how far it reaches from its middle along a unit vector in its own axes. `outline` are its corners from
    above, counter-clockwise, by x, y and yaw of its middle; of a ball where it stands. `volume` is in cubic metres.
    """

    reach: Callable[[Vector, Vector], float]
    outline: Callable[[Vector, float, float, float], Outline]
    volume: Callable[[Vector], float]


def rectangle(x: float, y: float, half_x: float, half_y: float, yaw: float) -> Outline:
    """Return the corners of a turned rectangle, counter-clockwise."""
    cosine, sine = math.cos(yaw), math.sin(yaw)
    corners = ((half_x, half_y), (-half_x, half_y), (-half_x, -half_y), (half_x, -half_y))
    return tuple((x + cosine * a - sine * b, y + sine * a + cosine * b) for a, b in corners)


def _box_reach(half: Vector, direction: Vector) -> float:
    return abs(direction[0]) * half[0] + abs(direction[1]) * half[1] + abs(direction[2]) * half[2]


def _box_outline(half: Vector, x: float, y: float, yaw: float) -> Outline:
    return rectangle(x, y, half[0], half[1], yaw)


def _box_volume(half: Vector) -> float:
    return 8 * half[0] * half[1] * half[2]


def _cylinder_reach(half: Vector, direction: Vector) -> float:
    along = direction[2]
    return abs(along) * half[2] + half[0] * math.sqrt(max(0.0, 1.0 - along * along))


def _cylinder_outline(half: Vector, x: float, y: float, yaw: float) -> Outline:
    angles = [2 * math.pi * i / CIRCLE_SIDES for i in range(CIRCLE_SIDES)]
    return tuple((x + half[0] * math.cos(a), y + half[0] * math.sin(a)) for a in angles)


def _cylinder_volume(half: Vector) -> float:
    return math.pi * half[0] * half[0] * 2 * half[2]


def _ball_reach(half: Vector, direction: Vector) -> float:
    return half[0]


def _ball_outline(half: Vector, x: float, y: float, yaw: float) -> Outline:
    return ((x, y),)


def _ball_volume(half: Vector) -> float:
    return 4 * math.pi * half[0] ** 3 / 3


BOX = Primitive(_box_reach, _box_outline, _box_volume)
CYLINDER = Primitive(_cylinder_reach, _cylinder_outline, _cylinder_volume)
BALL = Primitive(_ball_reach, _ball_outline, _ball_volume)

FORMS: Mapping[str, Primitive] = {"box": BOX, "cylinder": CYLINDER, "sphere": BALL}
"""The primitives that bodies are made of; a body from a URDF can have meshes, too."""
