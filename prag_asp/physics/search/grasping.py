"""Grasps in a scene, and joint configurations at an object and at the start of the approach."""

from __future__ import annotations

import math
from collections import Counter
from itertools import chain, islice
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from prag_asp.physics.grasps.body_grasps import grasp_table
from prag_asp.physics.grasps.pads import ParallelGripper
from prag_asp.physics.grasps.tilting import tilting_loads
from prag_asp.physics.predicates.gaps import ROUNDING
from prag_asp.physics.predicates.grip_friction import (
    GRAVITY,
    SLIPS,
    finger_force,
    grasps_in_body,
    grip_load,
    pad_friction,
)
from prag_asp.physics.predicates.grip_geometry import CLEARANCE, is_flat, lowest_body, lowest_grip
from prag_asp.physics.robot.kinematics import adjust_joints, inverse
from prag_asp.physics.search.attempt import (
    ARM_COLLIDES,
    NO_GRASP,
    NO_KINEMATICS_ABOVE,
    NO_KINEMATICS_AT,
    TWISTS,
    Failure,
    Search,
)
from prag_asp.physics.situation import Situation
from prag_asp.physics.world.collisions import ArmCollision, arm_collision
from prag_asp.scene.boxes import Vector
from prag_asp.scene.geometry import Pose, compose, matrix, multiply, raised, rotate, width_along, yaw_of, yaw_quaternion
from prag_asp.scene.robots import Joints
from prag_asp.scene.solids import weight

LIFT = 0.10
"""The height above an object at which the gripper begins its approach, in metres."""

TOP_GRIP = 0.01
"""The distance of the highest grasp below the top of an object, in metres."""

HAIR = 1e-5
"""The minimum distance in metres between any grasp and the top of an object, because kinematics is not exact."""

LONG, FROM_END = 0.08, 0.03
"""If there are several robots, a box whose length is at least twice `LONG` is grasped `FROM_END` from its end, in
metres."""

MIDDLE = 0.03
"""The smallest distance in metres from the middle of a long body with a model to a grasp that leaves room for the hand
of another robot; a hand is 63 mm wide."""

LARGEST_STEP = 1.2
"""The largest turn of a joint, in radians, between a grasp and `LIFT` above it, if both are on one branch of the
kinematics."""

DOWN = (1.0, 0.0, 0.0, 0.0)
EASE = 0.3
"""The bonus in a grasp's score if the arm approaches from its own side."""

STEADY = 1.0
"""The amount by which a grasp's score decreases if the weight of the body just suffices to tilt it out of the pads."""

STEADIEST = 0.8
"""The largest torque that tilts a body in a grasp, as a share of the torque that pads bear.

The robot also accelerates the body, and friction that bears its weight does not bear all of the torque. In simulation,
a basin was held in none of 23 grasps with shares from 0.81 to 1.04, and in 6 of 9 with shares from 0.60 to 0.79.
"""

SECTOR, SIDEWAYS = math.pi / 4, 0.7
"""Grasps are of the same kind if their axes are in the same sector, in radians, and if both or neither come from the
side, that is, if the cosine of the tool's angle from straight down is below the second number."""

STRAIGHT_DOWN = 1e-7
"""The amount by which the cosine of a tool's angle from straight down may be below 1: about half a milliradian."""


class CollisionQuery(NamedTuple):
    """A collision query for the acting arm: a situation, the gripper's opening, and the object that it may touch."""

    situation: Situation
    width: float
    touched: str | None


class GraspOption(NamedTuple):
    """A tool pose that grasps an object, and the opening of the fingers during the approach, in metres."""

    tool: Pose
    approach: float


def grasps(search: Search, situation: Situation, entity: str) -> list[GraspOption]:
    """Return the ways of grasping an object, easiest first.

    Raises:
        Failure: there is no grasp, or with every grasp the object would twist in the gripper.
    """
    if situation.shape(entity).model is not None:
        return _sampled(search, situation, entity)
    return [GraspOption(tool, search.robot.opening) for tool, _ in _from_above(search, situation, entity)]


def _sampled(search: Search, situation: Situation, entity: str) -> list[GraspOption]:
    """Return the grasps of a body with a model at its pose, best first, each turned towards the arm's side.

    Raises:
        Failure: there is no grasp, or none in which the pads bear the weight and the torque of the body.
    """
    found = grasps_in_body(situation, entity, search.simulator.acting)
    if not found:
        raise Failure(NO_GRASP, entity)
    acting, pose = search.simulator.acting, situation.pose(entity)
    gripper, friction = ParallelGripper.of(search.robot), pad_friction(search.scene, entity)
    table = grasp_table(situation.shape(entity), gripper, friction)
    frames = matrix(pose) @ table.frames
    away = frames[:, :2, 3] - search.robot.base.position[:2]
    outward = away / np.maximum(np.linalg.norm(away, axis=1), HAIR)[:, None]
    # The palm's x axis points away from the base, and so does an inclined tool; the wrist is therefore on the arm's
    # side.
    forward, slope = ((frames[:, :2, axis] * outward).sum(1) for axis in (0, 2))
    ease = np.abs(forward) + 2 * np.minimum(0.0, slope)
    press = finger_force(search.scene, entity, acting)
    loads = tilting_loads(situation.shape(entity), gripper, friction) * GRAVITY * weight(search.scene, entity) / press
    tilting = loads[:, 0]
    order = np.argsort(STEADY * tilting - EASE * ease - table.scores, kind="stable")
    sectors = np.round(np.arctan2(frames[:, 1, 1], frames[:, 0, 1]) / SECTOR) % round(math.pi / SECTOR)
    kinds = list(zip(sectors.tolist(), (frames[:, 2, 2] > -SIDEWAYS).tolist(), strict=True))
    twisting = grip_load(search.scene, entity, acting, 0.0, 1.0) * table.loads
    bearing = ((twisting <= SLIPS) & (loads[:, 1] <= STEADIEST)).tolist()
    # The best grasps of each kind come first, then the second best, because where one kind fails, another may succeed.
    # Grasps at an edge come last, before them those out of which the body tilts, and before them those that leave no
    # room for another robot.
    central = _leaves_no_room(search, situation, entity, table.frames)
    counts, ranked = Counter[tuple[float, bool]](), list[tuple[bool, bool, bool, int, int]]()
    for i in order.tolist():
        if bearing[i]:
            last = bool(table.at_edge[i]), bool(tilting[i] > 1.0), bool(central[i])
            ranked.append((*last, counts[kinds[i]], i))
            counts[kinds[i]] += 1
    if not ranked:
        raise Failure(TWISTS, entity)
    x, y, z, w = pose.quaternion
    # `multiply` by the orientation of the body as a matrix; half a turn about the tool's own axis gives the same grasp.
    turned = np.array([(w, -z, y, x), (z, w, -x, y), (-y, x, w, z), (-x, -y, -z, w)]) @ table.quaternions
    turned = np.where(forward >= 0.0, turned, turned[[1, 0, 3, 2]] * [[1.0], [-1.0], [1.0], [-1.0]])
    places, quaternions = frames[:, :3, 3].tolist(), turned.T.tolist()
    options = [
        GraspOption(Pose(tuple(places[i]), tuple(quaternions[i])), found[i].approach)
        for *_, i in sorted(ranked, key=lambda row: row[:4])
    ]
    first = search.passed_over % len(options)
    return options[first:] + options[:first]


def _leaves_no_room(
    search: Search, situation: Situation, entity: str, frames: NDArray[np.float64]
) -> NDArray[np.bool_]:
    """Return, for each grasp frame (n, 4, 4), whether it leaves no room for another robot on a long body."""
    half = np.array(situation.shape(entity).half[:2])
    if not search.scene.shared or half.max() < LONG:
        return np.zeros(len(frames), dtype=bool)
    return np.abs(frames[:, half.argmax(), 3]) < MIDDLE


def _along(pose: Pose, axis: Vector, direction: Vector) -> float:
    """Return the cosine of the angle between an axis of a pose and a direction, both unit vectors."""
    return sum(a * b for a, b in zip(rotate(pose.quaternion, axis), direction, strict=True))


def _from_above(search: Search, situation: Situation, entity: str) -> list[tuple[Pose, float]]:
    """Return tool poses from above that grasp an object, each with its opening in metres, easiest first.

    Boxes are grasped at opposite sides, round objects from four directions; first in the middle or as low as the palm
    allows, then at the top, where the palm clears nearby objects.

    Raises:
        Failure: the object is too wide for the gripper, or too flat.
    """
    shape, pose = situation.shape(entity), situation.pose(entity)
    x, y, z = pose.position
    half = situation.half(entity)[2]
    lowest = z - half + lowest_grip(search.robot, 2 * half)
    if 2 * half < lowest_body() - ROUNDING:
        raise Failure(NO_GRASP, entity)
    highest = max(lowest, z + half - HAIR) if is_flat(search.robot, 2 * half) else z + half - HAIR
    height = min(max(z, z + half - search.robot.finger_depth, lowest), highest)
    base_x, base_y, _ = search.robot.base.position
    heading = math.atan2(y - base_y, x - base_x)
    round_body = shape.traits.round
    first = heading if round_body else yaw_of(pose.quaternion)
    turns = [first + turn * math.pi / (4 if round_body else 2) for turn in range(8 if round_body else 4)]
    # Half a turn gives the same grasp, so the nearer of two opposite headings is enough.
    yaws = sorted(turns, key=lambda angle: -math.cos(angle - heading))[: len(turns) // 2]
    candidates, limit, widths = [], search.robot.opening - CLEARANCE, []
    for yaw in yaws:
        opening = (-math.sin(yaw), math.cos(yaw), 0.0)
        width = width_along(shape, pose.quaternion, opening)
        widths.append(width)
        if width <= limit:
            candidates.append((Pose((x, y, height), multiply(yaw_quaternion(yaw), DOWN)), width))
    if not candidates:
        raise Failure(NO_GRASP, entity, missed=min(widths) - limit)
    if search.scene.shared and shape.traits.even and max(shape.half[:2]) >= LONG:
        # a grasp near either end leaves the other end free for another robot
        reach, along_x = max(shape.half[:2]) - FROM_END, shape.half[0] > shape.half[1]
        ends = [(side, 0.0, 0.0) if along_x else (0.0, side, 0.0) for side in (reach, -reach)]
        shifts = [rotate(pose.quaternion, end) for end in ends]
        candidates = [
            (Pose((x + dx, y + dy, height + dz), tool.quaternion), width)
            for tool, width in candidates
            for dx, dy, dz in shifts
        ]
    rise = z + half - TOP_GRIP - height
    if rise > 0.0 and shape.traits.flat:
        candidates += [(raised(tool, rise), width) for tool, width in candidates]
    return candidates


def configure(search: Search, tool: Pose, query: CollisionQuery, near: Joints | None = None) -> Joints:
    """Return a collision-free joint configuration for a tool pose.

    Raises:
        Failure: every configuration collides, or there is none for the pose.
    """
    failed = Failure(NO_KINEMATICS_AT, *_touched(query))
    for joints in inverse(search.robot, tool, near):
        collision = collide(search, joints, query)
        if collision is None:
            return joints
        failed = Failure(ARM_COLLIDES, collision.other)
        if collision.by_hand:
            break
    raise failed


def descend(
    search: Search, tool: Pose, at: CollisionQuery, above: CollisionQuery, back: bool = False
) -> tuple[Joints, Joints]:
    """Return collision-free joint configurations at a tool pose and, close to the first one, `LIFT` straight above it.

    With `back`, the second configuration is `LIFT` back along the direction of the fingers instead.

    Raises:
        Failure: every configuration collides, or there is none for one of the poses.
    """
    before = backed(tool) if back else raised(tool, LIFT)
    failed: Failure | None = None
    for low in inverse(search.robot, tool):
        collision = collide(search, low, at)
        if collision is not None:
            failed = failed or Failure(ARM_COLLIDES, collision.other)
            if collision.by_hand:
                break
            continue
        high = near_joints(search, low, before, above, 2)
        if high is not None:
            return low, high
        failed = Failure(NO_KINEMATICS_ABOVE, *_touched(at))
    raise failed or Failure(NO_KINEMATICS_AT, *_touched(at))


def raise_joints(
    search: Search, low: Joints, tool: Pose, query: CollisionQuery, tries: int | None = None
) -> Joints | None:
    """Return a collision-free configuration with the tool `LIFT` above a pose, close to a configuration in that pose.

    The result is None if none of the first `tries` configurations (by default, all) is collision-free and close.
    """
    return near_joints(search, low, raised(tool, LIFT), query, tries)


def near_joints(
    search: Search, low: Joints, tool: Pose, query: CollisionQuery, tries: int | None = None
) -> Joints | None:
    """Return a collision-free joint configuration for a tool pose that is close to another configuration.

    The result is None if none of the first `tries` configurations (by default, all) is collision-free and close.
    """
    # The elbow swings more if the tool is inclined; the least change of all joints keeps the path between the two
    # straight.
    adjusted = None if is_downward(tool) else adjust_joints(search.robot, tool, low)
    for high in chain(() if adjusted is None else (adjusted,), islice(inverse(search.robot, tool, near=low), tries)):
        turn = max(abs(a - b) for a, b in zip(low, high, strict=True))
        if turn <= LARGEST_STEP and collide(search, high, query) is None:
            return high
    return None


def backed(tool: Pose) -> Pose:
    """Return a tool pose moved back by `LIFT` along the direction of its fingers."""
    return raised(tool, LIFT) if is_downward(tool) else compose(tool, Pose((0.0, 0.0, -LIFT)))


def is_downward(tool: Pose) -> bool:
    """Return whether the fingers of a tool point straight down, in which case it retreats upwards."""
    return _along(tool, (0.0, 0.0, 1.0), (0.0, 0.0, -1.0)) > 1.0 - STRAIGHT_DOWN


def _touched(query: CollisionQuery) -> tuple[str, ...]:
    """Return the object that the arm may touch, if any."""
    return () if query.touched is None else (query.touched,)


def collide(search: Search, joints: Joints, query: CollisionQuery) -> ArmCollision | None:
    """Return the collision that the acting arm is in, or None if there is none."""
    return arm_collision(search.simulator, query.situation, joints, query.width, query.touched)


def require_clear(search: Search, joints: Joints, query: CollisionQuery) -> None:
    """Check that the acting arm is free of collisions.

    Raises:
        Failure: the arm collides with something.
    """
    hit = collide(search, joints, query)
    if hit is not None:
        raise Failure(ARM_COLLIDES, hit.other)
