"""Pack objects tightly, side by side from a corner, if random placement leaves no room for all of them.

Objects are placed in order of size, axis-aligned or aligned with their support, at the first free place as seen from a
random corner. Places to try are vertices of the allowed region, places next to a neighbour with some spacing, and a
lattice. If there is no place for an object, the search backtracks to the object before it. Several spacings are tried;
the largest that succeeds is used.

Objects that a hand puts down one after another stand in rows, with room for fingers between them along one axis and
closer together along the other. The held object is turned so that the fingers open along the first axis.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import suppress
from functools import partial
from itertools import chain, islice
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from prag_asp.physics.extent import ORIGIN, extent, side_yaw
from prag_asp.physics.search.allowed_region import shapes_volume, yaw_ranges
from prag_asp.physics.search.attempt import OBJECTS_COLLIDE, Failure, Search
from prag_asp.physics.search.placement import (
    SPACING,
    PlacementRequest,
    choose_support,
    kept_apart,
    parts_meet,
    placement_volume,
    sample_pose,
    support_yaw,
)
from prag_asp.physics.search.spans import FINGER_ROOM
from prag_asp.physics.situation import Situation
from prag_asp.physics.symbolic_facts import Fact
from prag_asp.physics.world.simulator import COLLISION
from prag_asp.physics.world.support import TABLE
from prag_asp.scene.boxes import Vector, box_of
from prag_asp.scene.furniture import swept
from prag_asp.scene.geometry import (
    Pose,
    Quaternion,
    compose,
    multiply,
    rotate,
    width_along,
    yaw_of,
    yaw_quaternion,
)

SPACINGS = (FINGER_ROOM, FINGER_ROOM / 2, SPACING, 0.005, 0.002, 0.0)
"""The spacings between objects to try, in metres, largest first; with the last, they touch."""

ROWS = SPACINGS[:-1]
"""The spacings between rows of objects that a hand puts down, in metres: rows never touch."""

TIGHT = 0.002
"""The largest spacing, in metres, with which objects also touch the walls of a container."""

BRANCHES = 4
"""The number of places to try for an object before the previous object is moved."""

PLACED = 10
"""The average number of placements per object after which a spacing is abandoned."""

LATTICE = 7
"""The number of lattice lines in each direction, for regions whose corners are out of reach."""

ROUNDING = 1e-9
"""The distance in metres by which a place may violate a bound from which it was calculated."""


def turned(points: NDArray[np.float64], yaw: float) -> NDArray[np.float64]:
    """Return points of shape (n, 2) rotated about the origin by a yaw in radians."""
    cosine, sine = math.cos(yaw), math.sin(yaw)
    rotated: NDArray[np.float64] = points @ np.array(((cosine, sine), (-sine, cosine)))
    return rotated


class Corner(NamedTuple):
    """The corner from which places are filled: its signs on both axes, and whether rows are along x."""

    x: int
    y: int
    along_x: bool

    @classmethod
    def sample(cls, search: Search) -> Corner:
        """Return a random corner."""
        x, y, along = search.rng.integers(2, size=3).tolist()
        return cls(2 * x - 1, 2 * y - 1, bool(along))

    def order(self, points: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return points of shape (n, 2) in order: row by row from the corner."""
        x, y = self.x * points[:, 0], self.y * points[:, 1]
        # in whole micrometres, so that rounding errors do not mix up the rows
        keys = [np.round(each, 6) for each in ((y, x) if self.along_x else (x, y))]
        ordered: NDArray[np.float64] = points[np.lexsort(keys[::-1])]
        return ordered


class OpenHand(NamedTuple):
    """A hand that puts objects down and opens its fingers along one axis of their support: 0 for x, 1 for y.

    `wall` is the room in metres for fingers between an object and the ends of the allowed region. Objects up to `width`
    metres wide fit between the fingers. The hand holds the object `held`, in whose frame the fingers open along the
    yaw `across`, in radians.
    """

    axis: int
    wall: float
    width: float
    held: str
    across: float


class Filling(NamedTuple):
    """A way to fill a region: the first corner, the spacings in metres along both axes of the support, and the hand."""

    corner: Corner
    spacing: tuple[float, float]
    hand: OpenHand | None = None

    @property
    def tight(self) -> bool:
        """Whether objects touch the walls of a container."""
        return self.hand is None and max(self.spacing) <= TIGHT


def pack(
    search: Search, still: Situation, order: Sequence[str], about: Callable[[str, Situation], Iterable[Fact]]
) -> Situation:
    """Return a situation with all objects in `order` placed so that the facts `about` each object hold.

    Raises:
        Failure: there is no room for an object.
    """
    if not order:
        return still
    corner, (*ample, least) = Corner.sample(search), SPACINGS
    tight = fill(search, still, order, about, Filling(corner, (least, least)))
    for spacing in ample:
        with suppress(Failure):
            return fill(search, still, order, about, Filling(corner, (spacing, spacing)))
    return tight


def resting_pose(search: Search, situation: Situation, entity: str, facts: Iterable[Fact], state: int) -> Pose:
    """Return a random pose of an object on a support or, if that fails in a search that `packs`, a tight pose.

    Raises:
        Failure: every support is ruled out, or there is no pose on the chosen one.
    """
    facts = list(facts)
    support = choose_support(search, situation, entity, facts)
    return requested_pose(search, situation, PlacementRequest(entity, support, facts, state))


def requested_pose(search: Search, situation: Situation, request: PlacementRequest) -> Pose:
    """Return a random pose for a request or, if that fails in a search that `packs`, a tight pose.

    Raises:
        Failure: there is no pose.
    """
    try:
        return sample_pose(search, situation, request)
    except Failure:
        if not search.packs:
            raise
        corner = Corner.sample(search)
        for spacing in SPACINGS:
            for pose in packed_poses(situation, request, Filling(corner, (spacing, spacing))):
                return pose
        raise


def packed_poses(situation: Situation, request: PlacementRequest, filling: Filling) -> Iterator[Pose]:
    """Yield free poses for a request, in the order in which a region is filled."""
    corner, spacing, hand = filling
    request, situation = request.isolated(situation)
    entity, support, about, *_ = request
    checked = [fact for fact in about if not shapes_volume(fact, entity)]
    for frame in _frames(situation, entity, support, about):
        for quaternion in _orientations(situation, entity, about, frame, hand):
            volume = placement_volume(situation, request, quaternion, filling.tight)
            floor = volume.floor()
            if floor is None:
                continue
            z = volume.low[2]
            taken, touching, close = _taken(situation, request, quaternion, z, frame)
            corners = turned(np.array([point for patch in floor for point in patch.polygon]), -frame)
            if hand is not None and hand.wall > 0.0:
                low, high = corners[:, hand.axis].min() + hand.wall, corners[:, hand.axis].max() - hand.wall
                if low > high:
                    continue
                corners[:, hand.axis] = np.clip(corners[:, hand.axis], low, high)
            places = _places(corners, taken, touching, spacing)
            ordered = turned(corner.order(places), frame).tolist()
            # Alternate between the corner and the opposite one: the order of the objects may require both.
            for x, y in chain.from_iterable(zip(ordered, reversed(ordered), strict=True)):
                pose = Pose((x, y, z), quaternion)
                if volume.miss_distance(pose.position) > ROUNDING:
                    continue
                if any(meet(pose.position, min(spacing) - ROUNDING) for meet in close):
                    continue
                trial = situation.with_pose(entity, pose)
                if all(fact.is_satisfied(trial) for fact in checked):
                    yield pose


def _frames(situation: Situation, entity: str, support: str, about: Iterable[Fact]) -> Iterator[float]:
    """Yield the yaws, in radians, of the frames in which to pack an object, first that of its support or the workspace.

    If a user-defined relation requires the object to be in a rotated body, such as a slot, the yaw of that body is also
    tried.
    """
    first = 0.0 if support == TABLE else support_yaw(situation, support)
    yield first
    for fact in about:
        if fact.value and fact.predicate.rests_on_other and fact.arguments[0] == entity:
            yaw = yaw_of(situation.pose(fact.arguments[1]).quaternion)
            if abs(math.sin(2 * (yaw - first))) > ROUNDING:
                yield yaw


def fill(
    search: Search,
    still: Situation,
    order: Sequence[str],
    about: Callable[[str, Situation], Iterable[Fact]],
    filling: Filling,
    branches: int = BRANCHES,
) -> Situation:
    """Place all objects as a region is filled, backtracking if necessary, and return the situation.

    `branches` is the number of places to try for an object before the previous object is moved.

    Raises:
        Failure: there is no room for an object, or too many places were tried; the error names the last object that
            was reached.
    """
    situations, options, farthest = [still], list[Iterator[Pose]](), 0
    for _ in range(PLACED * len(order)):
        entity, situation = order[len(options)], situations[-1]
        facts = list(about(entity, situation))
        support = choose_support(search, situation, entity, facts)
        request = PlacementRequest(entity, support, facts, 0)
        options.append(islice(packed_poses(situation, request, filling), branches))
        farthest = max(farthest, len(options) - 1)
        while (pose := next(options[-1], None)) is None:
            options.pop()
            if not options:
                raise Failure(OBJECTS_COLLIDE, order[farthest])
            situations.pop()
        situations.append(situations[-1].with_pose(order[len(options) - 1], pose))
        if len(options) == len(order):
            return situations[-1]
    raise Failure(OBJECTS_COLLIDE, order[farthest])


def _places(
    corners: NDArray[np.float64],
    taken: NDArray[np.float64],
    touching: NDArray[np.float64],
    spacing: tuple[float, float],
) -> NDArray[np.float64]:
    """Return the places in the bounding box of corners, shape (n, 2), that keep spacings from `taken` places.

    They are on lines through the corners, on lines through `touching` places, and on the lines of a lattice.
    """
    lines = []
    for axis in range(2):
        low, high = corners[:, axis].min(), corners[:, axis].max()
        centre, reach = touching[:, axis], touching[:, axis + 2] + spacing[axis]
        lattice = np.linspace(low, high, LATTICE)
        values = np.concatenate([corners[:, axis], centre - reach, centre + reach, lattice])
        lines.append(np.unique(values[(low <= values) & (values <= high)]))
    points = np.stack(np.meshgrid(*lines), axis=-1).reshape(-1, 2)
    reach = taken[:, 2:] + spacing - ROUNDING
    overlaps = np.all(np.abs(points[:, None] - taken[None, :, :2]) < reach, axis=2)
    free: NDArray[np.float64] = points[~np.any(overlaps, axis=1)]
    return free


def _taken(
    situation: Situation, request: PlacementRequest, quaternion: Quaternion, z: float, frame: float
) -> tuple[NDArray[np.float64], NDArray[np.float64], list[Callable[[Vector, float], bool]]]:
    """Return the places where an object at a height overlaps others, the places where it touches them, and exact tests.

    Each row (n, 4) contains the centre of a rectangle for the origin of the object, and its half-extents along x and y,
    seen from above in a frame rotated by a yaw; it refers to the bounding boxes of the bodies in this frame. If the
    object or another body has a model, their boxes are only listed as touching, and a function returns whether their
    parts overlap.
    """
    back, forth = yaw_quaternion(-frame), yaw_quaternion(frame)
    entity = situation.shape(request.entity)
    middle, own = extent(entity, multiply(back, quaternion))
    ahead, aside, over = rotate(forth, middle)
    taken, touching, close = [], [], list[Callable[[Vector, float], bool]]()
    for other in kept_apart(situation, request.facts):
        shape, pose = situation.scene.shapes[other], situation.pose(other)
        if request.support != TABLE and (shape.traits.hollow or (other == request.support and shape.hollow)):
            continue
        by_parts = not shape.traits.furniture and not (shape.model is None and entity.model is None)
        if shape.traits.furniture:
            boxes = [(box_of(corners), frame) for corners in swept(shape, pose)]
        else:
            centre, half = extent(shape, multiply(back, pose.quaternion))
            at = pose.position if centre == ORIGIN else compose(Pose(pose.position, forth), Pose(centre)).position
            boxes = [((at, half), 0.0)]
        for ((x, y, other_z), (half_x, half_y, half_z)), turn in boxes:
            if abs(z + over - other_z) < own[2] + half_z + COLLISION:
                cosine, sine = abs(math.cos(turn)), abs(math.sin(turn))
                reach_x, reach_y = cosine * half_x + sine * half_y, sine * half_x + cosine * half_y
                touching.append((x - ahead, y - aside, own[0] + reach_x, own[1] + reach_y))
                if by_parts:
                    close.append(partial(parts_meet, entity, quaternion, shape, pose, z))
                else:
                    taken.append(touching[-1])
    return _turned_rows(taken, frame), _turned_rows(touching, frame), close


def _turned_rows(rows: list[tuple[float, float, float, float]], frame: float) -> NDArray[np.float64]:
    """Return rows of places whose centres are in a frame rotated by a yaw, shape (n, 4)."""
    found = np.array(rows).reshape(-1, 4)
    found[:, :2] = turned(found[:, :2], -frame)
    return found


def _orientations(
    situation: Situation, entity: str, about: Iterable[Fact], frame: float, hand: OpenHand | None
) -> Iterator[Quaternion]:
    """Yield orientations aligned with a frame, or in the middle of the yaw ranges that facts allow.

    If a hand is given, its fingers open along the frame axis `hand.axis`. The held object is turned to match the
    fingers; another object without a model must fit between them.
    """
    try:
        ranges = yaw_ranges(situation, entity, about)
    except Failure:
        return
    if ranges is not None:
        yield from (yaw_quaternion(allowed.centre) for allowed in ranges)
        return
    shape = situation.shape(entity)
    own = side_yaw(shape)
    turns = [0.0]
    if shape.model is not None:
        turns += (math.pi, math.pi / 2, 3 * math.pi / 2)
    elif not shape.traits.round and shape.half[0] != shape.half[1]:
        turns.append(math.pi / 2)
    if hand is None:
        yield from (yaw_quaternion(frame - own + turn) for turn in turns)
        return
    fingers = frame + hand.axis * math.pi / 2
    if entity == hand.held:
        yield from (yaw_quaternion(fingers - hand.across + turn) for turn in (0.0, math.pi))
        return
    direction = (math.cos(fingers), math.sin(fingers), 0.0)
    for turn in turns:
        quaternion = yaw_quaternion(frame - own + turn)
        if shape.model is not None or width_along(shape, quaternion, direction) <= hand.width:
            yield quaternion
