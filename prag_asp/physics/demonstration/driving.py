"""Tell the motors of the arms what to drive to, step by step, and let every frame be recorded."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from prag_asp.physics.demonstration.recording import FRAME_STEPS, Recorder
from prag_asp.physics.world.dynamics import STILL, TIME_STEP, ArmCommand, Dynamics
from prag_asp.scene.robots import Joints

LONGEST_REST = 0.5
"""Seconds after which things count as at rest though they move, such as a ball that rolls."""

FINGER_SPEED = 0.16
"""How fast a gripper opens or closes, in metres a second."""


class Driver:
    """Drives the arms of a world; those that are not told to move hold their places by their motors."""

    def __init__(self, world: Dynamics, recorder: Recorder, commands: Mapping[str, ArmCommand]):
        self._world, self._recorder = world, recorder
        self._commands = dict(commands)
        self._steps = 0
        self._still = False
        for robot, command in commands.items():
            self._command(robot, command)
        recorder.frame(self._commands)

    def joints(self, robot: str) -> Joints:
        """Return the joint angles in radians that the motors of an arm drive to."""
        return self._commands[robot].joints

    def opening(self, robot: str) -> float:
        """Return the opening in metres that the motors of a gripper drive to."""
        return self._commands[robot].opening

    def move(self, robot: str, angles: NDArray[np.float64]) -> None:
        """Move an arm through the joint angles of every time step, shape (steps, 7)."""
        begun, opening = self._commands[robot]
        speeds = np.diff(angles, axis=0, prepend=np.array([begun])) / TIME_STEP
        for row, speed in zip(angles.tolist(), speeds.tolist(), strict=True):
            self._command(robot, ArmCommand(tuple(row), opening), speed)
            self._step()
        self._command(robot, self._commands[robot])

    def move_fingers(self, robot: str, opening: float) -> None:
        """Move the fingers of an arm to an opening in metres, at `FINGER_SPEED`."""
        joints, begun = self._commands[robot]
        steps = math.ceil(abs(opening - begun) / FINGER_SPEED / TIME_STEP)
        for i in range(1, steps + 1):
            self._command(robot, ArmCommand(joints, begun + i / steps * (opening - begun)))
            self._step()

    def rest(self) -> None:
        """Let time pass until nothing moves, `LONGEST_REST` at most; then a frame ends."""
        for _ in range(round(LONGEST_REST / TIME_STEP / FRAME_STEPS)):
            self._step()
            while self._steps % FRAME_STEPS:
                self._step()
            if self._still:
                return

    def _command(self, robot: str, command: ArmCommand, speeds: Sequence[float] = STILL) -> None:
        """Tell the motors of an arm what to drive to, with speeds of the joints in radians a second."""
        self._commands[robot] = command
        self._world.drive(robot, command, speeds)

    def _step(self) -> None:
        """Let one time step pass, and record every frame."""
        self._world.step()
        self._recorder.step()
        self._steps += 1
        if self._steps % FRAME_STEPS == 0:
            self._still = self._world.at_rest()
            self._recorder.frame(self._commands)
