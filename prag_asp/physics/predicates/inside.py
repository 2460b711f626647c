"""``inside`` and ``located``: a body is in the cavity of a container or, for ``located``, right above it.

The whole body has to be between the walls. A body with a model is measured by its solids, along the axes of the cavity.

Furniture is also a container: the cavity of a drawer is the cavity of its tray, and moves with the tray. ``located`` at
the table means on the table or right above it, but not over a hollow body.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from functools import partial

from prag_asp.physics.extent import BodyExtent, extent, least_reach, silhouette
from prag_asp.physics.predicates.gaps import Demand, Z, above, along, between, bottom
from prag_asp.physics.predicates.predicate import Arguments, Predicate, states, words
from prag_asp.physics.predicates.volume import Volume, opposite, over_rectangle
from prag_asp.physics.situation import Situation
from prag_asp.scene.boxes import Vector
from prag_asp.scene.forms import Outline, rectangle
from prag_asp.scene.furniture import cavity
from prag_asp.scene.geometry import (
    Pose,
    Quaternion,
    heading,
    hull,
    inside_by,
    multiply,
    rotate,
    to_local,
    yaw_of,
)
from prag_asp.scene.scene import Scene
from prag_asp.scene.surfaces import least_extent

TOLERANCE = 0.002
FLOOR_BAND = 0.01
HOVER = 0.2
MARGIN = 0.003
ROUNDING = 1e-6
"""The distance from the walls, in metres, at which a body counts as inside despite rounding errors."""


def hollow(situation: Situation, container: str) -> tuple[Pose, Vector]:
    """Return a pose at the centre of a cavity, seen from above, and its inner dimensions and depth in metres."""
    shape = situation.shape(container)
    elsewhere = shape.traits.furniture or shape.model is not None
    middle = situation.floor(container) if elsewhere else situation.pose(container)
    return middle, cavity(shape)


def floor_height(situation: Situation, container: str) -> float:
    """Return the height of a container's floor in metres."""
    shape = situation.shape(container)
    if shape.traits.furniture or shape.model is not None:
        return situation.floor(container).position[2]
    return situation.bottom(container) + shape.wall


def rims(situation: Situation, container: str, margin: float = 0.0) -> Iterator[Outline]:
    """Yield the convex outlines of a container, seen from above, enlarged by a margin in metres on each side."""
    shape, pose = situation.shape(container), situation.pose(container)
    if shape.model is not None:
        covered = silhouette(shape, pose)
        yield hull([(x + dx, y + dy) for x, y in covered for dx in (-margin, margin) for dy in (-margin, margin)])
        return
    half_x, half_y, _ = shape.half
    yield rectangle(*pose.position[:2], half_x + margin, half_y + margin, yaw_of(pose.quaternion))
    if shape.traits.furniture:
        middle, (size_x, size_y, _) = hollow(situation, container)
        half_x, half_y = size_x / 2 + shape.wall + margin, size_y / 2 + shape.wall + margin
        yield rectangle(*middle.position[:2], half_x, half_y, yaw_of(middle.quaternion))


def _extent_within(situation: Situation, subject: str, cavity_pose: Pose, quaternion: Quaternion) -> BodyExtent:
    """Return the bounding box of a rotated body along the axes of a cavity."""
    x, y, z, w = cavity_pose.quaternion
    return extent(situation.shape(subject), multiply((-x, -y, -z, w), quaternion))


def _lateral(situation: Situation, subject: str, container: str) -> Iterator[float]:
    """Yield the amounts in metres by which a body's box, along a cavity's axes, extends beyond the cavity."""
    pose, (outer, inner) = situation.pose(subject), hollow(situation, container)
    dx, dy = to_local(outer, pose.position[0], pose.position[1])
    middle, half = _extent_within(situation, subject, outer, pose.quaternion)
    dx, dy = dx + middle[0], dy + middle[1]
    yield abs(dx) - inner[0] / 2
    yield abs(dy) - inner[1] / 2
    yield abs(dx) + half[0] - inner[0] / 2
    yield abs(dy) + half[1] - inner[1] / 2


def _height(situation: Situation, subject: str, container: str) -> float:
    """Return the height of a body's lowest point above the container's floor in metres."""
    return situation.bottom(subject) - floor_height(situation, container)


def _inside_violations(situation: Situation, arguments: Arguments) -> Iterator[float]:
    """Yield the distance in metres of a body from the container's floor; a body on another one is not inside."""
    height = _height(situation, *arguments)
    yield -TOLERANCE - height
    yield height - FLOOR_BAND
    yield from _lateral(situation, *arguments)


def _located_violations(situation: Situation, arguments: Arguments) -> Iterator[float]:
    """Yield the distances in metres of a body from the space in the container or on the table, up to `HOVER` above it.

    The space over the table does not include the space over hollow bodies.
    """
    subject, place = arguments
    if situation.is_table(place):
        height = situation.bottom(subject)
        yield -TOLERANCE - height
        yield height - HOVER
        (x, y, _), (at_x, at_y, _) = situation.pose(subject).position, situation.pose(place).position
        half_x, half_y, _ = situation.half(place)
        yield abs(x - at_x) - half_x
        yield abs(y - at_y) - half_y
        for other in _hollow_others(situation, subject):
            yield from (inside_by(rim, (x, y)) for rim in rims(situation, other))
        return
    height = _height(situation, subject, place)
    yield -TOLERANCE - height
    yield height - hollow(situation, place)[1][2] - HOVER
    yield from _lateral(situation, subject, place)


def _hollow_others(situation: Situation, subject: str) -> list[str]:
    """Return the hollow bodies other than the subject."""
    return [other for other in situation.poses if other != subject and situation.shape(other).hollow]


def _room(
    situation: Situation, arguments: Arguments, quaternion: Quaternion, height: float, margin: float = MARGIN
) -> Volume:
    """Return the region for the centre of a body in a cavity, at most `height` metres above the floor."""
    subject, container = arguments
    pose, inner = hollow(situation, container)
    middle, half = _extent_within(situation, subject, pose, quaternion)
    dx, dy = (_spare(inner[axis] / 2 - half[axis], margin) for axis in (0, 1))
    z = floor_height(situation, container) + half[2]
    if min(dx, dy) < 0.0:
        x, y, _ = pose.position
        return Volume((x, y, z), (x, y, z - 1.0))
    room = over_rectangle(pose.position, heading(pose.quaternion), (dx, dy), (z, z + height))
    return room.moved(opposite(rotate(pose.quaternion, middle)))


def _spare(room: float, margin: float) -> float:
    """Return the distance in metres by which a body may be off-centre, given the room between it and either wall."""
    return room - margin if room >= margin else room / 2


def _located_volume(situation: Situation, arguments: Arguments, quaternion: Quaternion) -> Volume:
    """Return the space in and above the container, or on and above the table but not above hollow bodies."""
    subject, place = arguments
    if not situation.is_table(place):
        return _room(situation, arguments, quaternion, hollow(situation, place)[1][2] + HOVER - MARGIN)
    (x, y, _), (half_x, half_y, _) = situation.pose(place).position, situation.half(place)
    (_, _, middle), (_, _, tall) = extent(situation.shape(subject), quaternion)
    z = tall - middle
    others = _hollow_others(situation, subject)
    return Volume(
        (x - half_x + MARGIN, y - half_y + MARGIN, z),
        (x + half_x - MARGIN, y + half_y - MARGIN, z + HOVER - MARGIN),
        holes=tuple(rim for other in others for rim in rims(situation, other, MARGIN)),
    )


def _impossible(scene: Scene, arguments: Arguments) -> Iterator[str]:
    """Yield a reason if there is no cavity, or if it is too small for the body in every orientation."""
    entity, container = arguments
    shape, (inner_x, inner_y, _) = scene.shapes[entity], cavity(scene.shapes[container])
    # The width of a projection is at least the smallest dimension of the body, and its area is at least that of the
    # smallest projection of the body, which is convex. The dimensions of a model's box are not bounds, because the
    # model may be oblique in its file.
    small, middle, _ = sorted(shape.size)
    area = small * middle * (math.pi / 4 if shape.traits.round else 1.0)
    if not scene.shapes[container].hollow:
        yield f"{words(container)} is not a container, so {words(entity)} cannot be in it"
    elif _exceeds(small, area, inner_x, inner_y) and (
        shape.model is None or _exceeds(*least_extent(shape), inner_x, inner_y)
    ):
        yield f"{words(entity)} is larger than the cavity of {words(container)}"


def _exceeds(width: float, area: float, inner_x: float, inner_y: float) -> bool:
    """Return whether a body is too large for the sides of a cavity, given its smallest width and projection."""
    return width > min(inner_x, inner_y) or area > inner_x * inner_y


def _located_demands(scene: Scene, arguments: Arguments) -> Iterator[Demand]:
    """Yield constraints that a body is in another body or above it; for the table, there are none."""
    if scene.shapes[arguments[1]].kind != "table":
        yield from _cavity_demands(scene, arguments, cavity(scene.shapes[arguments[1]])[2] + HOVER)


def _cavity_demands(scene: Scene, arguments: Arguments, room: float) -> Iterator[Demand]:
    """Yield constraints that a body is in the cavity of another, at most `room` metres above its floor.

    There are no constraints for a container loaded from a file, because its cavity may be anywhere in it.
    """
    entity, container = arguments
    if scene.shapes[container].model is not None:
        return
    inner, own = cavity(scene.shapes[container]), least_reach(scene.shapes[entity])
    half = (max(0.0, inner[0] / 2 - own), max(0.0, inner[1] / 2 - own))
    yield from above(scene, entity, container, half)
    wall = scene.shapes[container].wall
    yield from along(Z, between(bottom(entity), bottom(container), wall - TOLERANCE, wall + room))


INSIDE = Predicate(
    name="inside",
    violations=_inside_violations,
    volume=partial(_room, height=0.0),
    tight_volume=partial(_room, height=0.0, margin=ROUNDING),
    sentence=states("{0} {is} inside {1}"),
    supports=True,
    places=True,
    impossible=_impossible,
    demands=partial(_cavity_demands, room=FLOOR_BAND),
    caption_rank=40,
)
LOCATED = Predicate(
    name="located",
    violations=_located_violations,
    volume=_located_volume,
    sentence=states("{0} {is} at {1}"),
    places=True,
    # The table has room for every body.
    impossible=lambda scene, at: iter(()) if scene.shapes[at[1]].kind == "table" else _impossible(scene, at),
    demands=_located_demands,
    caption_rank=50,
)

PREDICATES = {"inside": INSIDE, "located": LOCATED}
