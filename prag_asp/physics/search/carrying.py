"""Put down or move a held object, as the facts of the next state require."""

from __future__ import annotations

from collections.abc import Mapping

from prag_asp.physics.search.allowed_region import relevant_facts, sample_yaws, yaw_ranges
from prag_asp.physics.search.attempt import OBJECTS_COLLIDE, Failure, Search, Snapshot
from prag_asp.physics.search.grasping import LIFT, CollisionQuery, configure, descend
from prag_asp.physics.search.moving import (
    arm_waypoint,
    changed_objects,
    moved_arm,
    raise_arm,
    require_free,
    verify_objects,
    with_riders,
)
from prag_asp.physics.search.placement import any_support, known_support, sample_pose
from prag_asp.physics.situation import Situation
from prag_asp.physics.symbolic_facts import ActionEffect
from prag_asp.physics.witness import Arm, Waypoint
from prag_asp.physics.world.collisions import colliding
from prag_asp.physics.world.support import TABLE, resting_height
from prag_asp.scene.furniture import cavity
from prag_asp.scene.geometry import Pose, compose, invert, multiply, raised, yaw_of, yaw_quaternion
from prag_asp.scene.robots import Joints

OVER_RIM = 0.03


def release(search: Search, snapshot: Snapshot, effect: ActionEffect, waypoints: list[Waypoint]) -> Snapshot:
    """Place the held object as the facts require, or straight down, and open the gripper."""
    entity, situation, acting, arm = effect.releases, snapshot.situation, snapshot.acting, snapshot.arm
    assert entity is not None
    opening = search.robot.opening
    if entity not in effect.moved and snapshot.above is not None:
        at, above, poses = snapshot.arm.joints, snapshot.above, situation.poses
    else:
        rest = _rest_pose(search, snapshot, entity, effect)
        poses = with_riders(situation, entity, rest, search.objects)
        placed = situation.with_poses(poses).with_arm(acting, Arm(arm.joints, arm.width))
        verify_objects(search, placed, changed_objects(snapshot, poses))
        at, above = _lower(search, snapshot, entity, poses)
        waypoints += [Waypoint(name, acting, to, arm.width, entity) for name, to in (("approach", above), ("at", at))]
    after = snapshot.with_poses(poses).with_arm(Arm(at, opening), above)
    require_free(search, after, entity)
    waypoints.append(arm_waypoint("at", after))
    if not effect.stays:
        after = raise_arm(search, after, waypoints)
    return after


def _rest_pose(search: Search, snapshot: Snapshot, entity: str, effect: ActionEffect) -> Pose:
    """Return where a released object comes to rest."""
    situation = snapshot.situation
    others = {other: pose for other, pose in situation.poses.items() if other != entity}
    if entity in effect.moved:
        around = situation.with_poses(others)
        support = known_support(around, entity, effect.after)
        if support is None:
            support = any_support(search, around, entity, effect.after)
        return sample_pose(search, around, entity, support, effect.after, effect.number)
    height = resting_height(situation, entity, others)
    return raised(situation.poses[entity], height - situation.bottom(entity))


def _lower(search: Search, snapshot: Snapshot, entity: str, poses: Mapping[str, Pose]) -> tuple[Joints, Joints]:
    """Return the joint configurations at and above the place where the held object is put down."""
    situation, arm = snapshot.situation, snapshot.arm
    assert arm.grasp is not None
    tool = compose(poses[entity], invert(arm.grasp))
    high = situation.with_poses(with_riders(situation, entity, raised(poses[entity], LIFT), search.objects))
    at = CollisionQuery(situation.with_poses(poses), arm.width, entity)
    above = CollisionQuery(high, arm.width, entity)
    joints = descend(search, tool, at, above)
    pair = colliding(search.simulator, high, [entity], search.objects)
    if pair is not None:
        raise Failure(OBJECTS_COLLIDE, *pair)
    return joints


def carry(search: Search, snapshot: Snapshot, entity: str, effect: ActionEffect, waypoints: list[Waypoint]) -> Snapshot:
    """Move the held object as the facts require, clear of what is below."""
    situation, arm = snapshot.situation, snapshot.arm
    assert arm.grasp is not None
    others = {other: pose for other, pose in situation.poses.items() if other != entity}
    around = situation.with_poses(others)
    required = [fact for fact in effect.fresh if fact.value and fact.arguments[0] == entity]
    if required and all(fact.predicate.on_the_spot for fact in required):
        pose = _turned(search, situation, entity, effect)
    else:
        support = known_support(around, entity, effect.after) or TABLE
        depth = _depth(around, support)
        height = max(LIFT, depth + OVER_RIM)
        pose = sample_pose(search, around, entity, support, effect.after, effect.number, height=height)
    poses = with_riders(situation, entity, pose, search.objects)
    after = situation.with_poses(poses)
    verify_objects(search, after, changed_objects(snapshot, poses))
    query = CollisionQuery(after, arm.width, entity)
    joints = configure(search, compose(pose, invert(arm.grasp)), query)
    carried = moved_arm(snapshot, joints, poses)
    waypoints.append(arm_waypoint("carry", carried))
    return carried


def _depth(situation: Situation, support: str) -> float:
    """Return the depth of a hollow support, 0 for other supports; metres."""
    if support == TABLE:
        return 0.0
    if situation.shape(support).traits.furniture:
        return situation.top(support) - situation.floor(support).position[2]
    return cavity(situation.shape(support))[2]


def _turned(search: Search, situation: Situation, entity: str, effect: ActionEffect) -> Pose:
    """Return the pose of the held object rotated in place."""
    pose = situation.poses[entity]
    yaw = yaw_of(pose.quaternion)
    ranges = yaw_ranges(situation, entity, relevant_facts(effect.after, entity, situation))
    if ranges is not None:
        yaw = next(sample_yaws(search, ranges))
    turn = yaw_quaternion(yaw - yaw_of(pose.quaternion))
    return Pose(pose.position, multiply(turn, pose.quaternion))


def relocate(search: Search, snapshot: Snapshot, effect: ActionEffect, entity: str) -> Snapshot:
    """Move an object that no gripper touches, as in domains without a gripper."""
    situation = snapshot.situation
    others = {other: pose for other, pose in situation.poses.items() if other != entity}
    around = situation.with_poses(others)
    support = known_support(around, entity, effect.after)
    if support is None:
        support = any_support(search, around, entity, effect.after)
    pose = sample_pose(search, around, entity, support, effect.after, effect.number)
    poses = with_riders(situation, entity, pose, search.objects)
    after = situation.with_poses(poses)
    verify_objects(search, after, changed_objects(snapshot, poses))
    relocated = snapshot.with_poses(poses)
    require_free(search, relocated)
    return relocated
