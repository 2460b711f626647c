"""From the actions of an agent to what the motors of an arm drive to.

An agent moves the tool by a displacement and a turn about the vertical, or each joint; and its fingers. What it asks
for is cut to the speeds and the limits of the robot, so no action is refused.
"""

from __future__ import annotations

from typing import Literal, get_args

import numpy as np
from numpy.typing import NDArray

from prag_asp.physics.robot.kinematics import nudged, tool_matrix
from prag_asp.physics.witness import Arm
from prag_asp.physics.world.dynamics import Command
from prag_asp.scene.geometry import rotate
from prag_asp.scene.robots import Robot

Control = Literal["tool", "joints"]
CONTROLS: tuple[Control, ...] = get_args(Control)

STRIDE, TURN = 0.05, 0.25
"""How far the tool moves along each axis and turns in a step at most, in metres and radians."""

FINGERS = 0.01
"""How much a gripper opens or closes in a step at most, in metres."""

LEASH = 0.1
"""How far ahead of a joint its motor may be told to be, in radians: an arm that is blocked presses no harder."""

GAP = 0.001
"""How far above the table the tips of the fingers are kept, in metres."""

SIZES = {"tool": 5, "joints": 8}
"""How many numbers an arm takes: x, y, z, yaw, fingers; or seven joints and the fingers. All are between -1 and 1."""


def commanded(
    robot: Robot, arm: Arm, last: Command, action: NDArray[np.float64], control: Control, seconds: float
) -> Command:
    """Return what the motors of an arm drive to, `seconds` from now.

    `last` is what they drive to until now, `arm` where it really is; `action` has the shape (`SIZES[control]`,), each
    number between -1 and 1.
    """
    joints = np.array(last.joints)
    if control == "tool":
        step = _towards(robot, last, joints, action) - joints
    else:
        step = np.clip(action[:7], -1.0, 1.0) * np.array(robot.speeds) * seconds
    fastest = float((np.abs(step) / (np.array(robot.speeds) * seconds)).max())
    joints = joints + step / max(1.0, fastest)
    here = np.array(arm.joints)
    joints = np.clip(np.clip(joints, here - LEASH, here + LEASH), robot.lower, robot.upper)
    opening = min(max(last.opening + FINGERS * float(action[-1]), 0.0), robot.opening)
    return Command(tuple(joints.tolist()), opening)


def _towards(
    robot: Robot, last: Command, joints: NDArray[np.float64], action: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Return joint angles that move the tool as an action says, upright; no lower than its fingers meet the table."""
    rows = tool_matrix(robot, last.joints)
    twist = np.zeros(6)
    twist[:3], twist[5] = STRIDE * action[:3], TURN * action[3]
    twist[2] = max(twist[2], robot.fingertip + GAP - rows[2][3])
    # The cross product of where the tool points and straight down: it turns the one to the other.
    along, across = rows[0][2], rows[1][2]
    twist[3:5] = rotate(robot.base.quaternion, (-across, along, 0.0))[:2]
    return nudged(robot, joints, twist)
