"""Put down or move a held object, as the facts of the next state require."""

from __future__ import annotations

from dataclasses import replace

from prag_asp.physics.grasps.body_grasps import free_opening
from prag_asp.physics.grasps.pads import ParallelGripper
from prag_asp.physics.search.allowed_region import relevant_facts, sample_yaws, yaw_ranges
from prag_asp.physics.search.attempt import ARM_COLLIDES, OBJECTS_COLLIDE, Failure, Search, Snapshot
from prag_asp.physics.search.grasping import LIFT, CollisionQuery, configure, descend
from prag_asp.physics.search.moving import move_object, moved_arm, raise_arm, require_free, with_riders
from prag_asp.physics.search.packing import requested_pose, resting_pose
from prag_asp.physics.search.placement import PlacementRequest, known_support
from prag_asp.physics.symbolic_facts import ActionEffect
from prag_asp.physics.witness import Arm
from prag_asp.physics.world.collisions import colliding
from prag_asp.physics.world.support import TABLE, resting_height
from prag_asp.scene.furniture import cavity
from prag_asp.scene.geometry import Pose, compose, invert, multiply, raised, yaw_of, yaw_quaternion

OVER_RIM = 0.03
"""The height in metres above the rim of its container at which an object is carried."""


def release(search: Search, snapshot: Snapshot, effect: ActionEffect) -> Snapshot:
    """Place the held object as the facts require (without requirements, straight down), and open the gripper."""
    entity, situation, arm = effect.releases, snapshot.situation, snapshot.arm
    assert entity is not None
    if entity not in effect.moved and snapshot.above is not None:
        at, above, poses = arm.joints, snapshot.above, situation.poses
    else:
        if entity in effect.moved:
            rest = resting_pose(search, situation, entity, effect.after, effect.number)
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


def relocate(search: Search, snapshot: Snapshot, effect: ActionEffect, entity: str) -> Snapshot:
    """Move an object that no gripper touches, as in domains without a gripper."""
    pose = resting_pose(search, snapshot.situation, entity, effect.after, effect.number)
    relocated = snapshot.with_poses(move_object(search, snapshot, entity, pose))
    require_free(search, relocated)
    return relocated
