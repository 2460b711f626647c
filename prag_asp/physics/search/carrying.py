"""Put down or move a held object, as the facts of the next state require."""

from __future__ import annotations

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
from prag_asp.physics.search.placement import known_support, sample_pose, sample_resting_pose
from prag_asp.physics.symbolic_facts import ActionEffect
from prag_asp.physics.witness import Arm, Waypoint
from prag_asp.physics.world.collisions import colliding
from prag_asp.physics.world.support import TABLE, resting_height
from prag_asp.scene.furniture import cavity
from prag_asp.scene.geometry import Pose, compose, invert, multiply, raised, yaw_of, yaw_quaternion

OVER_RIM = 0.03
"""The height of a carried object above the rim of what it goes into, in metres."""


def release(search: Search, snapshot: Snapshot, effect: ActionEffect, waypoints: list[Waypoint]) -> Snapshot:
    """Place the held object as the facts require, or straight down, and open the gripper."""
    entity, situation, acting, arm = effect.releases, snapshot.situation, snapshot.acting, snapshot.arm
    assert entity is not None
    opening = search.robot.opening
    if entity not in effect.moved and snapshot.above is not None:
        at, above, poses = snapshot.arm.joints, snapshot.above, situation.poses
    else:
        if entity in effect.moved:
            rest = sample_resting_pose(search, situation, entity, effect.after, effect.number)
        else:
            others = {other: pose for other, pose in situation.poses.items() if other != entity}
            rest = raised(situation.poses[entity], resting_height(situation, entity, others) - situation.bottom(entity))
        poses = with_riders(situation, entity, rest, search.objects)
        placed = situation.with_poses(poses).with_arm(acting, Arm(arm.joints, arm.width))
        verify_objects(search, placed, changed_objects(snapshot, poses))
        assert arm.grasp is not None
        high = situation.with_poses(with_riders(situation, entity, raised(rest, LIFT), search.objects))
        at_query, above_query = (
            CollisionQuery(each, arm.width, entity) for each in (situation.with_poses(poses), high)
        )
        at, above = descend(search, compose(rest, invert(arm.grasp)), at_query, above_query)
        pair = colliding(search.simulator, high, [entity], search.objects)
        if pair is not None:
            raise Failure(OBJECTS_COLLIDE, *pair)
        waypoints += [Waypoint(name, acting, to, arm.width, entity) for name, to in (("approach", above), ("at", at))]
    after = snapshot.with_poses(poses).with_arm(Arm(at, opening), above)
    require_free(search, after, entity)
    waypoints.append(arm_waypoint("at", after))
    if not effect.stays:
        after = raise_arm(search, after, waypoints)
    return after


def carry(search: Search, snapshot: Snapshot, entity: str, effect: ActionEffect, waypoints: list[Waypoint]) -> Snapshot:
    """Move the held object as the facts require, clear of what is below."""
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
        pose = sample_pose(search, situation, entity, support, effect.after, effect.number, height=height)
    poses = with_riders(situation, entity, pose, search.objects)
    after = situation.with_poses(poses)
    verify_objects(search, after, changed_objects(snapshot, poses))
    query = CollisionQuery(after, arm.width, entity)
    joints = configure(search, compose(pose, invert(arm.grasp)), query)
    carried = moved_arm(snapshot, joints, poses)
    waypoints.append(arm_waypoint("carry", carried))
    return carried


def relocate(search: Search, snapshot: Snapshot, effect: ActionEffect, entity: str) -> Snapshot:
    """Move an object that no gripper touches, as in domains without a gripper."""
    situation = snapshot.situation
    pose = sample_resting_pose(search, situation, entity, effect.after, effect.number)
    poses = with_riders(situation, entity, pose, search.objects)
    after = situation.with_poses(poses)
    verify_objects(search, after, changed_objects(snapshot, poses))
    relocated = snapshot.with_poses(poses)
    require_free(search, relocated)
    return relocated
