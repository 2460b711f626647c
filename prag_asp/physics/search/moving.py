"""Move the arm and its load from one snapshot to the next, and check the result."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import replace

from prag_asp.physics.predicates.grip_friction import SLIPS, held_load, slips
from prag_asp.physics.search.attempt import (
    LOST,
    NO_KINEMATICS_ABOVE,
    OBJECTS_COLLIDE,
    TWISTS,
    UNSUPPORTED,
    Failure,
    Search,
    Snapshot,
)
from prag_asp.physics.search.grasping import LIFT, CollisionQuery, backed, is_downward, near_joints, require_clear
from prag_asp.physics.situation import Situation
from prag_asp.physics.world.collisions import colliding, overlap_depth
from prag_asp.physics.world.support import riders, unsupported
from prag_asp.scene.geometry import Pose, compose, invert, raised
from prag_asp.scene.robots import Joints


def turn_to(search: Search, snapshot: Snapshot, robot: str | None) -> Snapshot:
    """Make another robot the acting robot; with None, the current robot remains."""
    turned = snapshot.turned_to(robot)
    search.simulator.turn_to(turned.acting)
    return turned


def raise_arm(search: Search, snapshot: Snapshot) -> Snapshot:
    """Move a lowered gripper straight up with its load, or an empty gripper back along the direction of its fingers.

    Raises:
        Failure: the object slips out of the gripper or turns in it, or there is a collision.
    """
    assert snapshot.above is not None
    poses, held, above = snapshot.situation.poses, snapshot.arm.held, snapshot.above
    if held is not None:
        if slips(search.scene, held, snapshot.acting) is not None:
            raise Failure(LOST, held)
        if held_load(snapshot.situation, held, snapshot.acting) > SLIPS:
            raise Failure(TWISTS, held)
        poses = move_object(search, snapshot, held, raised(poses[held], LIFT))
    if not is_downward(snapshot.tool):
        goal = backed(snapshot.tool) if held is None else raised(snapshot.tool, LIFT)
        query = CollisionQuery(snapshot.situation.with_poses(poses), snapshot.arm.width, held)
        found = near_joints(search, snapshot.arm.joints, goal, query)
        if found is None:
            raise Failure(NO_KINEMATICS_ABOVE, *(() if held is None else (held,)))
        above = found
    after = moved_arm(snapshot, above, poses)
    require_free(search, after)
    after = after.with_waypoint("lift" if held else "retreat")
    if held is None and 0.0 < after.arm.width < search.robot.opening:
        # At a body with a model, the fingers open only as wide as the space allows.
        after = after.with_arm(replace(after.arm, width=search.robot.opening))
        require_free(search, after)
        after = after.with_waypoint("stay")
    return after


def with_riders(situation: Situation, entity: str, pose: Pose, objects: Iterable[str]) -> Mapping[str, Pose]:
    """Return all poses after an object and everything that rests on it have moved."""
    poses = {**situation.poses, entity: pose}
    delta = compose(pose, invert(situation.poses[entity]))
    for rider in riders(situation, entity, [other for other in objects if other != entity]):
        poses[rider] = compose(delta, situation.poses[rider])
    return poses


def move_object(search: Search, snapshot: Snapshot, entity: str, pose: Pose) -> Mapping[str, Pose]:
    """Return all poses after an object and everything that rests on it have moved.

    Raises:
        Failure: a moved object collides with something, or an object would fall.
    """
    old = snapshot.situation
    poses = with_riders(old, entity, pose, search.objects)
    changed = [other for other, moved in poses.items() if old.poses[other] != moved]
    verify_objects(search, old.with_poses(poses), changed)
    return poses


def moved_arm(snapshot: Snapshot, joints: Joints, poses: Mapping[str, Pose]) -> Snapshot:
    """Return a snapshot with the arm at other joint angles, not lowered, and the objects at other poses."""
    return snapshot.with_poses(poses).with_arm(replace(snapshot.arm, joints=joints))


def require_free(search: Search, snapshot: Snapshot, touched: str | None = None) -> None:
    """Check that the arm of a snapshot is free of collisions; it may touch an object, by default the held one.

    Raises:
        Failure: the arm collides with something else.
    """
    arm = snapshot.arm
    require_clear(search, arm.joints, CollisionQuery(snapshot.situation, arm.width, touched or arm.held))


def verify_objects(search: Search, situation: Situation, changed: Iterable[str]) -> None:
    """Check that moved objects collide with nothing, and that every object is stable.

    Raises:
        Failure: two objects collide, or one would fall.
    """
    pair = colliding(search.simulator, situation, changed, search.objects)
    if pair is not None:
        raise Failure(OBJECTS_COLLIDE, *pair, missed=overlap_depth(search.simulator, situation, *pair))
    falling = unsupported(situation, search.objects, needs_margin=True)
    if falling is not None:
        raise Failure(UNSUPPORTED, falling)
