"""``inside`` and ``located``: a body in the cavity of a container, or (``located``) held right above."""

from __future__ import annotations

from collections.abc import Iterator

from prag_asp.physics.geometry import Quaternion, Vector, cavity, extents, heading, multiply, to_local
from prag_asp.physics.predicates.predicate import Arguments, Predicate, states
from prag_asp.physics.predicates.volume import Volume, turned_box
from prag_asp.physics.situation import Situation

TOLERANCE = 0.002
FLOOR_BAND = 0.01
HOVER = 0.2
MARGIN = 0.003


def floor_height(situation: Situation, container: str) -> float:
    """Return the height of a container's floor in metres."""
    return situation.bottom(container) + situation.shape(container).wall


def _half_within(situation: Situation, subject: str, container: str, quaternion: Quaternion) -> Vector:
    """Return half the sides of the bounding box of a turned body in the container's axes, in metres."""
    x, y, z, w = situation.pose(container).quaternion
    return extents(situation.shape(subject), multiply((-x, -y, -z, w), quaternion))


def _lateral(situation: Situation, subject: str, container: str) -> Iterator[float]:
    """Yield how far the bounding box of a body, in the container's axes, sticks out of it in metres."""
    pose, outer = situation.pose(subject), situation.pose(container)
    dx, dy = to_local(outer, pose.position[0], pose.position[1])
    inner = cavity(situation.shape(container))
    yield abs(dx) - inner[0] / 2
    yield abs(dy) - inner[1] / 2
    half = _half_within(situation, subject, container, pose.quaternion)
    yield abs(dx) + half[0] - inner[0] / 2
    yield abs(dy) + half[1] - inner[1] / 2


def _height(situation: Situation, subject: str, container: str) -> float:
    """Return how high the lowest point of a body is above the container's floor in metres."""
    return situation.bottom(subject) - floor_height(situation, container)


def _inside_violations(situation: Situation, arguments: Arguments) -> Iterator[float]:
    """Yield by how many metres a body misses the floor of the container; a stacked body is not inside."""
    height = _height(situation, *arguments)
    yield -TOLERANCE - height
    yield height - FLOOR_BAND
    yield from _lateral(situation, *arguments)


def _located_violations(situation: Situation, arguments: Arguments) -> Iterator[float]:
    """Yield by how many metres a body misses the room in and up to `HOVER` above the container."""
    height = _height(situation, *arguments)
    yield -TOLERANCE - height
    yield height - cavity(situation.shape(arguments[1]))[2] - HOVER
    yield from _lateral(situation, *arguments)


def _room(situation: Situation, arguments: Arguments, quaternion: Quaternion, height: float) -> Volume:
    """Return where the centre of a body may be, up to a height above the floor."""
    subject, container = arguments
    pose, inner = situation.pose(container), cavity(situation.shape(container))
    half = _half_within(situation, subject, container, quaternion)
    dx, dy = inner[0] / 2 - half[0] - MARGIN, inner[1] / 2 - half[1] - MARGIN
    x, y, _ = pose.position
    z = floor_height(situation, container) + half[2]
    if min(dx, dy) < 0.0:
        return Volume((x, y, z), (x, y, z - 1.0))
    cosine, sine = heading(pose.quaternion)
    reach_x, reach_y = abs(cosine) * dx + abs(sine) * dy, abs(sine) * dx + abs(cosine) * dy
    return Volume(
        (x - reach_x, y - reach_y, z),
        (x + reach_x, y + reach_y, z + height),
        sides=turned_box((pose.position, (cosine, sine)), (dx, dy)),
    )


def _inside_volume(situation: Situation, arguments: Arguments, quaternion: Quaternion) -> Volume:
    """Return the floor of the container, at the height of a body that stands on it."""
    return _room(situation, arguments, quaternion, 0.0)


def _located_volume(situation: Situation, arguments: Arguments, quaternion: Quaternion) -> Volume:
    """Return the room in the container and above it."""
    depth = cavity(situation.shape(arguments[1]))[2]
    return _room(situation, arguments, quaternion, depth + HOVER - MARGIN)


INSIDE = Predicate(
    name="inside",
    violations=_inside_violations,
    volume=_inside_volume,
    sentence=states("{0} {is} inside {1}"),
)
LOCATED = Predicate(
    name="located",
    violations=_located_violations,
    volume=_located_volume,
    sentence=states("{0} {is} in or above {1}"),
)
