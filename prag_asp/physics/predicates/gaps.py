"""Constraints that predicates imply on the positions of bodies: lower bounds on differences of coordinates.

The predicate has to imply each constraint for every orientation of the bodies. Along x and y, constraints compare the
centres of bodies; along z, the bottoms and tops of their bounding boxes.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from typing import NamedTuple

from prag_asp.physics.extent import extent, least_reach
from prag_asp.scene.geometry import extents, yaw_quaternion
from prag_asp.scene.scene import Scene, Shape

ROUNDING = 1e-9
"""The difference in metres below which lengths are considered equal."""

Node = tuple[str, str]
"""A body, a robot (for its tool) or the origin, and the part of it whose coordinate is constrained."""

ORIGIN: Node = ("", "centre")
"""The origin of the scene."""

Z = 2


class Gap(NamedTuple):
    """The constraint that the coordinate of `high` minus the coordinate of `low` is at least `least` metres."""

    low: Node
    high: Node
    least: float


Demand = tuple[int, Gap]
"""An axis (0 is x, 1 is y, 2 is z) and a constraint along it."""


def between(node: Node, other: Node, least: float, most: float) -> tuple[Gap, Gap]:
    """Return the constraints that a coordinate exceeds another by `least` to `most` metres."""
    return Gap(other, node, least), Gap(node, other, -most)


def along(axis: int, gaps: Iterable[Gap]) -> Iterator[Demand]:
    """Yield each gap as a constraint along an axis."""
    return ((axis, gap) for gap in gaps)


def centre(entity: str) -> Node:
    """Return the centre of a body, or of the tool of a robot."""
    return (entity, "centre")


def bottom(entity: str) -> Node:
    """Return the lowest point of a body."""
    return (entity, "bottom")


def top(entity: str) -> Node:
    """Return the highest point of a body."""
    return (entity, "top")


def thinnest(entity: str, axis: int, scene: Scene) -> float:
    """Return the minimum extent of a body from its origin along an axis over all its orientations, in metres."""
    shape, place = scene.shapes[entity], scene.fixed.get(entity)
    if place is None:
        return least_reach(shape)
    middle, half = extent(shape, yaw_quaternion(place[2]))
    return half[axis] - abs(middle[axis])


def above(scene: Scene, entity: str, support: str, half: tuple[float, float]) -> Iterator[Demand]:
    """Yield constraints that a body's centre is above a rectangle, or its inscribed circle, centred on another body."""
    place = scene.fixed.get(support)
    round_top = scene.shapes[support].traits.round
    for axis in (0, 1):
        reach = half[0] if round_top else math.hypot(*half)
        if place is not None and not round_top:
            reach = extents(Shape("box", (2 * half[0], 2 * half[1], 0.0)), yaw_quaternion(place[2]))[axis]
        yield from along(axis, between(centre(entity), centre(support), -reach, reach))
