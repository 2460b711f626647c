"""Execute the actions of a witness in a dynamic simulation: move the arms, open and close their grippers."""

from __future__ import annotations

from dataclasses import replace

from prag_asp.physics.demonstration.driving import Driver
from prag_asp.physics.demonstration.planning import Action, Angles, Leg, action_legs, plan_path, plan_pull
from prag_asp.physics.demonstration.recording import Recorder
from prag_asp.physics.motion.trajectory import blend_paths, joint_limits
from prag_asp.physics.search.attempt import NO_PATH
from prag_asp.physics.situation import Situation
from prag_asp.physics.witness import Arm, Moment, Waypoint
from prag_asp.physics.world.dynamics import TIME_STEP, ArmCommand, Dynamics
from prag_asp.physics.world.simulator import Simulator
from prag_asp.scene.robots import robot_of

SQUEEZE = 0.008
"""By how much the target opening of a gripper is below the width of the object that it holds, in metres."""


class PerformanceFailed(Exception):
    """An execution failed: the cause, one of `CAUSES`, and what went wrong; the performer catches it."""


class Actor:
    """Moves the arms of a simulation from waypoint to waypoint, and keeps track of their intended states."""

    def __init__(self, world: Dynamics, planner: Simulator, recorder: Recorder, first: Moment):
        self._world, self._planner = world, planner
        self._driver = Driver(world, recorder, {name: holding_command(arm) for name, arm in first.arms.items()})
        self._arms = dict(first.arms)

    def rest(self) -> None:
        """Simulate until nothing moves."""
        self._driver.rest()

    def act(self, action: Action) -> None:
        """Execute an action.

        Raises:
            PerformanceFailed: a path is not free.
        """
        ways: list[Angles] = []
        robot = ""
        for leg in action_legs(action):
            waypoint = leg.waypoint
            if waypoint.robot != robot or waypoint.opening is not None or self._fingers_move(waypoint):
                self._drive(robot, ways)
            robot, arm = waypoint.robot, self._arms[waypoint.robot]
            if arm.held is None and waypoint.held is None and self._fingers_move(waypoint):
                self._driver.move_fingers(robot, waypoint.width)
            if waypoint.joints != leg.start:
                ways.append(self._way(arm, leg, action))
                arm = self._arms[robot] = replace(arm, joints=tuple(ways[-1][-1].tolist()))
            if waypoint.held != arm.held:
                self._drive(robot, ways)
                self._arms[robot] = replace(arm, held=waypoint.held)
                squeeze = SQUEEZE if waypoint.held is not None else 0.0
                self._driver.move_fingers(robot, waypoint.width - squeeze)
                self._driver.rest()
        self._drive(robot, ways)

    def _fingers_move(self, waypoint: Waypoint) -> bool:
        """Return whether an empty gripper has another opening than at a waypoint."""
        return self._arms[waypoint.robot].held is None and waypoint.width != self._driver.opening(waypoint.robot)

    def _drive(self, robot: str, ways: list[Angles]) -> None:
        """Move an arm along paths without a stop between them, and clear the list."""
        if ways:
            limits = joint_limits(robot_of(self._world.scene, robot))
            self._driver.move(robot, blend_paths(ways, self._driver.joints(robot), TIME_STEP, limits))
            ways.clear()

    def _way(self, arm: Arm, leg: Leg, action: Action) -> Angles:
        """Return the joint angles of every time step on the path to a waypoint, shape (steps, 7).

        Raises:
            PerformanceFailed: there is no collision-free path.
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


def holding_command(arm: Arm) -> ArmCommand:
    """Return the motor targets that hold an arm in its state, squeezing what it holds."""
    return ArmCommand(arm.joints, arm.width - (SQUEEZE if arm.held is not None else 0.0))
