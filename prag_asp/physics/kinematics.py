"""Forward and inverse kinematics of the panda, every answer verified.

The solution is the analytic one of He and Liu ("Analytical inverse kinematics for Franka Emika Panda", 2021),
which fixes joint 7 and finds up to four configurations. Joint 7 is swept lazily: first where it would be if the
arm bent in one plane (or stayed as it is), then coarsely over its range, and finely where that finds nothing.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from functools import lru_cache

import frankik
import numpy as np
from numpy.typing import NDArray

from prag_asp.physics.geometry import Pose, Quaternion, compose, matrix, wrap, yaw_of, yaw_quaternion
from prag_asp.physics.robot import Joints, Robot

ACCURACY = 1e-5
AROUND = (0.0, 0.25, -0.25)
COARSE = tuple(np.linspace(-2.8, 2.8, 13).tolist())
FINE = tuple(np.linspace(-2.8, 2.8, 49).tolist())
NARROW = tuple(np.linspace(-0.4, 0.4, 9).tolist())
POSTURE_WEIGHTS = (1.0, 1.0, 1.5, 1.0, 1.0, 0.7, 0.3)
EVEN_WEIGHTS = (1.0,) * 7
APART = 0.4
MAX_SOLUTIONS = 4

Rows = tuple[tuple[float, ...], ...]


@lru_cache(maxsize=1 << 8)
def tool_matrix(joints: Joints) -> Rows:
    """Return the pose of the tool as the rows of a homogeneous matrix."""
    return tuple(map(tuple, frankik.fk(np.array(joints)).tolist()))


def tool_pose(joints: Joints) -> Pose:
    """Return the pose of the tool."""
    rows = tool_matrix(joints)
    return Pose((rows[0][3], rows[1][3], rows[2][3]), _quaternion(rows))


def inverse(robot: Robot, tool: Pose, near: Joints | None = None) -> Iterator[Joints]:
    """Yield joint vectors that bring the tool to a pose, at most `MAX_SOLUTIONS`, good ones first.

    They are near `near`, or near the robot's posture turned towards the target. Each is within the limits,
    and forward kinematics puts it within 0.01 mm of the target. Nothing is yielded where nothing is found.
    """
    target = matrix(tool)
    flange = matrix(compose(tool, _from_tool(robot)))
    goal = target.tolist()
    start = _facing(robot, tool) if near is None else near
    found: list[Joints] = []
    for angles in _sweeps(robot, tool, near):
        if angles is FINE and found:
            return
        for joints in _ranked(robot, flange, start, angles, POSTURE_WEIGHTS if near is None else EVEN_WEIGHTS):
            if any(math.dist(joints, other) < APART for other in found):
                continue
            if _error(tool_matrix(joints), goal) < ACCURACY:
                found.append(joints)
                yield joints
                if len(found) == MAX_SOLUTIONS:
                    return


def _sweeps(robot: Robot, tool: Pose, near: Joints | None) -> Iterator[tuple[float, ...]]:
    """Yield the angles of joint 7 to try, the most promising first."""
    if near is not None:
        yield (near[6],)
        yield tuple(near[6] + angle for angle in NARROW)
    else:
        # With joints 3 and 5 at 0 the arm bends in a plane, and joint 7 alone turns the tool away from it.
        heading = math.atan2(tool.position[1], tool.position[0])
        planar = wrap(robot.posture[6] + heading - yaw_of(tool.quaternion))
        yield tuple(min(max(planar + angle, robot.lower[6]), robot.upper[6]) for angle in AROUND)
        yield COARSE
    yield FINE


def _ranked(
    robot: Robot,
    flange: NDArray[np.float64],
    start: Joints,
    angles: tuple[float, ...],
    weights: tuple[float, ...],
) -> list[Joints]:
    """Return the solutions within the limits for some angles of joint 7, nearest to `start` first."""
    actual = np.array(start)
    found = []
    for angle in angles:
        for row in frankik.ik_full(flange, actual, angle).tolist():
            # A branch without a solution is NaN, which no comparison lets through.
            if robot.within_limits(row):
                parts = zip(row, start, weights, strict=True)
                found.append((sum(((a - b) * weight) ** 2 for a, b, weight in parts), tuple(row)))
    return [joints for _, joints in sorted(found)]


def _error(rows: Rows, goal: list[list[float]]) -> float:
    """Return the largest difference of two homogeneous matrices."""
    return max(abs(a - b) for row, other in zip(rows[:3], goal, strict=False) for a, b in zip(row, other, strict=True))


def _facing(robot: Robot, tool: Pose) -> Joints:
    """Return the robot's posture turned towards a target."""
    heading = math.atan2(tool.position[1], tool.position[0])
    return (heading, *robot.posture[1:])


def _from_tool(robot: Robot) -> Pose:
    """Return the pose of the flange in the frame of the tool."""
    return Pose((0.0, 0.0, -robot.tool_offset), yaw_quaternion(-robot.tool_turn))


def _quaternion(r: Rows) -> Quaternion:
    """Return the unit quaternion of the rotation in a homogeneous matrix, by Shepperd's method."""
    (a, b, c, _), (d, e, f, _), (g, h, i, _) = r[:3]
    squares = (1 + a - e - i, 1 - a + e - i, 1 - a - e + i, 1 + a + e + i)
    largest = squares.index(max(squares))
    x, y, z, w = (
        (squares[0], b + d, c + g, h - f),
        (b + d, squares[1], f + h, c - g),
        (c + g, f + h, squares[2], d - b),
        (h - f, c - g, d - b, squares[3]),
    )[largest]
    length = math.hypot(x, y, z, w)
    return (x / length, y / length, z / length, w / length)
