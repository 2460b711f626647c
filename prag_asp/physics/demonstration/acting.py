"""Execute the actions of a witness in a dynamic simulation, step by step, and record every frame."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from prag_asp.physics.demonstration.planning import Action, Angles, Leg, action_legs, plan_path, plan_pull
from prag_asp.physics.demonstration.recording import FRAME_STEPS, Recorder
from prag_asp.physics.motion.trajectory import blend_paths, joint_limits
from prag_asp.physics.search.attempt import NO_PATH
from prag_asp.physics.situation import Situation
from prag_asp.physics.witness import Arm, Moment, Waypoint
from prag_asp.physics.world.dynamics import STILL, ArmCommand, Dynamics
from prag_asp.physics.world.simulator import Simulator
from prag_asp.physics.world.time_step import TIME_STEP
from prag_asp.scene.robots import robot_of

SQUEEZE = 0.008
"""The amount by which the target opening of the gripper is smaller than the width of a held object, in metres."""

LONGEST_REST = 0.5
"""The longest time to wait for objects to come to rest, in seconds, because a ball may keep rolling."""

FINGER_SPEED = 0.16
"""The speed of opening or closing a gripper, in metres per second."""


class PerformanceFailed(Exception):
    """An execution failed: the cause, one of `CAUSES`, and a description; the performer catches this exception."""


class Actor:
    """A driver that moves the arms of a simulation from waypoint to waypoint, and keeps track of their intended states.

    Arms without a new target hold their position.
    """

    def __init__(self, world: Dynamics, planner: Simulator, recorder: Recorder, first: Moment):
        self._world, self._planner, self._recorder = world, planner, recorder
        self._arms = dict(first.arms)
        self._commands: dict[str, ArmCommand] = {}
        self._steps, self._still = 0, False
        for robot, arm in first.arms.items():
            squeeze = SQUEEZE if arm.held is not None else 0.0
            self._command(robot, ArmCommand(arm.joints, arm.width - squeeze))
        recorder.frame(self._commands)

    def rest(self) -> None:
        """Simulate until nothing moves, but for at most `LONGEST_REST`, and stop at the end of a frame."""
        for _ in range(round(LONGEST_REST / TIME_STEP / FRAME_STEPS)):
            self._step()
            while self._steps % FRAME_STEPS:
                self._step()
            if self._still:
                return

    def act(self, action: Action) -> None:
        """Execute an action.

        Raises:
            PerformanceFailed: no collision-free path is found.
        """
        ways: list[Angles] = []
        robot = ""
        for leg in action_legs(action):
            waypoint = leg.waypoint
            if waypoint.robot != robot or waypoint.opening is not None or self._fingers_move(waypoint):
                self._drive(robot, ways)
            robot, arm = waypoint.robot, self._arms[waypoint.robot]
            if arm.held is None and waypoint.held is None and self._fingers_move(waypoint):
                self._move_fingers(robot, waypoint.width)
            if waypoint.joints != leg.start:
                ways.append(self._way(arm, leg, action))
                arm = self._arms[robot] = replace(arm, joints=tuple(ways[-1][-1].tolist()))
            if waypoint.held != arm.held:
                self._drive(robot, ways)
                self._arms[robot] = replace(arm, held=waypoint.held)
                squeeze = SQUEEZE if waypoint.held is not None else 0.0
                self._move_fingers(robot, waypoint.width - squeeze)
                self.rest()
        self._drive(robot, ways)

    def _fingers_move(self, waypoint: Waypoint) -> bool:
        """Return whether the opening of an empty gripper differs from the opening that a waypoint requires."""
        return self._arms[waypoint.robot].held is None and waypoint.width != self._commands[waypoint.robot].opening

    def _drive(self, robot: str, ways: list[Angles]) -> None:
        """Move an arm along paths without stopping between them, and clear the list."""
        if ways:
            start, opening = self._commands[robot]
            angles = blend_paths(ways, start, TIME_STEP, joint_limits(robot_of(self._world.scene, robot)))
            speeds = np.diff(angles, axis=0, prepend=np.array([start])) / TIME_STEP
            for row, speed in zip(angles.tolist(), speeds.tolist(), strict=True):
                self._command(robot, ArmCommand(tuple(row), opening), speed)
                self._step()
            self._command(robot, self._commands[robot])
            ways.clear()

    def _way(self, arm: Arm, leg: Leg, action: Action) -> Angles:
        """Return the joint angles of every time step on the path to a waypoint, shape (steps, 7).

        Raises:
            PerformanceFailed: no such path was found.
        """
        waypoint, world = leg.waypoint, self._world
        self._planner.turn_to(waypoint.robot)
        arms = {name: replace(actual, held=self._arms[name].held) for name, actual in world.arms().items()}
        situation = Situation(world.scene, world.poses(), arms, world.openings())
        if waypoint.held is not None and waypoint.opening is not None:
            return plan_pull(self._planner, situation, arm, waypoint.held, waypoint.opening)
        path = plan_path(self._planner, situation, arm, leg, action)
        if path is None:
            raise PerformanceFailed(NO_PATH, f"{action.effect.action}: {NO_PATH} to the waypoint {waypoint.name}")
        return path

    def _move_fingers(self, robot: str, opening: float) -> None:
        """Move the fingers of an arm to an opening in metres, at `FINGER_SPEED`."""
        joints, start = self._commands[robot]
        steps = math.ceil(abs(opening - start) / FINGER_SPEED / TIME_STEP)
        for i in range(1, steps + 1):
            self._command(robot, ArmCommand(joints, start + i / steps * (opening - start)))
            self._step()

    def _command(self, robot: str, command: ArmCommand, speeds: Sequence[float] = STILL) -> None:
        """Set the targets of an arm's motors, including the target speeds of the joints in rad/s."""
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
