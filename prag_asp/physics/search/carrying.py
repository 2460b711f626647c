"""Put down or move a held object, as the facts of the next state require."""

from __future__ import annotations

import math
from collections.abc import Iterator
from contextlib import suppress
from dataclasses import replace
from itertools import product

from prag_asp.physics.grasps.body_grasps import free_opening
from prag_asp.physics.grasps.pads import ParallelGripper
from prag_asp.physics.predicates.grip_geometry import CLEARANCE
from prag_asp.physics.search.allowed_region import relevant_facts, sample_yaws, yaw_ranges
from prag_asp.physics.search.attempt import ARM_COLLIDES, OBJECTS_COLLIDE, Failure, Search, Snapshot
from prag_asp.physics.search.grasping import LIFT, CollisionQuery, configure, descend
from prag_asp.physics.search.moving import move_object, moved_arm, raise_arm, require_free, with_riders
from prag_asp.physics.search.packing import ROWS, Corner, Filling, OpenHand, fill, requested_pose, resting_pose
from prag_asp.physics.search.placement import PlacementRequest, known_support
from prag_asp.physics.situation import Situation
from prag_asp.physics.symbolic_facts import ActionEffect
from prag_asp.physics.witness import Arm
from prag_asp.physics.world.collisions import colliding
from prag_asp.physics.world.support import TABLE, resting_height
from prag_asp.scene.furniture import cavity
from prag_asp.scene.geometry import Pose, compose, invert, multiply, raised, rotate, yaw_of, yaw_quaternion

OVER_RIM = 0.03
"""The height in metres above the rim of its container at which an object is carried."""

FINGER_MARGIN = 0.003
"""The distance in metres between the fingers of a hand that opens and the nearest object in a row."""


def release(search: Search, snapshot: Snapshot, effect: ActionEffect) -> Snapshot:
    """Place the held object as the facts require (without requirements, straight down), and open the gripper."""
    entity, situation, arm = effect.releases, snapshot.situation, snapshot.arm
    assert entity is not None
    if entity not in effect.moved and snapshot.above is not None:
        at, above, poses = arm.joints, snapshot.above, situation.poses
    else:
        if entity in effect.moved:
            rest = put_pose(search, situation, effect, entity, arm)
        else:
            others = {other: pose for other, pose in situation.poses.items() if other != entity}
            rest = raised(situation.poses[entity], resting_height(situation, entity, others) - situation.bottom(entity))
        poses = move_object(search, snapshot.with_arm(Arm(arm.joints, arm.width)), entity, rest)
        assert arm.grasp is not None
        high = situation.with_poses(with_riders(situation, entity, raised(rest, LIFT), search.objects))
        at_query, above_query = (
            CollisionQuery(each, arm.width, entity) for each in (situation.with_poses(poses), high)
        )
        at, above = descend(search, compose(rest, invert(arm.grasp)), at_query, above_query)
        pair = colliding(search.simulator, high, [entity], search.objects)
        if pair is not None:
            raise Failure(OBJECTS_COLLIDE, *pair)
        for name, joints in (("approach", above), ("at", at)):
            snapshot = snapshot.with_arm(replace(arm, joints=joints)).with_waypoint(name)
    after = snapshot.with_poses(poses).with_arm(Arm(at, _free_width(search, snapshot, entity)), above)
    require_free(search, after, entity)
    after = after.with_waypoint("at")
    return after if effect.stays else raise_arm(search, after)


def _free_width(search: Search, snapshot: Snapshot, entity: str) -> float:
    """Return the opening of the fingers in metres that releases an object.

    Raises:
        Failure: the fingers touch the object at every opening.
    """
    shape, arm = snapshot.situation.shape(entity), snapshot.arm
    if shape.model is None or arm.grasp is None:
        return search.robot.opening
    width = free_opening(shape, ParallelGripper.of(search.robot), invert(arm.grasp), arm.width)
    if width is None:
        raise Failure(ARM_COLLIDES, entity)
    return width


def carry(search: Search, snapshot: Snapshot, entity: str, effect: ActionEffect) -> Snapshot:
    """Move the held object as the facts require, clear of everything below it."""
    situation, arm = snapshot.situation, snapshot.arm
    assert arm.grasp is not None
    required = [fact for fact in effect.fresh if fact.value and fact.arguments[0] == entity]
    if required and all(fact.predicate.on_the_spot for fact in required):
        pose = situation.poses[entity]
        ranges = yaw_ranges(situation, entity, relevant_facts(effect.after, entity, situation))
        old_yaw = yaw_of(pose.quaternion)
        new_yaw = old_yaw if ranges is None else next(sample_yaws(search, ranges))
        pose = Pose(pose.position, multiply(yaw_quaternion(new_yaw - old_yaw), pose.quaternion))
    else:
        support, depth = known_support(situation, entity, effect.after) or TABLE, 0.0
        if support != TABLE and situation.shape(support).traits.furniture:
            depth = situation.top(support) - situation.floor(support).position[2]
        elif support != TABLE:
            depth = cavity(situation.shape(support))[2]
        height = max(LIFT, depth + OVER_RIM)
        request = PlacementRequest(entity, support, effect.after, effect.number, height)
        pose = requested_pose(search, situation, request)
    poses = move_object(search, snapshot, entity, pose)
    query = CollisionQuery(situation.with_poses(poses), arm.width, entity)
    joints = configure(search, compose(pose, invert(arm.grasp)), query)
    return moved_arm(snapshot, joints, poses).with_waypoint("carry")


def put_pose(search: Search, situation: Situation, effect: ActionEffect, entity: str, arm: Arm | None = None) -> Pose:
    """Return a pose on a support for an object that an action puts down, or that moves without an arm.

    If the search looks ahead to later puts, the pose leaves room for them on the same support.

    Raises:
        Failure: every support is ruled out, or there is no pose on the chosen one.
    """
    later = search.later_puts.get((effect.number, entity))
    if later is None:
        return resting_pose(search, situation, entity, effect.after, effect.number)
    facts = {entity: effect.after, **dict(later)}
    without = situation.with_poses({other: pose for other, pose in situation.poses.items() if other not in facts})
    order = sorted(facts, key=lambda each: -math.prod(situation.shape(each).half[:2]))
    least = min(min(situation.shape(each).half[:2]) for each in facts)
    for tightest, *ample in _fillings(search, entity, arm, least):
        with suppress(Failure):
            tight = fill(search, without, order, lambda each, _: facts[each], tightest, 1)
            for filling in ample:
                with suppress(Failure):
                    return fill(search, without, order, lambda each, _: facts[each], filling, 1).pose(entity)
            return tight.pose(entity)
    return resting_pose(search, situation, entity, effect.after, effect.number)


def _fillings(search: Search, entity: str, arm: Arm | None, least: float) -> Iterator[list[Filling]]:
    """Yield, for each axis of the hand, the ways to fill a region with objects that are put down.

    The tightest way comes first; the others are in order of the room that they leave for a hand, the largest first.
    `least` is half the smallest width of the objects in metres.
    """
    corner = Corner.sample(search)
    if arm is None or arm.grasp is None:
        yield [Filling(corner, (row, row)) for row in (ROWS[-1], *ROWS[:-1])]
        return
    x, y, _ = rotate(invert(arm.grasp).quaternion, (0.0, 1.0, 0.0))
    outside = max(box.at[1] + box.size[1] / 2 for box in search.robot.finger_boxes)
    room = search.robot.opening / 2 + outside + FINGER_MARGIN - least
    first = int(search.rng.integers(2))
    for axis in (first, 1 - first):
        hand = OpenHand(axis, 0.0, search.robot.opening - CLEARANCE, entity, math.atan2(y, x))
        yield [
            Filling(corner, (room, row) if axis == 0 else (row, room), hand._replace(wall=wall))
            for wall, row in ((0.0, ROWS[-1]), *product((room, 0.0), ROWS))
        ]


def relocate(search: Search, snapshot: Snapshot, effect: ActionEffect, entity: str) -> Snapshot:
    """Move an object that no gripper touches, as in domains without a gripper."""
    pose = put_pose(search, snapshot.situation, effect, entity)
    relocated = snapshot.with_poses(move_object(search, snapshot, entity, pose))
    require_free(search, relocated)
    return relocated
