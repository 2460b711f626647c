"""Furniture: a fixed body, a part that slides or turns on a joint, and a handle.

A *drawer* is a low cabinet, open in front, from which a tray with a front panel slides out along the cabinet's -x axis.
A *cupboard* is a low box with a door on top, which turns about a vertical pin at a corner, towards the cupboard's +y
axis. The gripper reaches all contents from above. When the furniture is closed, the roof of the drawer or the door of
the cupboard is between the gripper and the contents. Handles are vertical posts, gripped from above. Lengths are
metres; the frame of the moving part is that of its joint.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from functools import lru_cache
from typing import NamedTuple

from prag_asp.scene.boxes import Box, Corners, Vector, around, box_between
from prag_asp.scene.geometry import Pose, compose, yaw_quaternion
from prag_asp.scene.scene import Shape

GAP = 0.002
"""The gap between the moving part and the body, in metres."""

POST, STEM = 0.011, 0.005
"""Half the thickness of the post of a handle, and of the stem that holds it in front of a drawer."""

POST_HEIGHT = 0.055
GRIP_DEPTH = 0.02
"""The distance from the top of the post down to where the gripper grasps it."""

STAND_OFF = 0.025
"""The distance of the post from the panel of a drawer or the edge of a door; the fingers fit in between."""

RIM = 2 / 3
"""The height of a tray's walls as a share of the cabinet's inner height: they keep contents in but admit the hand."""

QUARTER = math.pi / 2
SWEPT = 9
"""The number of openings at which the swept volume of a part is sampled: one for each eighth of its range."""


class Mechanism(NamedTuple):
    """Furniture: the boxes of the body, in a frame at its centre, and the boxes of the part, in the joint's frame.

    If the part `slides`, it moves along `axis`, and otherwise it turns about `axis`, from 0 to `limit` (metres or
    radians). `handle` is the grasp point, in the joint's frame. `cavity` holds the inner dimensions and the depth of
    the cavity; `middle` is the centre of its floor, in the joint's frame if the part `slides`, because the cavity then
    moves with it.
    """

    body: tuple[Box, ...]
    part: tuple[Box, ...]
    joint: Vector
    axis: Vector
    slides: bool
    limit: float
    handle: Vector
    cavity: Vector
    middle: Vector


@lru_cache(maxsize=64)
def mechanism(shape: Shape) -> Mechanism:
    """Return the mechanism of a drawer or a cupboard."""
    return MAKERS[shape.kind](shape)


@lru_cache(maxsize=1 << 8)
def cavity(shape: Shape) -> Vector:
    """Return the inner dimensions and the depth, in metres, of a hollow body's cavity, or zeros for other shapes."""
    if shape.traits.furniture:
        return mechanism(shape).cavity
    if shape.model is not None and shape.model.cavity is not None:
        return shape.model.cavity.sides
    if not shape.traits.hollow:
        return (0.0, 0.0, 0.0)
    x, y, z = shape.size
    return (x - 2 * shape.wall, y - 2 * shape.wall, z - shape.wall)


@lru_cache(maxsize=1 << 10)
def part_pose(shape: Shape, pose: Pose, opening: float) -> Pose:
    """Return the pose of the moving part of furniture at an opening in metres or radians."""
    parts = mechanism(shape)
    joint = compose(pose, Pose(parts.joint))
    x, y, z = parts.axis
    if parts.slides:
        return compose(joint, Pose((x * opening, y * opening, z * opening)))
    return compose(joint, Pose((0.0, 0.0, 0.0), yaw_quaternion(z * opening)))


def cavity_pose(shape: Shape, pose: Pose, opening: float) -> Pose:
    """Return the pose of the centre of the cavity's floor at an opening."""
    parts = mechanism(shape)
    return compose(part_pose(shape, pose, opening) if parts.slides else pose, Pose(parts.middle))


@lru_cache(maxsize=1 << 10)
def bounds(shape: Shape, pose: Pose, opening: float) -> Corners:
    """Return the bounding box of furniture at an opening."""
    parts = mechanism(shape)
    return around([_around_in(parts.body, pose), _around_in(parts.part, part_pose(shape, pose, opening))])


@lru_cache(maxsize=64)
def swept(shape: Shape, pose: Pose) -> tuple[Corners, Corners]:
    """Return the bounding boxes of the body of furniture, and of its part over all openings."""
    parts = mechanism(shape)
    openings = [parts.limit * i / (SWEPT - 1) for i in range(SWEPT)]
    return _around_in(parts.body, pose), around([_around_in(parts.part, part_pose(shape, pose, q)) for q in openings])


def _drawer(shape: Shape) -> Mechanism:
    """Return the cabinet and the tray of a drawer, whose front is at -x."""
    (x, y, z), wall = shape.half, shape.wall
    front, back, side = wall - x, x - wall - GAP, y - wall - GAP
    floor = GAP + wall - z
    depth = RIM * (z - wall - GAP - floor)
    post = -x - STAND_OFF
    cabinet = (
        box_between((front, x), (-y, y), (z - wall, z)),
        box_between((front, x), (y - wall, y), (-z, z - wall)),
        box_between((front, x), (-y, wall - y), (-z, z - wall)),
        box_between((x - wall, x), (wall - y, y - wall), (-z, z - wall)),
    )
    tray = (
        box_between((-x, front - GAP), (-y, y), (GAP - z, z)),
        box_between((front - GAP, back), (-side, side), (GAP - z, floor)),
        box_between((front - GAP, back), (side - wall, side), (floor, floor + depth)),
        box_between((front - GAP, back), (-side, wall - side), (floor, floor + depth)),
        box_between((back - wall, back), (wall - side, side - wall), (floor, floor + depth)),
        box_between((post, -x), (-STEM, STEM), (z + GRIP_DEPTH - POST_HEIGHT, z + 2 * STEM + GRIP_DEPTH - POST_HEIGHT)),
        _post(post, 0.0, z + GRIP_DEPTH - POST_HEIGHT),
    )
    low, high = front - GAP, back - wall
    return Mechanism(
        body=cabinet,
        part=tray,
        joint=(0.0, 0.0, 0.0),
        axis=(-1.0, 0.0, 0.0),
        slides=True,
        limit=high - front,
        handle=(post, 0.0, z),
        cavity=(high - low, 2 * (side - wall), depth),
        middle=((low + high) / 2, 0.0, floor),
    )


def _cupboard(shape: Shape) -> Mechanism:
    """Return the box and the door of a cupboard, whose pin is at the corner of +x and +y."""
    (x, y, z), wall = shape.half, shape.wall
    rim = z - wall - GAP
    box = (
        box_between((-x, x), (-y, y), (-z, wall - z)),
        box_between((-x, x), (y - wall, y), (wall - z, rim)),
        box_between((-x, x), (-y, wall - y), (wall - z, rim)),
        box_between((x - wall, x), (wall - y, y - wall), (wall - z, rim)),
        box_between((-x, wall - x), (wall - y, y - wall), (wall - z, rim)),
    )
    pin = (x - wall / 2, y - wall / 2, 0.0)
    post = STAND_OFF - x
    door = (box_between((-x, x), (-y, y), (z - wall, z)), _post(post, 0.0, z))
    return Mechanism(
        body=box,
        part=tuple((_minus(centre, pin), half) for centre, half in door),
        joint=pin,
        axis=(0.0, 0.0, -1.0),
        slides=False,
        limit=QUARTER,
        handle=_minus((post, 0.0, z + POST_HEIGHT - GRIP_DEPTH), pin),
        cavity=(2 * (x - wall), 2 * (y - wall), rim + z - wall),
        middle=(0.0, 0.0, wall - z),
    )


MAKERS: Mapping[str, Callable[[Shape], Mechanism]] = {"drawer": _drawer, "cupboard": _cupboard}
"""The function that makes the mechanism of each kind of furniture."""


def _post(x: float, y: float, bottom: float) -> Box:
    """Return the post of a handle."""
    return box_between((x - POST, x + POST), (y - POST, y + POST), (bottom, bottom + POST_HEIGHT))


def _around_in(boxes: tuple[Box, ...], pose: Pose) -> Corners:
    """Return the bounding box of several boxes that are given in a frame with a given pose."""
    corners = []
    for (x, y, z), (dx, dy, dz) in boxes:
        for i in range(8):
            corner = (x + dx * (1 - (i & 2)), y + dy * (1 - (i & 4) // 2), z + dz * (1 - 2 * (i & 1)))
            corners.append(compose(pose, Pose(corner)).position)
    return around([(corner, corner) for corner in corners])


def _minus(one: Vector, two: Vector) -> Vector:
    """Return the difference of two vectors."""
    return (one[0] - two[0], one[1] - two[1], one[2] - two[2])
