"""Move a gripper over a place, and hand an object over from one gripper to another in the air."""

from __future__ import annotations

import math

from prag_asp.physics.predicates import PREDICATES
from prag_asp.physics.search.attempt import EMPTY_VOLUME, Failure, Search, Snapshot
from prag_asp.physics.search.grasping import DOWN, LIFT, CollisionQuery, configure
from prag_asp.physics.search.moving import move_object, moved_arm, require_free, turn_to
from prag_asp.physics.witness import Arm
from prag_asp.scene.geometry import IDENTITY, Pose, compose, multiply, raised, yaw_quaternion
from prag_asp.scene.robots import robot_of

LOWEST, HIGHEST = 0.18, 0.28
"""The range of heights of the tool over a place, in metres above its top."""

SPREAD = 0.5
"""The maximum deviation from the best yaw of the gripper in the first attempts, in radians."""

HANDY_ATTEMPTS = 6
OFF_CENTRE = 0.02


def move_over(search: Search, snapshot: Snapshot, place: str, attempt: int) -> Snapshot:
    """Move the gripper, with the object that it holds, if any, over a zone or an object.

    Raises:
        Failure: the arm cannot get there in this attempt without a collision.
    """
    tool = _tool_over(search, snapshot, place, attempt)
    situation, arm = snapshot.situation, snapshot.arm
    poses = situation.poses
    if arm.held is not None:
        assert arm.grasp is not None
        poses = move_object(search, snapshot, arm.held, compose(tool, arm.grasp))
    query = CollisionQuery(situation.with_poses(poses), arm.width, arm.held)
    after = moved_arm(snapshot, configure(search, tool, query), poses)
    return after.with_waypoint("move" if arm.held is None else "carry")


def take_over(search: Search, snapshot: Snapshot, giver: str) -> Snapshot:
    """Open the giver's gripper in a handover and retreat upwards, after the receiver has grasped the object.

    Raises:
        Failure: the giver cannot retreat without a collision.
    """
    snapshot = turn_to(search, snapshot, giver)
    before, opening, tool = snapshot.arm, search.robot.opening, snapshot.tool
    opened = snapshot.with_arm(Arm(before.joints, opening)).with_waypoint("at")
    require_free(search, opened, before.held)
    query = CollisionQuery(opened.situation, opening, None)
    joints = configure(search, raised(tool, LIFT), query, near=before.joints)
    return moved_arm(opened, joints, opened.situation.poses).with_waypoint("retreat")


def _tool_over(search: Search, snapshot: Snapshot, place: str, attempt: int) -> Pose:
    """Return a random tool pose over a place, on the side nearer to the robot; a held object keeps clear of the place.

    Raises:
        Failure: there is no room over the place.
    """
    situation, base = snapshot.situation, search.robot.base.position
    volume = PREDICATES["over"].volume(situation, (snapshot.acting, place), IDENTITY)
    low, held = situation.top(place), snapshot.arm.held
    if held is not None:
        low += max(0.0, snapshot.tool.position[2] - situation.bottom(held))
    volume = volume._replace(low=(*volume.low[:2], low + LOWEST), high=(*volume.high[:2], low + HIGHEST))
    floor = volume.floor()
    if floor is None:
        raise Failure(EMPTY_VOLUME, place)
    points = [point for _ in range(2) if (point := volume.sample(floor, search.uniform)) is not None]
    at = min(points, key=lambda point: math.dist(point[:2], base[:2]))
    if attempt >= HANDY_ATTEMPTS:
        return Pose(at, multiply(yaw_quaternion(search.uniform(-math.pi, math.pi)), DOWN))
    # The best yaw is along the arm, or turns a held object's free end towards the nearest other robot.
    grasp, towards, turn = snapshot.arm.grasp, at, 0.0
    bases = [robot_of(search.scene, name).base.position for name in search.scene.robots if name != snapshot.acting]
    if grasp is not None and bases and math.hypot(*grasp.position[:2]) >= OFF_CENTRE:
        towards = min(bases, key=lambda other: math.dist(other, at))
        # The tool points down, so its y axis is mirrored.
        turn = math.atan2(-grasp.position[1], grasp.position[0])
    yaw = math.atan2(towards[1] - base[1], towards[0] - base[0]) - turn
    return Pose(at, multiply(yaw_quaternion(yaw + search.uniform(-SPREAD, SPREAD)), DOWN))
