"""Find paths of the arm that are free of collisions, with what it holds."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from prag_asp.physics.motion.clearance import Gaps, Passing, clear, gaps
from prag_asp.physics.motion.trajectory import limits_of, timed
from prag_asp.physics.robot.kinematics import adjusted, inverse, tool_pose
from prag_asp.physics.situation import Situation
from prag_asp.physics.witness import Arm
from prag_asp.physics.world.simulator import Simulator
from prag_asp.physics.world.support import riders
from prag_asp.scene.furniture import part_pose
from prag_asp.scene.geometry import Pose, compose, invert, raised, turn_between
from prag_asp.scene.robots import Joints, Robot

HEIGHTS = (0.08, 0.16, 0.24)
STRIDE = 0.06
"""Radians between the waypoints of a way."""

LOOK = 0.02
"""How far all joints together turn between the places where a way is looked at, in radians.

No part of an arm at the table, or of what it carries, is more than 1 m from a joint's axis. So nothing moves by more
than 2 cm from one place to the next: what is `CLEARANCE` away at both does not touch in between.
"""

RUNGS = 4
SWERVE = 0.1
"""How far a joint may be from where it would be if all turned evenly on a straight way, in radians."""

PULL_RUNGS = 6
STRAIGHT = 1e-3


def grasp_of(held: str | None, *arms: Arm) -> Pose | None:
    """Return the grasp of the first of some states of an arm that hold an object, None if none does."""
    return next((arm.grasp for arm in arms if arm.held is not None and arm.held == held and arm.grasp is not None), None)


def carrying(arm: Arm, width: float, held: str | None, grasp: Pose | None) -> Arm:
    """Return an arm with the gripper open by `width` metres and an object in it; without a grasp nothing moves along."""
    return Arm(arm.joints, width, None if grasp is None else held, grasp)


def vertical(robot: Robot, one: Joints, two: Joints) -> bool:
    """Tell whether the tool is straight above or below where it is with other joint angles, turned the same way."""
    (x, y, _), turn = tool_pose(robot, one)
    (other_x, other_y, _), other_turn = tool_pose(robot, two)
    return max(abs(x - other_x), abs(y - other_y)) < STRAIGHT and turn_between(turn, other_turn) < STRAIGHT


def straight(robot: Robot, start: Joints, goal: Joints) -> list[Joints] | None:
    """Return a path on which the tool moves straight from one pose to another that is turned the same way.

    None where the joints of the arm do not let it follow the line.
    """
    first, last = tool_pose(robot, start), tool_pose(robot, goal)
    path = [start]
    for share in np.linspace(0.0, 1.0, RUNGS + 1)[1:-1].tolist():
        x, y, z = (a + share * (b - a) for a, b in zip(first.position, last.position, strict=True))
        tool = Pose((x, y, z), last.quaternion)
        near = tuple(a + share * (b - a) for a, b in zip(start, goal, strict=True))
        joints = adjusted(robot, tool, near) or next(inverse(robot, tool, near), None)
        if joints is None or max(abs(a - b) for a, b in zip(joints, near, strict=True)) > SWERVE:
            return None
        path.append(joints)
    return [*path, goal]


def pulled(robot: Robot, situation: Situation, furniture: str, grip: Pose, goal: float, start: Joints) -> list[Joints]:
    """Return a path on which the tool follows the handle of furniture from how far it is open to a goal.

    `grip` is the pose of the tool in the frame of the moving part; `goal` is in metres or radians. A pose that the arm
    does not reach is passed over.
    """
    shape, pose, begun = situation.shape(furniture), situation.pose(furniture), situation.opening(furniture)
    path = [start]
    for share in np.linspace(0.0, 1.0, PULL_RUNGS + 1)[1:].tolist():
        part = part_pose(shape, pose, begun + share * (goal - begun))
        joints = adjusted(robot, compose(part, grip), path[-1])
        if joints is not None:
            path.append(joints)
    return path


def free_path(
    simulator: Simulator, situation: Situation, arm: Arm, goal: Joints, time_step: float
) -> NDArray[np.float64] | None:
    """Return the joint angles of every time step on a free way, shape (steps, 7); None where none is found."""
    for path in _ways(simulator, arm.joints, goal):
        angles = timed(path, time_step, limits_of(simulator.robot, loaded=arm.held is not None))
        if _free(simulator, situation, arm, np.concatenate([[arm.joints], angles])):
            return angles
    return None


def checked_path(
    simulator: Simulator, situation: Situation, arm: Arm, goal: Joints, time_step: float
) -> tuple[Joints, ...] | None:
    """Return joint angles on a free way, each a stride after the last; None where none is found.

    The ends are left out, and joints turn evenly from each to the next. Straight up and down there is one way only.
    """
    start = arm.joints
    if vertical(simulator.robot, start, goal):
        path = straight(simulator.robot, start, goal)
        return tuple(path[1:-1]) if path is not None and _free(simulator, situation, arm, np.array(path)) else None
    for around in _ways(simulator, start, goal):
        angles = timed(around, time_step, limits_of(simulator.robot, loaded=arm.held is not None))
        way = tuple(_strides(start, angles))
        if _free(simulator, situation, arm, np.array([start, *way, goal])):
            return way
    return None


def _ways(simulator: Simulator, start: Joints, goal: Joints) -> Iterator[Sequence[Joints]]:
    """Yield paths to try, the shortest first: direct, then over what stands around."""
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
    """Return joint angles near to others with the tool higher, None where there are none."""
    return next(inverse(simulator.robot, raised(tool_pose(simulator.robot, joints), height), near=joints), None)


def _free(simulator: Simulator, situation: Situation, arm: Arm, path: NDArray[np.float64]) -> bool:
    """Tell whether the arm and what it holds keep clear of all else on a path, shape (points, 7), its ends left out."""
    carried = _carried(situation, arm)
    start, *between, goal = _looked_at(path)
    first, last = (gaps(simulator, _passing(simulator, situation, arm, carried, end)) for end in (start, goal))
    found: list[Gaps] = []
    for joints in between:
        here = gaps(simulator, _passing(simulator, situation, arm, carried, joints))
        if here.keys() - first.keys() - last.keys():
            return False
        found.append(here)
    return clear(first, found, last)


def _looked_at(path: NDArray[np.float64]) -> list[Joints]:
    """Return joint angles on a path, shape (points, 7), in which all joints together turn by `LOOK`; two at least."""
    reached = np.concatenate([[0.0], np.cumsum(np.abs(np.diff(path, axis=0)).sum(axis=1))])
    places = np.linspace(0.0, reached[-1], math.ceil(reached[-1] / LOOK) + 1) if reached[-1] > 0.0 else np.zeros(2)
    rows = np.column_stack([np.interp(places, reached, column) for column in path.T]).tolist()
    return [tuple(path[0].tolist()), *map(tuple, rows[1:-1]), tuple(path[-1].tolist())]


def _strides(start: Joints, angles: NDArray[np.float64]) -> Iterator[Joints]:
    """Yield joint angles of a way, a stride apart, without its ends."""
    before, last = np.array(start), angles[-1]
    for row in angles:
        if np.abs(row - before).max() >= STRIDE:
            if np.abs(row - last).max() < STRIDE / 2:
                return
            before = row
            yield tuple(row.tolist())


def _carried(situation: Situation, arm: Arm) -> list[str]:
    """Return what moves with the gripper: what it holds, and what rests on that."""
    held = arm.held
    return [] if held is None else [held, *riders(situation, held, [each for each in situation.poses if each != held])]


def _passing(simulator: Simulator, situation: Situation, arm: Arm, carried: Sequence[str], joints: Joints) -> Passing:
    """Return where everything is with the arm at joint angles."""
    if arm.held is not None and arm.grasp is not None:
        delta = compose(compose(tool_pose(simulator.robot, joints), arm.grasp), invert(situation.poses[arm.held]))
        moved = {entity: compose(delta, situation.poses[entity]) for entity in carried}
        situation = situation.with_poses({**situation.poses, **moved})
    return Passing(situation, Arm(joints, arm.width, arm.held), carried)
