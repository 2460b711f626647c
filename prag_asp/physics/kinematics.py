"""Forward and inverse kinematics of the panda, every answer verified.

The solution is the analytic one of He and Liu ("Analytical inverse kinematics for Franka Emika Panda", 2021),
which fixes joint 7 and finds up to four configurations; joint 7 is swept over its range.
"""

from __future__ import annotations

import math
from functools import cache

import frankik
import numpy as np
from numpy.typing import NDArray

from prag_asp.physics.geometry import Pose, matrix
from prag_asp.physics.robot import Joints, Robot

ACCURACY = 1e-5
COARSE = tuple(np.linspace(-2.8, 2.8, 13).tolist())
FINE = tuple(np.linspace(-2.8, 2.8, 49).tolist())
NARROW = tuple(np.linspace(-0.4, 0.4, 9).tolist())
WEIGHTS = np.array([1.0, 1.0, 1.5, 1.0, 1.0, 0.7, 0.3])
MAX_SOLUTIONS = 4


def tool_matrix(joints: Joints) -> NDArray[np.float64]:
    """Return the pose of the tool as a homogeneous matrix, shape (4, 4)."""
    result: NDArray[np.float64] = frankik.fk(np.asarray(joints, dtype=float))
    return result


def tool_pose(joints: Joints) -> Pose:
    """Return the pose of the tool."""
    found = tool_matrix(joints)
    return Pose((float(found[0, 3]), float(found[1, 3]), float(found[2, 3])), _quaternion(found))


def inverse(robot: Robot, tool: Pose, near: Joints | None = None) -> list[Joints]:
    """Return joint vectors that bring the tool to a pose, at most `MAX_SOLUTIONS`, best first.

    They are near `near`, or near the robot's posture turned towards the target. Each is within the limits,
    and forward kinematics puts it within 0.01 mm of the target. The list is empty where nothing is found.
    """
    target = matrix(tool)
    flange = target @ _from_tool(robot)
    start = np.asarray(near if near is not None else _facing(robot, tool))
    angles = COARSE if near is None else tuple(near[6] + angle for angle in NARROW)
    found = _sweep(robot, flange, start, angles)
    if not len(found):
        found = _sweep(robot, flange, start, FINE)
    weights = WEIGHTS if near is None else 1.0
    order = np.argsort((((found - start) * weights) ** 2).sum(axis=1), kind="stable")
    solutions: list[Joints] = []
    for row in found[order]:
        joints = tuple(row.tolist())
        if len(solutions) == MAX_SOLUTIONS:
            break
        if any(math.dist(joints, other) < 0.4 for other in solutions):
            continue
        if float(np.abs(tool_matrix(joints) - target).max()) < ACCURACY:
            solutions.append(joints)
    return solutions


def _sweep(
    robot: Robot, flange: NDArray[np.float64], start: NDArray[np.float64], angles: tuple[float, ...]
) -> NDArray[np.float64]:
    """Return the solutions within the limits for some angles of joint 7, shape (solutions, 7)."""
    found = np.concatenate([frankik.ik_full(flange, start, angle) for angle in angles])
    lower, upper = _limits(robot)
    within = np.all((found >= lower) & (found <= upper), axis=1)
    return found[within]  # a branch without a solution is NaN, which no comparison lets through


def _facing(robot: Robot, tool: Pose) -> Joints:
    """Return the robot's posture turned towards a target."""
    heading = math.atan2(tool.position[1], tool.position[0])
    return (heading, *robot.posture[1:])


@cache
def _limits(robot: Robot) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the limits of the joints in radians, each of shape (7,)."""
    return np.array(robot.lower), np.array(robot.upper)


@cache
def _from_tool(robot: Robot) -> NDArray[np.float64]:
    """Return the pose of the flange in the frame of the tool, shape (4, 4)."""
    cosine, sine = math.cos(robot.tool_turn), math.sin(robot.tool_turn)
    result = np.eye(4)
    result[:2, :2] = [[cosine, sine], [-sine, cosine]]
    result[2, 3] = -robot.tool_offset
    return result


def _quaternion(rotation: NDArray[np.float64]) -> tuple[float, float, float, float]:
    """Return the unit quaternion of the rotation in a homogeneous matrix, by Shepperd's method."""
    r = rotation[:3, :3]
    squares = [1 + r[0, 0] - r[1, 1] - r[2, 2], 1 - r[0, 0] + r[1, 1] - r[2, 2]]
    squares += [1 - r[0, 0] - r[1, 1] + r[2, 2], 1 + r[0, 0] + r[1, 1] + r[2, 2]]
    largest = int(np.argmax(squares))
    rows = [
        [squares[0], r[0, 1] + r[1, 0], r[0, 2] + r[2, 0], r[2, 1] - r[1, 2]],
        [r[0, 1] + r[1, 0], squares[1], r[1, 2] + r[2, 1], r[0, 2] - r[2, 0]],
        [r[0, 2] + r[2, 0], r[1, 2] + r[2, 1], squares[2], r[1, 0] - r[0, 1]],
        [r[2, 1] - r[1, 2], r[0, 2] - r[2, 0], r[1, 0] - r[0, 1], squares[3]],
    ]
    values = np.array(rows[largest], dtype=float)
    x, y, z, w = (values / np.linalg.norm(values)).tolist()
    return (x, y, z, w)
