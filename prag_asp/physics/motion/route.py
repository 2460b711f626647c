"""Find collision-free paths for the arm and its load."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from prag_asp.physics.motion.clearance import ArmPassage, Gaps, gaps, keeps_clear
from prag_asp.physics.motion.trajectory import joint_limits, time_path
from prag_asp.physics.robot.kinematics import adjust_joints, inverse, tool_pose
from prag_asp.physics.situation import Situation
from prag_asp.physics.witness import Arm
from prag_asp.physics.world.simulator import Simulator
from prag_asp.physics.world.support import riders
from prag_asp.scene.furniture import part_pose
from prag_asp.scene.geometry import IDENTITY, Pose, compose, invert, raised, turn_between
from prag_asp.scene.robots import Joints, Robot

HEIGHTS = (0.08, 0.16, 0.24)
STRIDE = 0.06
"""The distance between two waypoints of a path, in radians."""

LOOK = 0.02
"""The sum of all joint motions between two points at which a path is checked, in radians.

No part of an arm at the table, or of its load, is more than 1 m from a joint's axis. Therefore nothing moves by more
than 2 cm between two points, so bodies that are `CLEARANCE` apart at both points do not touch in between.
"""

RUNGS = 4
SWERVE = 0.1
"""The largest deviation of a joint from a linear motion, in radians, when the tool moves along a straight path."""

PULL_RUNGS = 6
STRAIGHT = 1e-3


def grasp_of(held: str | None, *arms: Arm) -> Pose | None:
    """Return the grasp of the first arm state that holds an object, or None if no state does."""
    return next(
        (arm.grasp for arm in arms if arm.held is not None and arm.held == held and arm.grasp is not None), None
    )


def carry_object(arm: Arm, width: float, held: str | None, grasp: Pose | None) -> Arm:
    """Return an arm with a gripper opening in metres and a held object, or no object if the grasp is unknown."""
    return Arm(arm.joints, width, None if grasp is None else held, grasp)


def is_vertical(robot: Robot, one: Joints, two: Joints) -> bool:
    """Return whether the tool poses of two configurations are directly above each other with the same orientation."""
    (x, y, _), turn = tool_pose(robot, one)
    (other_x, other_y, _), other_turn = tool_pose(robot, two)
    return max(abs(x - other_x), abs(y - other_y)) < STRAIGHT and turn_between(turn, other_turn) < STRAIGHT


def is_straight(robot: Robot, one: Joints, two: Joints) -> bool:
    """Return whether `is_vertical` holds for two configurations, or their tools are aligned along the fingers."""
    if is_vertical(robot, one, two):
        return True
    offset, turn = compose(invert(tool_pose(robot, one)), tool_pose(robot, two))
    return max(abs(offset[0]), abs(offset[1])) < STRAIGHT and turn_between(turn, IDENTITY) < STRAIGHT


def straight_path(robot: Robot, start: Joints, goal: Joints) -> list[Joints] | None:
    """Return a path on which the tool moves in a straight line between poses of the same orientation.

    The result is None if the arm cannot follow the line.
    """
    first, last = tool_pose(robot, start), tool_pose(robot, goal)
    path = [start]
    for share in np.linspace(0.0, 1.0, RUNGS + 1)[1:-1].tolist():
        x, y, z = (a + share * (b - a) for a, b in zip(first.position, last.position, strict=True))
        tool = Pose((x, y, z), last.quaternion)
        near = tuple(a + share * (b - a) for a, b in zip(start, goal, strict=True))
        joints = adjust_joints(robot, tool, near) or next(inverse(robot, tool, near), None)
        if joints is None or max(abs(a - b) for a, b in zip(joints, near, strict=True)) > SWERVE:
            return None
        path.append(joints)
    return [*path, goal]


def pull_path(
    robot: Robot, situation: Situation, furniture: str, grip: Pose, goal: float, start: Joints
) -> list[Joints]:
    """Return a path on which the tool follows the handle of furniture from its current opening to a goal.

    `grip` is the pose of the tool in the frame of the moving part; `goal` is in metres or radians. Poses that the arm
    cannot reach are skipped.
    """
    shape, pose, begun = situation.shape(furniture), situation.pose(furniture), situation.opening(furniture)
    path = [start]
    for share in np.linspace(0.0, 1.0, PULL_RUNGS + 1)[1:].tolist():
        part = part_pose(shape, pose, begun + share * (goal - begun))
        joints = adjust_joints(robot, compose(part, grip), path[-1])
        if joints is not None:
            path.append(joints)
    return path


def free_path(
    simulator: Simulator, situation: Situation, arm: Arm, goal: Joints, time_step: float
) -> NDArray[np.float64] | None:
    """Return a collision-free path from the state of the arm to a goal, one row per time step, shape (steps, 7).

    The result is None if no path is found.
    """
    for path in _candidate_paths(simulator, arm.joints, goal):
        angles = time_path(path, time_step, joint_limits(simulator.robot, loaded=arm.held is not None))
        if _is_free(simulator, situation, arm, np.concatenate([[arm.joints], angles])):
            return angles
    return None


def checked_path(
    simulator: Simulator, situation: Situation, arm: Arm, goal: Joints, time_step: float
) -> tuple[Joints, ...] | None:
    """Return waypoints, a stride apart, of a collision-free path from the state of the arm to a goal.

    The ends are omitted, and joints move linearly between waypoints. If the ends are in line with each other, only the
    straight path is tried. The result is None if no path is found.
    """
    start = arm.joints
    if is_straight(simulator.robot, start, goal):
        path = straight_path(simulator.robot, start, goal)
        return tuple(path[1:-1]) if path is not None and _is_free(simulator, situation, arm, np.array(path)) else None
    for around in _candidate_paths(simulator, start, goal):
        angles = time_path(around, time_step, joint_limits(simulator.robot, loaded=arm.held is not None))
        before, strides = np.array(start), list[Joints]()
        for row in angles:
            if np.abs(row - before).max() >= STRIDE:
                if np.abs(row - angles[-1]).max() < STRIDE / 2:
                    break
                before = row
                strides.append(tuple(row.tolist()))
        way = tuple(strides)
        if _is_free(simulator, situation, arm, np.array([start, *way, goal])):
            return way
    return None


def _candidate_paths(simulator: Simulator, start: Joints, goal: Joints) -> Iterator[Sequence[Joints]]:
    """Yield candidate paths, shortest first: direct ones, then ones over nearby objects."""
    yield start, goal
    for height in HEIGHTS:
        over_start, over_goal = _above(simulator, start, height), _above(simulator, goal, height)
        if over_start is not None and over_goal is not None:
            yield start, over_start, over_goal, goal
        if over_start is not None:
            yield start, over_start, goal
        if over_goal is not None:
            yield start, over_goal, goal
    folded = simulator.robot.home[1:]
    yield start, (start[0], *folded), (goal[0], *folded), goal


def _above(simulator: Simulator, joints: Joints, height: float) -> Joints | None:
    """Return a nearby configuration in which the tool is higher, or None if there is none."""
    return next(inverse(simulator.robot, raised(tool_pose(simulator.robot, joints), height), near=joints), None)


def _is_free(simulator: Simulator, situation: Situation, arm: Arm, path: NDArray[np.float64]) -> bool:
    """Return whether the arm and its load keep clear on a path, shape (points, 7), except at its ends."""
    held, grasp, poses = arm.held, arm.grasp, situation.poses
    carried = [] if held is None else [held, *riders(situation, held, [each for each in poses if each != held])]

    def gaps_at(joints: Joints) -> Gaps:
        there = situation
        if held is not None and grasp is not None:
            delta = compose(compose(tool_pose(simulator.robot, joints), grasp), invert(poses[held]))
            there = situation.with_poses({**poses, **{entity: compose(delta, poses[entity]) for entity in carried}})
        return gaps(simulator, ArmPassage(there, Arm(joints, arm.width, held), carried))

    # Between two checked points, the joint motions add up to at most `LOOK`.
    reached = np.concatenate([[0.0], np.cumsum(np.abs(np.diff(path, axis=0)).sum(axis=1))])
    places = np.linspace(0.0, reached[-1], math.ceil(reached[-1] / LOOK) + 1)
    rows = np.column_stack([np.interp(places, reached, column) for column in path.T]).tolist()
    first, last = gaps_at(tuple(path[0].tolist())), gaps_at(tuple(path[-1].tolist()))
    gaps_so_far: list[Gaps] = []
    for row in rows[1:-1]:
        here = gaps_at(tuple(row))
        if here.keys() - first.keys() - last.keys():
            return False
        gaps_so_far.append(here)
    return keeps_clear(first, gaps_so_far, last)
