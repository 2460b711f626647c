"""Draw poses of objects from the volumes that the facts of a state allow."""

from __future__ import annotations

import math
from collections.abc import Iterable

from prag_asp.physics.collisions import box, boxes_meet
from prag_asp.physics.facts import Fact
from prag_asp.physics.geometry import Pose, Vector, extents, yaw_of, yaw_quaternion
from prag_asp.physics.predicates import PREDICATES, Volume
from prag_asp.physics.search import EMPTY_VOLUME, OBJECTS_COLLIDE, RELATION, Failure, Search
from prag_asp.physics.situation import Situation
from prag_asp.physics.support import TABLE

TRIES = 30
SPACING = 0.01
FINGER_ROOM = 0.025
TABLE_ROOM = 0.1
NEAR = 0.15
JITTER = 0.05
EDGE = 0.02


def known_support(situation: Situation, entity: str, facts: Iterable[Fact]) -> str | None:
    """Return what an object stands on or in by the facts, `TABLE` for the table, None where unknown."""
    for fact in facts:
        if (
            fact.value
            and fact.predicate.name in ("on_top", "inside", "located")
            and fact.arguments[0] == entity
        ):
            support = fact.arguments[1]
            return TABLE if situation.is_table(support) else support
    return None


def any_support(search: Search, situation: Situation, entity: str, facts: Iterable[Fact]) -> str:
    """Return a support for an object that may be anywhere: the table, unless it is known not to be on it.

    Raises:
        Failure: every support is ruled out.
    """
    ruled_out = {
        fact.arguments[1]
        for fact in facts
        if not fact.value and fact.predicate.name in ("on_top", "inside") and fact.arguments[0] == entity
    }
    if not any(situation.is_table(support) for support in ruled_out):
        return TABLE
    options = [
        other
        for other in situation.poses
        if other not in ruled_out and situation.shape(other).kind != "sphere"
    ]
    if not options:
        raise Failure(EMPTY_VOLUME)
    return options[int(search.rng.integers(len(options)))]


def relevant(facts: Iterable[Fact], entity: str, situation: Situation) -> list[Fact]:
    """Return the facts about an object whose other bodies have their places; the gripper's are left out."""
    return [
        fact
        for fact in facts
        if entity in fact.arguments
        and not fact.predicate.of_gripper
        and all(_has_place(situation, other) for other in fact.arguments if other != entity)
    ]


def draw_pose(
    search: Search,
    situation: Situation,
    entity: str,
    support: str,
    facts: Iterable[Fact],
    *,
    height: float = 0.0,
) -> Pose:
    """Draw a pose of an object at rest on a support, or `height` metres above, that the facts about it allow.

    Raises:
        Failure: the volume is empty, or nothing drawn from it satisfies the facts or is free.
    """
    about = sorted(relevant(facts, entity, situation), key=lambda fact: not fact.value)
    wanted = [fact for fact in about if fact.value]
    yaw = _draw_yaw(search, situation, support, _volume(situation, entity, wanted, (0.0, 0.0, 0.0)))
    quaternion = yaw_quaternion(yaw)
    half = extents(situation.shape(entity), quaternion)
    volume = _volume(situation, entity, wanted, half).meet(_surface(situation, entity, support, half, about))
    if volume.empty:
        raise Failure(EMPTY_VOLUME)
    close = volume.meet(_close(situation, entity, wanted))
    preferred = volume if close.empty else close
    anywhere = support != TABLE or any(
        fact.predicate.name == "reachable" and not fact.value for fact in about
    )
    neighbours = [
        box(situation, other)
        for other in situation.poses
        if support == TABLE or situation.shape(other).kind != "container"
    ]
    cause = RELATION
    for attempt in range(TRIES):
        first = attempt < TRIES // 2
        room = TABLE_ROOM if support == TABLE else FINGER_ROOM
        x, y, z = _draw_point(search, preferred, room) if first else _draw_point(search, volume, 0.0)
        pose = Pose((x, y, z), quaternion)
        spacing = _spacing(support, first)
        if any(boxes_meet((pose.position, half), other, spacing) for other in neighbours):
            cause = OBJECTS_COLLIDE
            continue
        trial = situation.with_pose(entity, pose)
        if not all(fact.satisfied(trial) for fact in about):
            cause = RELATION
        elif anywhere or PREDICATES["reachable"].holds(trial, ("", entity)):
            return Pose((x, y, z + height), quaternion)
    raise Failure(cause)


def surface_height(situation: Situation, support: str) -> float:
    """Return the height of a support's surface in metres: a container's floor, the top of anything else."""
    if support == TABLE:
        return 0.0
    shape = situation.shape(support)
    return situation.bottom(support) + shape.wall if shape.kind == "container" else situation.top(support)


def _volume(
    situation: Situation, entity: str, wanted: Iterable[Fact], half: tuple[float, float, float]
) -> Volume:
    """Return what the facts that hold allow the centre of an object with the half sides `half`."""
    volume = Volume()
    for fact in wanted:
        predicate, arguments = fact.predicate, fact.arguments
        if arguments[predicate.subject] == entity:
            volume = volume.meet(predicate.volume(situation, arguments, half))
        elif predicate.inverse is not None:
            volume = volume.meet(PREDICATES[predicate.inverse].volume(situation, arguments[::-1], half))
    return volume


def _close(situation: Situation, entity: str, wanted: Iterable[Fact]) -> Volume:
    """Return the surroundings of what an object is beside: there the relation is seen at a glance."""
    volume = Volume()
    for fact in wanted:
        if fact.predicate.inverse is not None:
            other = fact.arguments[1] if fact.arguments[0] == entity else fact.arguments[0]
            x, y, _ = situation.pose(other).position
            half_x, half_y, _ = situation.half(other)
            dx, dy = half_x + NEAR, half_y + NEAR
            volume = volume.meet(Volume((x - dx, y - dy, -math.inf), (x + dx, y + dy, math.inf)))
    return volume


def _surface(
    situation: Situation, entity: str, support: str, half: tuple[float, float, float], about: Iterable[Fact]
) -> Volume:
    """Return where an object can be put down: all of a top or floor, or the workspace of the table."""
    z = surface_height(situation, support) + half[2]
    if support != TABLE:
        name = "inside" if situation.shape(support).kind == "container" else "on_top"
        return PREDICATES[name].volume(situation, (entity, support), half)
    low_x, high_x, low_y, high_y = situation.scene.workspace
    if any(fact.predicate.name == "reachable" and not fact.value for fact in about):
        (x, y), (size_x, size_y) = situation.scene.table.centre, situation.scene.table.size
        low_x, high_x = x - size_x / 2 + half[0] + EDGE, x + size_x / 2 - half[0] - EDGE
        low_y, high_y = y - size_y / 2 + half[1] + EDGE, y + size_y / 2 - half[1] - EDGE
    return Volume((low_x, low_y, z), (high_x, high_y, z))


def _spacing(support: str, first: bool) -> float:
    """Return how far an object should be from others in metres: first wide, on the table never close."""
    if first:
        return FINGER_ROOM
    return SPACING if support == TABLE else 0.0


def _draw_point(search: Search, volume: Volume, room: float) -> Vector:
    """Draw a point at the bottom of a volume, `room` metres off its borders as far as there is some."""
    x, y = (
        search.uniform(low + min(room, (high - low) / 3), high - min(room, (high - low) / 3))
        for low, high in zip(volume.low[:2], volume.high[:2], strict=True)
    )
    return (x, y, volume.low[2])


def _draw_yaw(search: Search, situation: Situation, support: str, volume: Volume) -> float:
    """Draw a yaw in radians: within the volume's range, else square to the support, else any."""
    if volume.yaw is not None:
        centre, half = volume.yaw
        if half < 0.0:
            raise Failure(EMPTY_VOLUME)
        return centre + search.uniform(-half, half)
    if support == TABLE:
        return search.uniform(-math.pi, math.pi)
    quarter = int(search.rng.integers(4)) * math.pi / 2
    return yaw_of(situation.pose(support).quaternion) + quarter + search.uniform(-JITTER, JITTER)


def _has_place(situation: Situation, entity: str) -> bool:
    """Tell whether an argument of a fact needs no place of its own or has it."""
    shape = situation.scene.shapes.get(entity)
    return shape is None or shape.kind in ("robot", "table") or entity in situation.poses
