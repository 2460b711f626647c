"""A dynamic simulation for an agent that can be reset to any moment of any witness."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from contextlib import ExitStack

import numpy as np
from numpy.typing import NDArray

from prag_asp.physics.demonstration.acting import SQUEEZE
from prag_asp.physics.robot.kinematics import tool_pose
from prag_asp.physics.situation import Situation
from prag_asp.physics.witness import Witness
from prag_asp.physics.world.dynamics import TIME_STEP, ArmCommand, open_dynamics
from prag_asp.rl.control import Control, motor_command
from prag_asp.scene.boxes import Vector
from prag_asp.scene.robots import Joints, robot_of
from prag_asp.scene.scene import Scene

SUBSTEPS = 6
"""The number of simulation steps per action: an agent acts 20 times a second."""

PERIOD = SUBSTEPS * TIME_STEP
"""The duration of an action, in seconds."""

SHARES = tuple((i + 1) / SUBSTEPS for i in range(SUBSTEPS))
"""The share of the commanded motion after each simulation step of an action."""


class Arena:
    """A simulated world, which is rebuilt only if the bodies or their sizes change."""

    def __init__(self, scene: Scene, resources: ExitStack):
        self._scene = scene
        self._world = resources.enter_context(open_dynamics(scene))
        self._begun: tuple[Scene, tuple[str, ...]] | None = None
        self._commands: dict[str, ArmCommand] = {}
        self._tools: dict[str, Vector] = {}
        self._speeds: dict[str, Vector] = {}
        self._situation: Situation | None = None

    def start(self, witness: Witness, number: int) -> Situation:
        """Reset the world to a moment of a witness, by its number; the simulation from then on depends on nothing else.

        Raises:
            SceneError: the witness has sizes that the scene does not allow.
        """
        moment = witness.moments[number]
        scene = self._scene.with_sizes(witness.sizes) if witness.sizes else self._scene
        # The order of the objects depends only on the scene, so that more tasks share a world.
        places = {entity: place for place, entity in enumerate(scene.fixed)}
        objects = tuple(sorted(moment.poses, key=lambda entity: (places.get(entity, len(places)), entity)))
        if self._begun != (scene, objects):
            self._world.begin(objects, moment, scene)
            self._begun = scene, objects
        self._world.restore(moment)
        # The motors hold the current pose of each arm, and its fingers hold the grasped body.
        self._commands = {
            name: ArmCommand(arm.joints, arm.width - (SQUEEZE if arm.held is not None else 0.0))
            for name, arm in moment.arms.items()
        }
        for robot, command in self._commands.items():
            self._world.drive(robot, command)
        self._tools, self._situation = {}, None
        return self._observe()

    def act(self, action: NDArray[np.float64], control: Control) -> Situation:
        """Apply an action, which has the numbers of each robot in turn, between -1 and 1, for one `PERIOD`."""
        assert self._situation is not None
        commands, ways = {}, {}
        for (robot, last), own in zip(self._commands.items(), action.reshape(len(self._commands), -1), strict=True):
            arm = self._situation.arm(robot)
            commands[robot] = motor_command(self._situation.robot(robot), arm, last, own, control, PERIOD)
            ways[robot] = [(a, b - a) for a, b in zip(_driven(last), _driven(commands[robot]), strict=True)]
        speeds = {robot: [by / PERIOD for _, by in way[:-1]] for robot, way in ways.items()}
        for share in SHARES:
            for robot, way in ways.items():
                *joints, opening = [at + share * by for at, by in way]
                self._world.drive(robot, ArmCommand(tuple(joints), opening), speeds[robot])
            self._world.step()
        self._commands = commands
        self._world.at_rest()
        return self._observe()

    @property
    def speeds(self) -> Mapping[str, Vector]:
        """The velocity of the tool of each robot in the last period, in metres a second."""
        return self._speeds

    @property
    def commanded_openings(self) -> Mapping[str, float]:
        """The commanded opening of each gripper, in metres."""
        return {robot: command.opening for robot, command in self._commands.items()}

    def _observe(self) -> Situation:
        """Return the current situation, and update the velocities of the tools."""
        world = self._world
        scene, arms = world.scene, world.arms()
        tools = {name: tool_pose(robot_of(scene, name), arm.joints) for name, arm in arms.items()}
        situation = _after(self._situation, Situation(scene, world.poses(), arms, world.openings(), tools))
        at = {name: tool.position for name, tool in tools.items()}
        self._speeds = {name: _speed(self._tools.get(name, here), here) for name, here in at.items()}
        self._tools, self._situation = at, situation
        return situation


def _after(last: Situation | None, now: Situation) -> Situation:
    """Return a situation that keeps the measurements of bodies that have not moved since the `last` situation."""
    if last is None or last.scene is not now.scene or last.openings != now.openings:
        return now
    stood = last.poses
    poses = {entity: stood[entity] if stood.get(entity) == pose else pose for entity, pose in now.poses.items()}
    return Situation(now.scene, poses, now.arms, now.openings, now.tools, last.measured)


def _driven(command: ArmCommand) -> Joints:
    """Return the targets of the motors of an arm: the joints in radians, and the opening in metres."""
    return (*command.joints, command.opening)


def _speed(one: Sequence[float], two: Sequence[float]) -> Vector:
    """Return the mean velocity between two points over a period, in metres a second."""
    x, y, z = ((b - a) / PERIOD for a, b in zip(one, two, strict=True))
    return (x, y, z)
