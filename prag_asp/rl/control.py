"""Convert the actions of an agent to motor commands of an arm.

An agent moves the fingers, and either the tool, by a displacement and a turn about the vertical, or each joint. Actions
are clipped to the speeds and the limits of the robot, so none is refused.
"""

from __future__ import annotations

from functools import cache
from typing import Literal, get_args

import numpy as np
from numpy.typing import NDArray

from prag_asp.physics.robot.kinematics import nudge_joints
from prag_asp.physics.witness import Arm
from prag_asp.physics.world.dynamics import ArmCommand
from prag_asp.scene.geometry import rotate
from prag_asp.scene.robots import Robot

Control = Literal["tool", "joints"]
CONTROLS: tuple[Control, ...] = get_args(Control)

STRIDE, TURN = 0.05, 0.25
"""The maximum displacement along each axis and rotation of the tool in a step, in metres and radians."""

FINGERS = 0.01
"""The maximum change of the opening of a gripper in a step, in metres."""

LEASH = 0.1
"""The maximum difference between a motor's target and its joint, in radians: it bounds the force of a blocked arm."""

GAP = 0.001
"""The minimum height of the fingertips above the table, in metres."""

SIZES = {"tool": 5, "joints": 8}
"""The size of an action of an arm: x, y, z, yaw, fingers; or seven joints and the fingers. All are between -1 and 1."""


def motor_command(
    robot: Robot, arm: Arm, last: ArmCommand, action: NDArray[np.float64], control: Control, seconds: float
) -> ArmCommand:
    """Return the command of an arm for the next `seconds`.

    `last` is the command until now, `arm` its actual state; `action` has the shape (`SIZES[control]`,), each
    number between -1 and 1.
    """
    joints, (speeds, lower, upper) = np.array(last.joints), _bounds(robot)
    farthest = speeds * seconds
    step = _towards(robot, joints, action) - joints if control == "tool" else action[:7] * speeds * seconds
    joints += step / max(1.0, float((np.abs(step) / farthest).max()))
    here = np.array(arm.joints)
    for least, most in ((here - LEASH, here + LEASH), (lower, upper)):
        np.maximum(joints, least, out=joints)
        np.minimum(joints, most, out=joints)
    opening = min(max(last.opening + FINGERS * float(action[-1]), 0.0), robot.opening)
    return ArmCommand(tuple(joints.tolist()), opening)


@cache
def _bounds(robot: Robot) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """Return the speeds of a robot's joints, and their lower and upper limits; shape (7,)."""
    return np.array(robot.speeds), np.array(robot.lower), np.array(robot.upper)


def _towards(robot: Robot, joints: NDArray[np.float64], action: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return joint angles that move the upright tool by an action; the fingertips stay above the table."""
    here = robot.solver.forward(joints)
    x, y, z, yaw, *_ = action.tolist()
    lowest = robot.fingertip + GAP - float(here[2, 3])
    # The cross product of the tool's direction and straight down: it rotates the tool to point down.
    leaning, rolling, _ = rotate(robot.base.quaternion, (-float(here[1, 2]), float(here[0, 2]), 0.0))
    twist = np.array((STRIDE * x, STRIDE * y, max(STRIDE * z, lowest), leaning, rolling, TURN * yaw))
    return nudge_joints(robot, joints, here, twist)
