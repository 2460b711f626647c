"""``inside`` and ``located``: a body in the cavity of a container, or (``located``) held right above."""

from __future__ import annotations

import math

from prag_asp.physics.geometry import Vector, cavity, extents, multiply, to_local, yaw_of
from prag_asp.physics.predicates.predicate import Arguments, Predicate, Volume, excess, states
from prag_asp.physics.situation import Situation

TOLERANCE = 0.002
FLOOR_BAND = 0.01
HOVER = 0.2
MARGIN = 0.003


def floor_height(situation: Situation, container: str) -> float:
    """Return the height of a container's floor in metres."""
    return situation.bottom(container) + situation.shape(container).wall


def _lateral(situation: Situation, subject: str, container: str) -> float:
    """Return how far the bounding box of a body, in the container's axes, sticks out of it in metres."""
    pose, outer = situation.pose(subject), situation.pose(container)
    x, y, z, w = outer.quaternion
    half = extents(situation.shape(subject), multiply((-x, -y, -z, w), pose.quaternion))
    dx, dy = to_local(outer, pose.position[0], pose.position[1])
    inner = cavity(situation.shape(container))
    return max(abs(dx) + half[0] - inner[0] / 2, abs(dy) + half[1] - inner[1] / 2)


def _height(situation: Situation, subject: str, container: str) -> float:
    """Return how high the lowest point of a body is above the container's floor in metres."""
    return situation.bottom(subject) - floor_height(situation, container)


def _inside_distance(situation: Situation, arguments: Arguments) -> float:
    """Return by how many metres a body misses the floor of the container; a stacked body is not inside."""
    height = _height(situation, *arguments)
    return excess(_lateral(situation, *arguments), -TOLERANCE - height, height - FLOOR_BAND)


def _located_distance(situation: Situation, arguments: Arguments) -> float:
    """Return by how many metres a body misses the room in and up to `HOVER` above the container."""
    height = _height(situation, *arguments)
    highest = cavity(situation.shape(arguments[1]))[2] + HOVER
    return excess(_lateral(situation, *arguments), -TOLERANCE - height, height - highest)


def _room(situation: Situation, container: str, half: Vector, height: float) -> Volume:
    """Return the bounding box of where the centre of a body may be, up to a height above the floor."""
    x, y, _ = situation.pose(container).position
    inner = cavity(situation.shape(container))
    smallest = min(half[0], half[1])
    dx, dy = inner[0] / 2 - smallest - MARGIN, inner[1] / 2 - smallest - MARGIN
    yaw = yaw_of(situation.pose(container).quaternion)
    cosine, sine = abs(math.cos(yaw)), abs(math.sin(yaw))
    reach_x, reach_y = cosine * dx + sine * dy, sine * dx + cosine * dy
    z = floor_height(situation, container) + half[2]
    if min(dx, dy) < 0.0:
        return Volume((x, y, z), (x, y, z - 1.0))
    return Volume((x - reach_x, y - reach_y, z), (x + reach_x, y + reach_y, z + height))


def _inside_volume(situation: Situation, arguments: Arguments, half: Vector) -> Volume:
    """Return the floor of the container, at the height of a body that stands on it."""
    return _room(situation, arguments[1], half, 0.0)


def _located_volume(situation: Situation, arguments: Arguments, half: Vector) -> Volume:
    """Return the room in the container and above it."""
    depth = cavity(situation.shape(arguments[1]))[2]
    return _room(situation, arguments[1], half, depth + HOVER - MARGIN)


INSIDE = Predicate(
    name="inside", distance=_inside_distance, volume=_inside_volume, sentence=states("{0} {is} inside {1}")
)
LOCATED = Predicate(
    name="located",
    distance=_located_distance,
    volume=_located_volume,
    sentence=states("{0} {is} in or above {1}"),
)
