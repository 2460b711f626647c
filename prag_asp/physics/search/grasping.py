"""Bring the gripper to an object: grasps from above, and arm configurations at it and above it."""

from __future__ import annotations

import math
from collections.abc import Iterator
from itertools import islice
from typing import NamedTuple

from prag_asp.physics.predicates.gaps import ROUNDING
from prag_asp.physics.predicates.gripper import CLEARANCE, lowest_grip
from prag_asp.physics.robot.kinematics import inverse
from prag_asp.physics.search.attempt import (
    ARM_COLLIDES,
    NO_GRASP,
    NO_KINEMATICS_ABOVE,
    NO_KINEMATICS_AT,
    Failure,
    Search,
)
from prag_asp.physics.situation import Situation
from prag_asp.physics.world.collisions import ArmCollision, arm_collision
from prag_asp.scene.geometry import Pose, multiply, raised, rotate, width_along, yaw_of, yaw_quaternion
from prag_asp.scene.robots import Joints
from prag_asp.scene.scene import Shape

LIFT = 0.10
"""How far above an object the gripper approaches it, in metres."""

TOP_GRIP = 0.01
"""How far below the top of an object the highest grip is, in metres."""

HAIR = 1e-5
"""How far below the top of an object every grip is, for kinematics are not exact, in metres."""

LONG, FROM_END = 0.08, 0.03
"""Where robots share a table each grips a box that is at least twice as long so far from its end, in metres."""

LARGEST_STEP = 1.2
DOWN = (1.0, 0.0, 0.0, 0.0)


class Configuration(NamedTuple):
    """What the arm has to be free of: the objects of a situation, but for the one it may touch."""

    situation: Situation
    width: float
    touched: str | None


def grasps(search: Search, situation: Situation, entity: str) -> list[tuple[Pose, float]]:
    """Return tool poses from above that grip an object, each with the opening then, the easiest first.

    Boxes are gripped by opposite sides, round things in four directions; first at the middle or as deep as
    the palm lets them in, then at the top, where the palm passes over what stands around.

    Raises:
        Failure: the object is too wide for the gripper, or too low.
    """
    shape, pose = situation.shape(entity), situation.pose(entity)
    x, y, z = pose.position
    half = situation.half(entity)[2]
    lowest = z - half + lowest_grip(search.robot)
    if lowest > z + half + ROUNDING:
        raise Failure(NO_GRASP, entity)
    height = min(max(z, z + half - search.robot.finger_depth, lowest), z + half - HAIR)
    base_x, base_y, _ = search.robot.base.position
    heading = math.atan2(y - base_y, x - base_x)
    round_body = shape.traits.round
    first = heading if round_body else yaw_of(pose.quaternion)
    turns = [first + turn * math.pi / (4 if round_body else 2) for turn in range(8 if round_body else 4)]
    # Half a turn gives the same grip, so of each pair of opposite headings the nearer one is enough.
    yaws = sorted(turns, key=lambda angle: -math.cos(angle - heading))[: len(turns) // 2]
    found = []
    for yaw in yaws:
        opening = (-math.sin(yaw), math.cos(yaw), 0.0)
        width = width_along(shape, pose.quaternion, opening)
        if width <= search.robot.opening - CLEARANCE:
            found.append((Pose((x, y, height), multiply(yaw_quaternion(yaw), DOWN)), width))
    if not found:
        raise Failure(NO_GRASP, entity)
    if search.scene.shared and shape.traits.even and max(shape.half[:2]) >= LONG:
        found = [at_end for grasp in found for at_end in _at_ends(shape, pose, grasp)]
    rise = z + half - TOP_GRIP - height
    if rise > 0.0 and shape.traits.flat:
        found += [(raised(tool, rise), width) for tool, width in found]
    return found


def _at_ends(shape: Shape, pose: Pose, grasp: tuple[Pose, float]) -> Iterator[tuple[Pose, float]]:
    """Yield a grasp of a long box shifted to either end, so that another robot finds the other end free."""
    tool, width = grasp
    along = 0 if shape.half[0] > shape.half[1] else 1
    shift = shape.half[along] - FROM_END
    for side in (shift, -shift):
        x, y, z = rotate(pose.quaternion, (side, 0.0, 0.0) if along == 0 else (0.0, side, 0.0))
        cx, cy, cz = tool.position
        yield Pose((cx + x, cy + y, cz + z), tool.quaternion), width


def configure(search: Search, tool: Pose, wanted: Configuration, near: Joints | None = None) -> Joints:
    """Return joint angles that bring the tool to a pose, free of collisions.

    Raises:
        Failure: there are none.
    """
    failed = Failure(NO_KINEMATICS_AT, *_touched(wanted))
    for joints in inverse(search.robot, tool, near):
        collision = collide(search, joints, wanted)
        if collision is None:
            return joints
        failed = Failure(ARM_COLLIDES, collision.other)
        if collision.by_hand:
            break
    raise failed


def descend(search: Search, tool: Pose, at: Configuration, above: Configuration) -> tuple[Joints, Joints]:
    """Return joint angles at a tool pose and, near to those, `LIFT` straight above, free of collisions.

    Raises:
        Failure: there are none.
    """
    failed: Failure | None = None
    for low in inverse(search.robot, tool):
        collision = collide(search, low, at)
        if collision is not None:
            failed = failed or Failure(ARM_COLLIDES, collision.other)
            if collision.by_hand:
                break
            continue
        for high in islice(inverse(search.robot, raised(tool, LIFT), near=low), 2):
            if max(abs(a - b) for a, b in zip(low, high, strict=True)) > LARGEST_STEP:
                continue
            if collide(search, high, above) is None:
                return low, high
        failed = Failure(NO_KINEMATICS_ABOVE, *_touched(at))
    raise failed or Failure(NO_KINEMATICS_AT, *_touched(at))


def _touched(wanted: Configuration) -> tuple[str, ...]:
    """Return the object that the arm goes to, where it goes to one."""
    return () if wanted.touched is None else (wanted.touched,)


def collide(search: Search, joints: Joints, wanted: Configuration) -> ArmCollision | None:
    """Return what the arm collides with, None where it is free."""
    return arm_collision(search.simulator, wanted.situation, joints, wanted.width, wanted.touched)
