"""Sample poses of objects from the volumes that the facts of a state allow."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Sequence
from functools import partial
from itertools import repeat
from typing import NamedTuple

import numpy as np

from prag_asp.physics.extent import BodyExtent, extent, side_yaw
from prag_asp.physics.predicates import Gripper, Ring, Volume
from prag_asp.physics.predicates.inside import INSIDE
from prag_asp.physics.predicates.on_top import ON_TOP
from prag_asp.physics.predicates.reachable import REACHABLE
from prag_asp.physics.predicates.volume import Floor
from prag_asp.physics.search.allowed_region import (
    allowed_volume,
    relevant_facts,
    sample_yaws,
    shapes_volume,
    yaw_ranges,
)
from prag_asp.physics.search.attempt import EMPTY_VOLUME, OBJECTS_COLLIDE, RELATION, Failure, Search
from prag_asp.physics.search.spacing_chains import SpacingChain, spacing_chains, spacing_volume
from prag_asp.physics.search.spans import FINGER_ROOM
from prag_asp.physics.situation import Situation
from prag_asp.physics.symbolic_facts import Fact
from prag_asp.physics.world.collisions import box
from prag_asp.physics.world.simulator import COLLISION
from prag_asp.physics.world.support import TABLE
from prag_asp.scene.boxes import Vector, box_of
from prag_asp.scene.furniture import swept
from prag_asp.scene.geometry import Pose, Quaternion, yaw_of, yaw_quaternion
from prag_asp.scene.scene import Shape
from prag_asp.scene.surfaces import part_boxes, part_outlines

TRIES = 8  # samples for each spacing
SPACING = 0.01  # metres between objects on the table, so that they do not touch
TABLE_ROOM = 0.1  # metres to the border of the volume on the table, for hands and later objects
NEAR = 0.15  # metres within which people call an object beside another
JITTER = 0.05  # radians by which an object is rotated relative to its support, because nothing stands exactly straight
EDGE = 0.02  # metres to the edge of the table


class Neighbour(NamedTuple):
    """A body that a placed object can meet, and the object's origin when the boxes of both have the same centre.

    `dx` and `dy` are the distances from that origin along x and y at which the boxes touch, seen from above. If the
    body or the object has a model, boxes are not enough: `parts` returns whether their parts are closer than a spacing
    when the object is at a place. All lengths are in metres.
    """

    x: float
    y: float
    dx: float
    dy: float
    parts: Callable[[Vector, float], bool] | None = None


class PlacementRequest(NamedTuple):
    """An object to be placed on a support, or `height` metres above it, so that facts hold in a state of a task."""

    entity: str
    support: str
    facts: Sequence[Fact]
    state: int
    height: float = 0.0

    def isolated(self, situation: Situation) -> tuple[PlacementRequest, Situation]:
        """Return the request with the facts relevant to its object, and a situation without that object."""
        entity = self.entity
        others = situation.with_poses({other: pose for other, pose in situation.poses.items() if other != entity})
        return self._replace(facts=relevant_facts(self.facts, entity, others)), others


def known_support(situation: Situation, entity: str, facts: Iterable[Fact]) -> str | None:
    """Return the support on or in which an object stands according to the facts (`TABLE` for the table), or None."""
    for fact in facts:
        if fact.value and fact.predicate.places and fact.arguments[0] == entity:
            support = fact.arguments[-1]
            return TABLE if situation.is_surface(support) else support
    return None


def choose_support(search: Search, situation: Situation, entity: str, facts: Iterable[Fact]) -> str:
    """Return the support for an object to stand on or in: the support that the facts name, or a random allowed one.

    If the facts name no support, it is the table, unless the object is known not to be on the table. If a user-defined
    relation lets the object stand on or in another object, that object is an equally likely choice.

    Raises:
        Failure: every support is ruled out.
    """
    facts = list(facts)
    support = known_support(situation, entity, facts)
    if support is not None:
        return support
    own = [(fact, fact.arguments[-1]) for fact in facts if fact.arguments[0] == entity]
    ruled_out = {other for fact, other in own if fact.predicate.supports and not fact.value}
    bearing = {other for fact, other in own if fact.predicate.rests_on_other and fact.value}
    possible = [
        other
        for other in situation.poses
        if other != entity and other not in ruled_out and situation.shape(other).traits.flat
    ]
    if not any(map(situation.is_table, ruled_out)):
        possible = [TABLE, *(other for other in possible if other in bearing)]
    if not possible:
        raise Failure(EMPTY_VOLUME, entity)
    return TABLE if possible == [TABLE] else possible[int(search.rng.integers(len(possible)))]


def sample_pose(search: Search, situation: Situation, request: PlacementRequest) -> Pose:
    """Return a random pose for a request.

    Raises:
        Failure: the volume is empty, or no sample from it is collision-free and satisfies the facts.
    """
    every_fact = request.facts
    request, situation = request.isolated(situation)
    entity, support, about, _, height = request
    # These also go through objects that are not placed yet.
    between = spacing_chains(situation, entity, every_fact)
    quaternion, volume, everything = _place(search, situation, request, between)
    box_within = extent(situation.shape(entity), quaternion)
    preferred = _close(situation, entity, volume, about)
    room = TABLE_ROOM if support == TABLE else FINGER_ROOM
    favourite = preferred.floor(room) or preferred.floor() or everything
    checked = [fact for fact in about if not shapes_volume(fact, entity)]
    others = kept_apart(situation, about)
    turned = (situation.shape(entity), quaternion, box_within)
    below = _neighbours(situation, others, support, turned, volume.low[2] - height)
    beside = _neighbours(situation, others, support, turned, volume.low[2]) if height > 0.0 else below
    failed = Failure(RELATION, entity)
    # A held object should be free to come down; if that is impossible, it may be held above another object.
    for floor, spacing, neighbours in (
        *repeat((favourite, FINGER_ROOM, below), TRIES),
        *repeat((favourite, FINGER_ROOM / 2, below), TRIES),
        *repeat((everything, SPACING if support == TABLE else 0.0, beside), TRIES),
    ):
        at = volume.sample(floor, search.uniform)
        if at is None:
            continue
        if any(
            abs(at[0] - x) < dx + spacing and abs(at[1] - y) < dy + spacing and (parts is None or parts(at, spacing))
            for x, y, dx, dy, parts in neighbours
        ):
            failed = Failure(OBJECTS_COLLIDE, entity)
            continue
        pose = Pose(at, quaternion)
        trial = situation.with_pose(entity, pose)
        broken = next((fact for fact in checked if not fact.is_satisfied(trial)), None)
        if broken is None:
            return pose
        failed = Failure(RELATION, fact=broken, missed=broken.distance(trial))
    raise failed


def kept_apart(situation: Situation, about: Iterable[Fact]) -> list[str]:
    """Return the bodies from which an object is kept apart: all except those that the facts require to be close."""
    touched = {
        name for fact in about if fact.value and fact.predicate.apart[1] < SPACING for name in fact.arguments[:2]
    }
    return [other for other in situation.poses if other not in touched]


def _place(
    search: Search, situation: Situation, request: PlacementRequest, between: Sequence[list[SpacingChain]]
) -> tuple[Quaternion, Volume, Floor]:
    """Return the orientation of an object, its volume in that orientation, and the floor of the volume.

    The yaw is random. If it leaves no room for the object or for later objects, the object is aligned with the axes
    instead, which takes the least room. `between` contains the chains for objects between this object and others, those
    with ample room first.

    Raises:
        Failure: the volume is empty.
    """
    first: tuple[Quaternion, Volume, Floor] | None = None
    ahead = _ahead(search, situation, request)
    for yaw in _yaws(search, situation, request):
        quaternion = yaw_quaternion(yaw)
        whole = placement_volume(situation, request, quaternion)
        # Room for objects in between is ample if possible, or otherwise just enough.
        parts = (
            whole.meet(spacing_volume(situation, request.entity, quaternion, chained)) if chained else whole
            for chained in between or ([],)
        )
        volume, floor = next(((part, floor) for part in parts if (floor := part.floor()) is not None), (whole, None))
        if floor is None:
            continue
        (x, y, _), (dx, dy, _) = extent(situation.shape(request.entity), quaternion)
        for room in ahead:
            (ax, ay, az), (bx, by, bz) = room.low, room.high
            inner = room._replace(low=(ax + dx - x, ay + dy - y, az), high=(bx - dx - x, by - dy - y, bz))
            preferred_volume = volume.meet(inner)
            preferred_floor = preferred_volume.floor()
            if preferred_floor and (
                preferred_volume.rings == volume.rings or Volume.sample(preferred_floor, search.uniform)
            ):
                return quaternion, preferred_volume, preferred_floor
        first = first or (quaternion, volume, floor)
        if not ahead:
            break
    if first is None:
        raise Failure(EMPTY_VOLUME, request.entity)
    return first


def _ahead(search: Search, situation: Situation, request: PlacementRequest) -> tuple[Volume, ...]:
    """Return the volumes in which an object leaves ample room, and then just enough room, for later objects."""
    key = (request.state, request.entity)
    rooms = search.foresight.get(key, ()) if request.support == TABLE else ()
    spans = [span for span in search.spans.get(key, ()) if span.other in situation.poses]
    if not spans:
        return rooms
    volumes = []
    for room, wide in zip(rooms or (Volume(), Volume()), (True, False), strict=True):
        rings = []
        for span in spans:
            x, y, _ = situation.pose(span.other).position
            rings.append(Ring(x, y, span.ample if wide else span.enough, math.inf))
        volumes.append(room._replace(rings=tuple(rings)))
    return tuple(volumes)


def placement_volume(
    situation: Situation, request: PlacementRequest, quaternion: Quaternion, tight: bool = False
) -> Volume:
    """Return the volume for an oriented object on or above a support, as the facts require.

    An object on the table has to be in the workspace and within reach. It may be anywhere on the table if it is known
    to be out of reach, and anywhere in the workspace if several robots share the table. A `tight` volume touches the
    walls of a container.
    """
    entity, support, about, _, height = request
    out_of_reach = any(fact.predicate.gripper is Gripper.REACHES and not fact.value for fact in about)
    if support != TABLE:
        # a body from a file that has a cavity can also bear others on its rim
        on_it = any(fact.value and fact.predicate is ON_TOP and fact.arguments == (entity, support) for fact in about)
        shape = situation.shape(support)
        rests = INSIDE if shape.traits.hollow or (shape.hollow and not on_it) else ON_TOP
        allowed = rests.tight_volume if tight and rests.tight_volume is not None else rests.volume
        volume = allowed(situation, (entity, support), quaternion)
    else:
        (middle_x, middle_y, middle_z), (half_x, half_y, half_z) = extent(situation.shape(entity), quaternion)
        z = half_z - middle_z
        low_x, high_x, low_y, high_y = situation.scene.workspace
        if out_of_reach:
            (x, y), (size_x, size_y) = situation.scene.table.centre, situation.scene.table.size
            x, y = x - middle_x, y - middle_y
            low_x, high_x = x - size_x / 2 + half_x + EDGE, x + size_x / 2 - half_x - EDGE
            low_y, high_y = y - size_y / 2 + half_y + EDGE, y + size_y / 2 - half_y - EDGE
        volume = Volume((low_x, low_y, z), (high_x, high_y, z))
    if height > 0.0:
        (ax, ay, az), (bx, by, bz) = volume.low, volume.high
        volume = volume._replace(low=(ax, ay, az + height), high=(bx, by, bz + height))
    if support == TABLE and not out_of_reach and not situation.scene.shared:
        robot = next(iter(situation.scene.robots))
        volume = volume.meet(REACHABLE.volume(situation, (robot, entity), quaternion))
    for fact in about:
        stands = fact.arguments == (entity, support) and fact.predicate.supports
        if not stands and shapes_volume(fact, entity):
            volume = volume.meet(allowed_volume(situation, fact, entity, quaternion))
    return volume


def _close(situation: Situation, entity: str, volume: Volume, about: Iterable[Fact]) -> Volume:
    """Return the part of a volume that is close enough to the objects beside it for people to recognise it."""
    for fact in about:
        if fact.value and fact.predicate.seen_close:
            other = fact.arguments[1] if fact.arguments[0] == entity else fact.arguments[0]
            x, y, _ = situation.body(other).centre
            half_x, half_y, _ = situation.half(other)
            dx, dy = half_x + NEAR, half_y + NEAR
            volume = volume.meet(Volume((x - dx, y - dy, -math.inf), (x + dx, y + dy, math.inf)))
    return volume


def _neighbours(
    situation: Situation, others: Iterable[str], support: str, turned: tuple[Shape, Quaternion, BodyExtent], z: float
) -> list[Neighbour]:
    """Return the other bodies that an object at a height can meet, except containers into which it is placed.

    `turned` holds the shape of the object, its orientation, and its bounding box at the origin. For furniture, there
    are two bounding boxes: that of its body, and that of the space swept by its moving part.
    """
    neighbours = []
    own, quaternion, (middle, half) = turned
    for other in others:
        shape, boxes = situation.scene.shapes[other], [box(situation, other)]
        if support != TABLE and (shape.traits.hollow or (other == support and shape.hollow)):
            continue
        if shape.traits.furniture:
            boxes = [box_of(corners) for corners in swept(shape, situation.pose(other))]
        elif shape.model is not None or own.model is not None:
            parts = partial(parts_meet, own, quaternion, shape, situation.pose(other), z)
            ((x, y, other_z), (half_x, half_y, half_z)) = boxes[0]
            if abs(z + middle[2] - other_z) < half[2] + half_z + COLLISION:
                at = (x - middle[0], y - middle[1])
                neighbours.append(Neighbour(*at, half_x + half[0], half_y + half[1], parts))
            continue
        for (x, y, other_z), (half_x, half_y, half_z) in boxes:
            if abs(z + middle[2] - other_z) < half[2] + half_z + COLLISION:
                at = (x - middle[0], y - middle[1])
                neighbours.append(Neighbour(*at, half_x + half[0], half_y + half[1]))
    return neighbours


def parts_meet(
    own: Shape, quaternion: Quaternion, other: Shape, pose: Pose, z: float, at: Vector, spacing: float
) -> bool:
    """Return whether parts of an object at a place may be nearer than a spacing to parts of another object.

    The convex outlines of the parts, seen from above, are compared.
    """
    ours, theirs = part_boxes(own, quaternion), part_boxes(other, pose.quaternion)
    offset = np.array((at[0], at[1], z)) - pose.position
    apart = np.abs(offset + ours[:, None, 0] - theirs[None, :, 0]) - ours[:, None, 1] - theirs[None, :, 1]
    close = np.nonzero((apart < (spacing, spacing, COLLISION)).all(axis=2))
    if not len(close[0]):
        return False
    one, two = part_outlines(own, quaternion), part_outlines(other, pose.quaternion)
    return any(one[i].meets(two[j], offset[:2], spacing) for i, j in zip(*close, strict=True))


def _yaws(search: Search, situation: Situation, request: PlacementRequest) -> Iterator[float]:
    """Yield yaws in radians: in required ranges or else random, then axis-aligned or aligned with the support.

    For a box or a body with a model, the sides are aligned or, if the body then does not fit into a container, the
    diagonals.
    """
    shape = situation.shape(request.entity)
    own = side_yaw(shape)
    ranges = yaw_ranges(situation, request.entity, request.facts)
    if ranges is not None:
        yield from sample_yaws(search, ranges)
        return
    if request.support == TABLE:
        yield search.uniform(-math.pi, math.pi)
        along = int(search.rng.integers(2)) * math.pi / 2
        yield from (along - own, math.pi / 2 - along - own)
        return
    quarter = int(search.rng.integers(4)) * math.pi / 2 - own
    aligned = support_yaw(situation, request.support) + quarter
    yield aligned + search.uniform(-JITTER, JITTER)
    if (shape.model is not None or shape.kind == "box") and situation.shape(request.support).hollow:
        yield from (aligned + turn * math.pi / 4 for turn in (0, 2, 1, 3))


def support_yaw(situation: Situation, support: str) -> float:
    """Return the yaw, in radians, of the sides of a body or, if it has a model with a cavity, of the cavity."""
    model = situation.shape(support).model
    pose = situation.pose(support) if model is None or model.cavity is None else situation.floor(support)
    return yaw_of(pose.quaternion)
