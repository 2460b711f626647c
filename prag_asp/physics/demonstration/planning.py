"""Plan the paths of an arm between the waypoints of a witness from the actual poses of the objects.

The robot knows where the objects are: it grasps an object as in the witness, but at the object's actual pose, and
places the object at its pose in the witness, whatever the actual grasp is. Small errors therefore do not accumulate.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from prag_asp.physics.motion.carried_motion import MOST, bearable_acceleration, time_carried
from prag_asp.physics.motion.route import (
    carry_object,
    free_path,
    grasp_of,
    is_straight,
    is_vertical,
    pull_path,
    straight_path,
)
from prag_asp.physics.motion.trajectory import joint_limits, time_path
from prag_asp.physics.robot.kinematics import adjust_joints, tool_pose
from prag_asp.physics.situation import Situation
from prag_asp.physics.symbolic_facts import ActionEffect
from prag_asp.physics.witness import TRANSIT, Arm, Moment, Waypoint
from prag_asp.physics.world.simulator import Simulator
from prag_asp.physics.world.time_step import TIME_STEP
from prag_asp.scene.geometry import Pose, compose, invert, multiply, raised, rotate, wrap, yaw_of, yaw_quaternion
from prag_asp.scene.robots import Joints, Robot

Angles = NDArray[np.float64]
LARGEST_TURN = 0.3


@dataclass(frozen=True)
class Action:
    """An action of a witness: its effect, the moments before and after the action, and the waypoints between them."""

    effect: ActionEffect
    before: Moment
    after: Moment
    motion: tuple[Waypoint, ...]


@dataclass(frozen=True)
class Leg:
    """A part of an action: a waypoint, the transit path to it in the witness, and the object that the arm approaches.

    `start` contains the joint angles of the arm in the witness when the leg begins.
    """

    waypoint: Waypoint
    start: Joints
    way: tuple[Joints, ...]
    target: str | None


def action_legs(action: Action) -> Iterator[Leg]:
    """Yield the legs of an action."""
    way: list[Joints] = []
    planned = {name: arm.joints for name, arm in action.before.arms.items()}
    for i, waypoint in enumerate(action.motion):
        if waypoint.name == TRANSIT:
            way.append(waypoint.joints)
            continue
        ahead = (each.held for each in action.motion[i:] if each.robot == waypoint.robot)
        yield Leg(waypoint, planned[waypoint.robot], tuple(way), next(filter(None, ahead), action.effect.visits))
        planned[waypoint.robot], way = waypoint.joints, []


def plan_path(planner: Simulator, situation: Situation, arm: Arm, leg: Leg, action: Action) -> Angles | None:
    """Return the joint angles at every time step on a path, shape (steps, 7), or None if no free path is found.

    The path is a straight one (up, down or along the fingers), the path in the witness, or another free path; heavy
    objects are accelerated less. `situation` is the actual situation, and `arm` holds the targets of the motors.
    """
    robot, waypoint = planner.robot, leg.waypoint
    most = MOST if arm.held is None else bearable_acceleration(situation.scene, arm.held, waypoint.robot)
    if is_straight(robot, leg.start, waypoint.joints):
        tool = _moved_on(planner.robot, leg, arm.joints)
        goal = adjust_joints(robot, tool, waypoint.joints) or waypoint.joints
        line = straight_path(robot, arm.joints, goal)
        if line is not None or is_vertical(robot, leg.start, waypoint.joints):
            return time_carried(robot, line or [arm.joints, goal], TIME_STEP, joint_limits(robot), most)
    tool = _corrected(leg, tool_pose(robot, waypoint.joints), situation, action)
    goal = adjust_joints(robot, tool, waypoint.joints) or waypoint.joints
    if leg.way:
        # The path in the witness, shifted by the interpolated differences between its ends and the actual ends.
        first, last = np.subtract(arm.joints, leg.start), np.subtract(goal, waypoint.joints)
        shares = np.linspace(0.0, 1.0, len(leg.way) + 2)[1:-1, None]
        between = np.array(leg.way) + (1 - shares) * first + shares * last
        path = [arm.joints, *map(tuple, between.tolist()), goal]
        return time_carried(robot, path, TIME_STEP, joint_limits(robot, loaded=arm.held is not None), most)
    grasp = _measured_grasp(situation, waypoint.robot, arm.held)
    loaded = carry_object(arm, situation.arm(waypoint.robot).width, arm.held, grasp)
    found = free_path(planner, situation, loaded, goal, TIME_STEP)
    if found is None or most >= MOST:
        return found
    path = [arm.joints, *map(tuple, found.tolist())]
    return time_carried(robot, path, TIME_STEP, joint_limits(robot, loaded=True), most)


def _moved_on(robot: Robot, leg: Leg, joints: Joints) -> Pose:
    """Return the pose of a tool after the straight motion of a leg: up, down or along the fingers."""
    first, last, now = (tool_pose(robot, each) for each in (leg.start, leg.waypoint.joints, joints))
    if is_vertical(robot, leg.start, leg.waypoint.joints):
        return raised(now, last.position[2] - first.position[2])
    return compose(now, Pose((0.0, 0.0, compose(invert(first), last).position[2])))


def plan_pull(planner: Simulator, situation: Situation, arm: Arm, furniture: str, opening: float) -> Angles:
    """Return the joint angles, shape (steps, 7), at every time step of a motion that moves furniture to an opening.

    `opening` is in metres or radians.
    """
    grip = compose(invert(situation.part(furniture)), tool_pose(planner.robot, arm.joints))
    path = pull_path(planner.robot, situation, furniture, grip, opening, arm.joints)
    return time_path(path, TIME_STEP, joint_limits(planner.robot, loaded=True))


def _measured_grasp(situation: Situation, robot: str, held: str | None) -> Pose | None:
    """Return the actual grasp of the object that a gripper holds in a situation, or None if it holds no object."""
    return None if held is None else compose(invert(situation.tool(robot)), situation.poses[held])


def _corrected(leg: Leg, planned: Pose, situation: Situation, action: Action) -> Pose:
    """Return the tool pose `planned` in the witness, corrected for the actual poses of objects.

    A held object is moved to its pose in the witness; a free tool is moved to its pose in the witness relative to the
    object that it approaches.
    """
    waypoint, before = leg.waypoint, action.before
    arms = (moment.arms[waypoint.robot] for moment in (before, action.after))
    grasp, measured = grasp_of(waypoint.held, *arms), _measured_grasp(situation, waypoint.robot, waypoint.held)
    if grasp is not None and measured is not None:
        turn = _turn(compose(planned, measured), compose(planned, grasp))
        quaternion = multiply(turn, planned.quaternion)
        x, y, z = compose(planned, grasp).position
        dx, dy, dz = rotate(quaternion, measured.position)
        return Pose((x - dx, y - dy, z - dz), quaternion)
    if leg.target is None:
        return planned
    there = Situation(situation.scene, before.poses, openings=before.openings).part(leg.target)
    here = situation.part(leg.target)
    round_body = situation.shape(leg.target).traits.round
    turn = yaw_quaternion(0.0) if round_body else _turn(there, here)
    (x, y, z), (tx, ty, tz) = planned.position, there.position
    offset = rotate(turn, (x - tx, y - ty, z - tz))
    x, y, z = (a + b for a, b in zip(here.position, offset, strict=True))
    return Pose((x, y, z), multiply(turn, planned.quaternion))


def _turn(one: Pose, two: Pose) -> tuple[float, float, float, float]:
    """Return the rotation about z that gives one pose the heading of another, or the identity if the turn is large."""
    angle = wrap(yaw_of(two.quaternion) - yaw_of(one.quaternion))
    return yaw_quaternion(angle if abs(angle) < LARGEST_TURN else 0.0)
