"""Drive the motors of the arms step by step, and record every frame."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from prag_asp.physics.demonstration.recording import FRAME_STEPS, Recorder
from prag_asp.physics.world.dynamics import STILL, TIME_STEP, ArmCommand, Dynamics
from prag_asp.scene.robots import Joints

LONGEST_REST = 0.5
"""The longest time to wait for objects to come to rest, in seconds: a ball may roll on."""

FINGER_SPEED = 0.16
"""The speed of opening or closing a gripper, in metres a second."""


class Driver:
    """Drives the arms of a simulation; those without a new target hold their position."""

    def __init__(self, world: Dynamics, recorder: Recorder, commands: Mapping[str, ArmCommand]):
        self._world, self._recorder = world, recorder
        self._commands = dict(commands)
        self._steps = 0
        self._still = False
        for robot, command in commands.items():
            self._command(robot, command)
        recorder.frame(self._commands)

    def joints(self, robot: str) -> Joints:
        """Return the target joint angles of an arm in radians."""
        return self._commands[robot].joints

    def opening(self, robot: str) -> float:
        """Return the target opening of a gripper in metres."""
        return self._commands[robot].opening

    def move(self, robot: str, angles: NDArray[np.float64]) -> None:
        """Move an arm along a path with the joint angles of every time step, shape (steps, 7)."""
        start, opening = self._commands[robot]
        speeds = np.diff(angles, axis=0, prepend=np.array([start])) / TIME_STEP
        for row, speed in zip(angles.tolist(), speeds.tolist(), strict=True):
            self._command(robot, ArmCommand(tuple(row), opening), speed)
            self._step()
        self._command(robot, self._commands[robot])

    def move_fingers(self, robot: str, opening: float) -> None:
        """Move the fingers of an arm to an opening in metres, at `FINGER_SPEED`."""
        joints, start = self._commands[robot]
        steps = math.ceil(abs(opening - start) / FINGER_SPEED / TIME_STEP)
        for i in range(1, steps + 1):
            self._command(robot, ArmCommand(joints, start + i / steps * (opening - start)))
            self._step()

    def rest(self) -> None:
        """Simulate until nothing moves, at most `LONGEST_REST`; a frame ends then."""
        for _ in range(round(LONGEST_REST / TIME_STEP / FRAME_STEPS)):
            self._step()
            while self._steps % FRAME_STEPS:
                self._step()
            if self._still:
                return

    def _command(self, robot: str, command: ArmCommand, speeds: Sequence[float] = STILL) -> None:
        """Set the targets of an arm's motors, with target speeds of the joints in rad/s."""
        self._commands[robot] = command
        self._world.drive(robot, command, speeds)

    def _step(self) -> None:
        """Simulate one time step, and record a frame if one ends."""
        self._world.step()
        self._recorder.step()
        self._steps += 1
        if self._steps % FRAME_STEPS == 0:
            self._still = self._world.at_rest()
            self._recorder.frame(self._commands)
