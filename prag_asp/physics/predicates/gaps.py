"""What predicates demand of the places of bodies: least differences between their coordinates, along each axis.

Each demand has to follow from the definition of the predicate for any way in which the bodies may be turned. Along x
and y the centres of bodies are compared, along z the bottoms and tops of their bounding boxes.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from typing import NamedTuple

from prag_asp.scene.geometry import extents, yaw_quaternion
from prag_asp.scene.scene import Scene, Shape

ROUNDING = 1e-9
"""What two lengths have to differ by to be told apart, in metres."""

Node = tuple[str, str]
"""A body (or a robot, for its tool; or the origin) and the part of it whose coordinate is meant."""

ORIGIN: Node = ("", "centre")
"""The origin of the world."""

Z = 2


class Gap(NamedTuple):
    """The coordinate of `high` is at least `least` metres more than that of `low`; `least` may be negative."""

    low: Node
    high: Node
    least: float


Demand = tuple[int, Gap]
"""An axis (0 is x, 1 is y, 2 is z) and what is demanded along it."""


def between(node: Node, other: Node, least: float, most: float) -> tuple[Gap, Gap]:
    """Return that a coordinate is `least` to `most` metres more than another."""
    return Gap(other, node, least), Gap(node, other, -most)


def along(axis: int, gaps: Iterable[Gap]) -> Iterator[Demand]:
    """Yield gaps as demands along an axis."""
    return ((axis, gap) for gap in gaps)


def centre(entity: str) -> Node:
    """Return the middle of a body, or of the tool of a robot."""
    return (entity, "centre")


def bottom(entity: str) -> Node:
    """Return the lowest point of a body."""
    return (entity, "bottom")


def top(entity: str) -> Node:
    """Return the highest point of a body."""
    return (entity, "top")


def thinnest(entity: str, axis: int, scene: Scene) -> float:
    """Return half the side of the bounding box of a body along an axis in metres, as small as it can be."""
    shape, place = scene.shapes[entity], scene.fixed.get(entity)
    return min(shape.half) if place is None else extents(shape, yaw_quaternion(place[2]))[axis]


def above(scene: Scene, entity: str, support: str, half: tuple[float, float]) -> Iterator[Demand]:
    """Yield that the centre of a body is above a rectangle (or the circle in it) in the middle of another."""
    place = scene.fixed.get(support)
    round_top = scene.shapes[support].traits.round
    for axis in (0, 1):
        reach = half[0] if round_top else math.hypot(*half)
        if place is not None and not round_top:
            reach = extents(Shape("box", (2 * half[0], 2 * half[1], 0.0)), yaw_quaternion(place[2]))[axis]
        yield from along(axis, between(centre(entity), centre(support), -reach, reach))
