"""Convert the actions of an agent to motor commands for an arm.

Actions are clipped to the speeds and ranges of the robot's joints, so none is refused.
"""

from __future__ import annotations

from collections.abc import Callable
from operator import truediv

import numpy as np

from prag_asp.physics.control.control import FINGERS, Control, Floats
from prag_asp.physics.control.names import ControlName
from prag_asp.physics.control.tool_poses import moved_pose, pose_from_vector
from prag_asp.physics.robot.kinematics import nudge_joints, track_joints
from prag_asp.physics.witness import Arm
from prag_asp.physics.world.dynamics import ArmCommand
from prag_asp.scene.geometry import matrix, rotate
from prag_asp.scene.robots import Joints, Robot

LEASH = 0.1
"""The maximum difference between a motor's target and its joint, in radians; it bounds the force of a blocked arm."""

LEAD, LEAD_TURN = 0.1, 0.5
"""The largest distance in metres and in radians between the tool's target pose and the pose at which the motors aim.

Beyond it, the target is discarded, so an arm that was blocked does not have to catch up.
"""

GAP = 0.001
"""The minimum height of the fingertips above the table, in metres."""


class ArmMotors:
    """The motor targets of one arm, which follow the actions; `command` holds the latest targets."""

    def __init__(self, robot: Robot, control: Control, command: ArmCommand):
        self.command = command
        self._robot, self._control = robot, control
        self._aim = AIMS[control.name]
        self._goal: Floats | None = None
        self._base, self._to_base = matrix(robot.base), np.linalg.inv(matrix(robot.base))
        self._farthest = [speed / control.rate for speed in robot.speeds]

    def follow(self, values: Floats, arm: Arm) -> ArmCommand:
        """Return the command of the arm until the next action.

        `values` are the robot's numbers in an action, in their units; `arm` is the actual state of the arm.
        """
        joints = np.array(self.command.joints)
        steps = (self._aim(self, joints, values) - joints).tolist()
        excess = max(1.0, *map(truediv, map(abs, steps), self._farthest))
        limits = zip(self.command.joints, steps, arm.joints, self._robot.lower, self._robot.upper, strict=True)
        targets = tuple(
            [_clipped(last + step / excess, here, lower, upper) for last, step, here, lower, upper in limits]
        )
        self._limit_goal(targets)
        change = float(values[-1])
        if self._control.name != "ee_delta_upright":
            farthest = FINGERS / self._control.rate
            change = min(max(change - self.command.opening, -farthest), farthest)
        opening = min(max(self.command.opening + change, 0.0), self._robot.opening)
        self.command = ArmCommand(targets, opening)
        return self.command

    def joint_position(self, joints: Floats, values: Floats) -> Floats:
        """Return the joint angles that an action specifies."""
        return values[:7]

    def joint_delta(self, joints: Floats, values: Floats) -> Floats:
        """Return the joint angles after adding the changes in an action."""
        return joints + values[:7]

    def ee_position(self, joints: Floats, values: Floats) -> Floats:
        """Return joint angles that bring the tool to the pose that an action specifies."""
        self._goal = pose_from_vector(values)
        return track_joints(self._robot, joints, self._to_base @ self._goal)

    def ee_delta(self, joints: Floats, values: Floats) -> Floats:
        """Return joint angles that move the target pose of the tool by the motion that an action specifies."""
        goal = self._base @ self._robot.solver.forward(joints) if self._goal is None else self._goal
        self._goal = moved_pose(goal, values)
        return track_joints(self._robot, joints, self._to_base @ self._goal)

    def ee_delta_upright(self, joints: Floats, values: Floats) -> Floats:
        """Return joint angles that move the upright tool by an action; the fingertips stay above the table."""
        robot = self._robot
        here = robot.solver.forward(joints)
        x, y, z, yaw, *_ = values.tolist()
        lowest = robot.fingertip + GAP - float(here[2, 3])
        # The cross product of the tool's direction and straight down is the rotation that makes the tool point down.
        leaning, rolling, _ = rotate(robot.base.quaternion, (-float(here[1, 2]), float(here[0, 2]), 0.0))
        return nudge_joints(robot, joints, here, np.array((x, y, max(z, lowest), leaning, rolling, yaw)))

    def _limit_goal(self, joints: Joints) -> None:
        """Discard the target pose of the tool if the targets of the motors are too far from it."""
        if self._goal is None:
            return
        at = self._base @ self._robot.solver.forward(np.array(joints))
        cosine = (float(np.trace(self._goal[:3, :3].T @ at[:3, :3])) - 1.0) / 2
        if np.abs(self._goal[:3, 3] - at[:3, 3]).max() > LEAD or cosine < np.cos(LEAD_TURN):
            self._goal = None


def _clipped(target: float, here: float, lower: float, upper: float) -> float:
    """Return the target of a motor in radians, clipped to the surroundings of its joint and to the joint's limits.

    Comparisons are faster than arrays, or `min` and `max`.
    """
    if target < here - LEASH:
        target = here - LEASH
    elif target > here + LEASH:
        target = here + LEASH
    return lower if target < lower else upper if target > upper else target


AIMS: dict[ControlName, Callable[[ArmMotors, Floats, Floats], Floats]] = {
    "joint_position": ArmMotors.joint_position,
    "joint_delta": ArmMotors.joint_delta,
    "ee_position": ArmMotors.ee_position,
    "ee_delta": ArmMotors.ee_delta,
    "ee_delta_upright": ArmMotors.ee_delta_upright,
}
