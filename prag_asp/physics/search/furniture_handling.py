"""Open and close furniture: the gripper grasps the handle and follows the line or arc of its motion."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import replace

from prag_asp.physics.predicates import Volume
from prag_asp.physics.predicates.opening import IS_CLOSED, IS_OPEN
from prag_asp.physics.robot.kinematics import adjust_joints, inverse, tool_pose
from prag_asp.physics.search.attempt import (
    EMPTY_VOLUME,
    NO_GRASP,
    NO_KINEMATICS_ABOVE,
    NO_KINEMATICS_AT,
    OBJECTS_COLLIDE,
    UNSUPPORTED,
    Failure,
    Search,
    Snapshot,
)
from prag_asp.physics.search.grasping import DOWN, CollisionQuery, raise_joints, require_clear
from prag_asp.physics.situation import Situation
from prag_asp.physics.symbolic_facts import Fact
from prag_asp.physics.witness import Arm, Waypoint
from prag_asp.physics.world.collisions import colliding
from prag_asp.physics.world.support import riders, unsupported
from prag_asp.scene.furniture import POST, mechanism, part_pose
from prag_asp.scene.geometry import IDENTITY, Pose, compose, invert, multiply, wrap, yaw_of, yaw_quaternion
from prag_asp.scene.robots import Joints

SLIDE_STRIDE, TURN_STRIDE = 0.05, 0.2
"""The motion of furniture between two checks, in metres for a drawer and in radians for a door."""

POST_WIDTH = 2 * POST
ENDS = (IS_OPEN, IS_CLOSED)
"""The states that furniture may have if nothing is known about it."""


def sample_openings(search: Search, situation: Situation, facts: Iterable[Fact]) -> dict[str, float]:
    """Return random openings that the facts allow for all furniture in a situation, in metres or radians."""
    all_facts = list(facts)
    furniture = [entity for entity in situation.poses if situation.shape(entity).traits.furniture]
    return {entity: sample_opening(search, situation, entity, all_facts) for entity in furniture}


def sample_opening(search: Search, situation: Situation, furniture: str, facts: Iterable[Fact]) -> float:
    """Return a random opening of furniture that facts allow, in metres or radians; without facts, one of `ENDS`.

    Raises:
        Failure: the facts allow no opening.
    """
    volumes = [
        fact.predicate.volume if fact.value else fact.predicate.otherwise
        for fact in facts
        if fact.predicate.of_joint and fact.arguments[0] == furniture
    ]
    allowed = Volume()
    for volume in volumes or [ENDS[int(search.rng.integers(len(ENDS)))].volume]:
        if volume is not None:
            allowed = allowed.meet(volume(situation, (furniture,), IDENTITY))
    if allowed.empty:
        raise Failure(EMPTY_VOLUME, furniture)
    return search.uniform(*allowed.opening)


def turn(search: Search, snapshot: Snapshot, furniture: str, facts: Iterable[Fact], attempt: int) -> Snapshot:
    """Open or close furniture as facts require, release it, and retreat straight up.

    Raises:
        Failure: the gripper holds an object, or cannot move the furniture.
    """
    if snapshot.arm.held is not None:
        raise Failure(NO_GRASP, snapshot.arm.held)
    situation = snapshot.situation
    goal = sample_opening(search, situation, furniture, facts)
    begun, shape = situation.opening(furniture), situation.shape(furniture)
    handle, slides = mechanism(shape).handle, mechanism(shape).slides
    # Grips are in the frame of the moving part; the easiest one faces the robot when the part is halfway open.
    halfway = part_pose(shape, situation.pose(furniture), (begun + goal) / 2)
    x, y, _ = compose(halfway, Pose(handle)).position
    base_x, base_y, _ = search.robot.base.position
    heading = math.atan2(y - base_y, x - base_x) - yaw_of(halfway.quaternion)
    turns = (0.0, math.pi) if slides else (0.0, math.pi / 2, math.pi, -math.pi / 2)
    yaw = sorted(turns, key=lambda angle: abs(wrap(angle - heading)))[attempt % len(turns)]
    grip = Pose(handle, multiply(yaw_quaternion(yaw), DOWN))
    steps = max(1, math.ceil(abs(goal - begun) / (SLIDE_STRIDE if slides else TURN_STRIDE)))
    openings = [begun + (goal - begun) * i / steps for i in range(steps + 1)]
    failed = Failure(NO_KINEMATICS_AT, furniture)
    for low in inverse(search.robot, compose(situation.part(furniture), grip)):
        try:
            return _pull(search, snapshot, furniture, openings, grip, low)
        except Failure as failure:
            failed = failure
    raise failed


def open_furniture(situation: Situation, furniture: str, opening: float, objects: Iterable[str]) -> Situation:
    """Return a situation in which furniture has a different opening; the contents of a drawer move with it."""
    after = situation.with_opening(furniture, opening)
    if not mechanism(situation.shape(furniture)).slides:
        return after
    delta = compose(after.part(furniture), invert(situation.part(furniture)))
    within = riders(situation, furniture, [other for other in objects if other != furniture])
    rider_poses = {rider: compose(delta, situation.poses[rider]) for rider in within}
    return after.with_poses({**situation.poses, **rider_poses})


def _pull(
    search: Search, snapshot: Snapshot, furniture: str, openings: Sequence[float], grip: Pose, low: Joints
) -> Snapshot:
    """Return a snapshot after furniture has moved through openings, in metres or radians.

    `grip` is the tool pose in the frame of the moving part, and `low` is the joint configuration at the handle.

    Raises:
        Failure: the arm cannot reach the handle, follow it, or retreat.
    """
    situation, acting, opening = snapshot.situation, snapshot.acting, search.robot.opening
    shape, pose = situation.shape(furniture), situation.pose(furniture)
    waypoints = [
        Waypoint("approach", acting, _above(search, situation, low, furniture), opening),
        Waypoint("at", acting, low, opening),
        Waypoint("at", acting, low, POST_WIDTH, furniture, openings[0]),
    ]
    within = riders(situation, furniture, [other for other in search.objects if other != furniture])
    joints, opened = low, situation
    for at in openings[1:]:
        near = adjust_joints(search.robot, compose(part_pose(shape, pose, at), grip), joints)
        if near is None:
            raise Failure(NO_KINEMATICS_AT, furniture)
        opened = open_furniture(situation, furniture, at, search.objects)
        pair = colliding(search.simulator, opened, [furniture, *within], search.objects)
        if pair is not None:
            raise Failure(OBJECTS_COLLIDE, *pair)
        require_clear(search, near, CollisionQuery(opened, POST_WIDTH, furniture))
        joints = near
        waypoints.append(Waypoint("pull", acting, joints, POST_WIDTH, furniture, at))
    falling = unsupported(opened, search.objects)
    if falling is not None:
        raise Failure(UNSUPPORTED, falling)
    above = _above(search, opened, joints, furniture)
    waypoints.append(Waypoint("at", acting, joints, opening))
    after = replace(snapshot, situation=opened, waypoints=(*snapshot.waypoints, *waypoints))
    return after.with_arm(Arm(above, opening)).with_waypoint("retreat")


def _above(search: Search, situation: Situation, low: Joints, furniture: str) -> Joints:
    """Return a collision-free joint configuration with the open gripper straight above its pose at a handle.

    Raises:
        Failure: there is no such configuration, or the arm collides at the handle.
    """
    query = CollisionQuery(situation, search.robot.opening, furniture)
    require_clear(search, low, query)
    high = raise_joints(search, low, tool_pose(search.robot, low), query)
    if high is None:
        raise Failure(NO_KINEMATICS_ABOVE, furniture)
    return high
