"""Forward and inverse kinematics of the robots; every solution is verified.

Each robot's inverse kinematics is closed-form except for one redundant angle, which is swept lazily: first around its
value for an arm bent in one plane (or around its current value), then coarsely over its whole range, and then finely if
the coarse sweep finds nothing.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from functools import cache, lru_cache
from operator import mul

import numpy as np
from numpy.typing import NDArray

from prag_asp.scene.geometry import Pose, Quaternion, compose, invert, matrix, rows, yaw_quaternion
from prag_asp.scene.robots import Joints, Robot
from prag_asp.scene.robots.robot import ORIGIN

ACCURACY = 1e-5  # metres, and radians; in metres, a hundredth of a millimetre
APART = 0.4  # radians: how far apart joint configurations have to be to count as different
ADJUSTMENTS, DIFFERENCE, DAMPING = 12, 1e-5, 1e-6
DIFFERENCES = DIFFERENCE * np.eye(7)
BELOW, ABOVE = np.array((7, 2, 3)), np.array((5, 6, 1))
"""Indices into the nine entries of a rotation matrix, row by row; the differences of these entries give the rotation
axis."""

CAUTION, POSTURE_GAIN = 1e-3, 0.02
"""The damping of a step near singularities, and the gain of the null-space motion towards the robot's preferred
posture."""
DAMPED = CAUTION * np.eye(6)

INVERSE: Callable[[NDArray[np.float64]], NDArray[np.float64]] = getattr(np.linalg, "_umath_linalg", np.linalg).inv
"""`numpy.linalg.inv` without its checks, which take longer than the inversion of a small matrix."""

TRACKING, TRACKING_DAMPED = 8, 1e-5 * np.eye(6)
"""The maximum number of steps towards a target pose, and their damping, which is lower because steps are repeated."""

MAX_SOLUTIONS = 4
EVEN: tuple[float, ...] = (1.0,) * 7

Rows = tuple[tuple[float, ...], ...]


@lru_cache(maxsize=1 << 8)
def tool_matrix(robot: Robot, joints: Joints) -> Rows:
    """Return the pose of a robot's tool in the frame of its base, as the rows of a homogeneous matrix."""
    return tuple(map(tuple, robot.solver.forward(joints).tolist()))


@lru_cache(maxsize=1 << 8)
def tool_pose(robot: Robot, joints: Joints) -> Pose:
    """Return the pose of a robot's tool."""
    at: list[list[float]] = robot.solver.forward(joints).tolist()
    pose = Pose((at[0][3], at[1][3], at[2][3]), quaternion_of(at))
    return pose if robot.base is ORIGIN else compose(robot.base, pose)


def inverse(robot: Robot, tool: Pose, near: Joints | None = None) -> Iterator[Joints]:
    """Yield at most `MAX_SOLUTIONS` joint configurations that bring the tool to a pose, best first.

    The best configurations are those nearest to `near`, by default the robot's preferred posture turned towards the
    target. Each is within the joint limits, and according to forward kinematics, it brings the tool within 0.01 mm of
    the target.
    """
    tool, solver = _from_base(robot, tool), robot.solver
    from_tool = Pose((0.0, 0.0, -robot.tool_offset), yaw_quaternion(-robot.tool_turn))
    goal, flange = rows(tool), matrix(compose(tool, from_tool))
    start, weights = near, EVEN
    if start is None:
        heading = math.atan2(tool.position[1], tool.position[0])
        start, weights = (heading, *robot.posture[1:]), solver.weights
    solutions, origin = list[Joints](), tuple(map(mul, start, weights))

    def sweeps() -> Iterator[tuple[float, ...]]:
        yield from solver.sweeps(tool, near)
        if not solutions:
            yield solver.last_resort

    for angles in sweeps():
        ranked = []
        for row in solver.solutions(flange, start, angles):
            # A branch without a solution is NaN, which fails every comparison.
            if robot.within_limits(row):
                ranked.append((math.dist(tuple(map(mul, row, weights)), origin), tuple(row)))
        for _, joints in sorted(ranked):
            if any(math.dist(joints, other) < APART for other in solutions):
                continue
            if max(map(math.dist, tool_matrix(robot, joints)[:3], goal)) < ACCURACY:
                solutions.append(joints)
                yield joints
                if len(solutions) == MAX_SOLUTIONS:
                    return


def adjust_joints(robot: Robot, tool: Pose, near: Joints) -> Joints | None:
    """Return a joint configuration close to `near` that brings the tool to a nearby pose, or None if none is found.

    The method is damped least squares, which, unlike a sweep, changes the posture no more than necessary.
    """
    forward, target, joints = robot.solver.forward, matrix(_from_base(robot, tool)), np.array(near)
    for _ in range(ADJUSTMENTS):
        here = forward(joints)
        error = _twist(here, target)
        if np.abs(error).max() < ACCURACY:
            solution = tuple(joints.tolist())
            return solution if robot.within_limits(solution) else None
        columns = [_twist(here, forward(joints + row)) / DIFFERENCE for row in DIFFERENCES]
        jacobian = np.array(columns).T
        joints = joints + jacobian.T @ np.linalg.solve(jacobian @ jacobian.T + DAMPING * np.eye(6), error)
    return None


def nudge_joints(
    robot: Robot, joints: NDArray[np.float64], here: NDArray[np.float64], twist: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Return joint angles that move the tool by approximately a small twist in the world frame; shape (7,).

    `here` is the pose of the tool at `joints`, in the frame of the base as a homogeneous matrix; `twist` has the shape
    (6,): metres, then radians about the axes. The method is one step of damped least squares (Wampler, "Manipulator
    inverse kinematic solutions based on vector formulations and damped least-squares methods", 1986), so the arm does
    not jump near singularities. Motion in the null space brings the arm closer to the robot's preferred posture.
    """
    jacobian = _jacobian(robot, joints, here)
    if robot.base is not ORIGIN:
        turn = matrix(robot.base)[:3, :3].T
        twist = np.concatenate([turn @ twist[:3], turn @ twist[3:]])
    across = jacobian.T  # dot() is faster than @ for such small arrays
    inverse = across.dot(INVERSE(jacobian.dot(across) + DAMPED))
    posture_step = POSTURE_GAIN * (_posture(robot) - joints)
    posture_step[0] = 0.0
    result: NDArray[np.float64] = joints + posture_step + inverse.dot(twist - jacobian.dot(posture_step))
    return result


def track_joints(robot: Robot, joints: NDArray[np.float64], target: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return joint angles within their limits that bring the tool as close to a nearby pose as possible.

    `target` is a homogeneous matrix in the frame of the base. The method repeats the step that `nudge_joints` takes.
    """
    posture_step = POSTURE_GAIN * (_posture(robot) - joints)
    posture_step[0] = 0.0
    for _ in range(TRACKING):
        here = robot.solver.forward(joints)
        twist = _twist(here, target)
        if np.abs(twist).max() < ACCURACY:
            break
        jacobian = _jacobian(robot, joints, here)
        inverse = jacobian.T @ np.linalg.inv(jacobian @ jacobian.T + TRACKING_DAMPED)
        joints = np.clip(joints + posture_step + inverse @ (twist - jacobian @ posture_step), robot.lower, robot.upper)
        posture_step = np.zeros_like(joints)
    return joints


@cache
def _posture(robot: Robot) -> NDArray[np.float64]:
    """Return the preferred posture of a robot, shape (7,)."""
    return np.array(robot.posture)


def _jacobian(robot: Robot, joints: NDArray[np.float64], here: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the Jacobian of the pose of the tool in the frame of the base, by finite differences; shape (6, 7)."""
    near = np.array(list(map(robot.solver.forward, joints + DIFFERENCES)))
    turns = (near[:, :3, :3] @ here[:3, :3].T).reshape(-1, 9)
    jacobian = np.empty((6, len(joints)))
    jacobian[:3] = (near[:, :3, 3] - here[:3, 3]).T
    jacobian[3:] = (turns.take(BELOW, 1) - turns.take(ABOVE, 1)).T / 2
    jacobian /= DIFFERENCE
    return jacobian


def _twist(one: NDArray[np.float64], two: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the twist from one pose to a nearby pose, shape (6,): metres, then radians."""
    turn = two[:3, :3] @ one[:3, :3].T
    vector = (turn[2, 1] - turn[1, 2], turn[0, 2] - turn[2, 0], turn[1, 0] - turn[0, 1])
    return np.concatenate([two[:3, 3] - one[:3, 3], np.array(vector) / 2])


def _from_base(robot: Robot, tool: Pose) -> Pose:
    """Transform a pose from the world frame to the frame of a robot's base."""
    return tool if robot.base is ORIGIN else compose(invert(robot.base), tool)


def quaternion_of(r: Sequence[Sequence[float]]) -> Quaternion:
    """Return the unit quaternion of the rotation in a rotation matrix or a homogeneous matrix, by Shepperd's method."""
    (a, b, c), (d, e, f), (g, h, i) = (row[:3] for row in r[:3])
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
