"""A dynamic simulation for an agent, which can be reset to any moment of any witness."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from contextlib import ExitStack

import numpy as np
from numpy.typing import NDArray

from prag_asp.physics.control.arm_motors import ArmMotors
from prag_asp.physics.control.control import Control
from prag_asp.physics.demonstration.acting import SQUEEZE
from prag_asp.physics.demonstration.recording import FRAME_STEPS
from prag_asp.physics.robot.kinematics import tool_pose
from prag_asp.physics.situation import Body, Situation
from prag_asp.physics.witness import Witness
from prag_asp.physics.world.dynamics import ArmCommand, open_dynamics
from prag_asp.physics.world.time_step import STEPS_A_SECOND
from prag_asp.scene.boxes import Vector
from prag_asp.scene.robots import robot_of
from prag_asp.scene.scene import Scene


class Arena:
    """A simulated world in which actions follow a `control`; it is rebuilt only if the bodies or their sizes change."""

    def __init__(self, scene: Scene, control: Control, resources: ExitStack):
        self._scene, self._control = scene, control
        substeps = STEPS_A_SECOND // control.rate
        # The fraction of the commanded motion after each simulation step of an action.
        self._shares = tuple((i + 1) / substeps for i in range(substeps))
        self._steps = 0
        self._world = resources.enter_context(open_dynamics(scene))
        self._begun: tuple[Scene, tuple[str, ...]] | None = None
        self._motors: dict[str, ArmMotors] = {}
        self._tools: dict[str, Vector] = {}
        self._speeds: dict[str, Vector] = {}
        self._situation: Situation | None = None

    def start(self, witness: Witness, number: int) -> Situation:
        """Reset the world to moment `number` of a witness; the simulation depends only on it and on later actions.

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
        # the motors hold the current pose of each arm, and its fingers hold the grasped body
        self._motors = {}
        for name, arm in moment.arms.items():
            command = ArmCommand(arm.joints, arm.width - (SQUEEZE if arm.held is not None else 0.0))
            self._motors[name] = ArmMotors(robot_of(scene, name), self._control, command)
            self._world.drive(name, command)
        self._tools, self._situation, self._steps = {}, None, 0
        return self._observe()

    def act(self, action: NDArray[np.float64]) -> Situation:
        """Apply an action of the control for its duration."""
        assert self._situation is not None
        targets, speeds, world = {}, {}, self._world
        values = self._control.values(action).reshape(len(self._motors), -1)
        for (robot, motors), own in zip(self._motors.items(), values, strict=True):
            last, command = motors.command, motors.follow(own, self._situation.arm(robot))
            way = [(a, b - a) for a, b in zip(last.motor_targets, command.motor_targets, strict=True)]
            speeds[robot] = [by / self._period for _, by in way[:7]]
            targets[robot] = [[at + share * by for at, by in way] for share in self._shares]
        begin, end = 0, len(self._shares)
        while begin < end:
            now = min(end, begin + FRAME_STEPS - self._steps % FRAME_STEPS)
            world.run({robot: rows[begin:now] for robot, rows in targets.items()}, speeds)
            self._steps, begin = self._steps + now - begin, now
            if self._steps % FRAME_STEPS == 0:
                world.settle()
        return self._observe()

    @property
    def _period(self) -> float:
        """The duration of an action, in seconds."""
        return 1 / self._control.rate

    @property
    def speeds(self) -> Mapping[str, Vector]:
        """The velocity of the tool of each robot during the last action, in metres per second."""
        return self._speeds

    @property
    def commanded_openings(self) -> Mapping[str, float]:
        """The commanded opening of each gripper, in metres."""
        return {robot: motors.command.opening for robot, motors in self._motors.items()}

    def _observe(self) -> Situation:
        """Return the current situation, and update the velocities of the tools."""
        world, last, measured = self._world, self._situation, dict[str, Body]()
        scene, arms, poses, openings = world.scene, world.arms(), world.poses(), world.openings()
        tools = {name: tool_pose(robot_of(scene, name), arm.joints) for name, arm in arms.items()}
        if last is not None and last.scene is scene and last.openings == openings:
            # keep the measurements of bodies that have not moved
            stood, measured = last.poses, last.measured
            poses = {entity: stood[entity] if stood.get(entity) == pose else pose for entity, pose in poses.items()}
        self._situation = Situation(scene, poses, arms, openings, tools, measured)
        at = {name: tool.position for name, tool in tools.items()}
        self._speeds = {name: _speed(self._tools.get(name, here), here, self._period) for name, here in at.items()}
        self._tools = at
        return self._situation


def _speed(one: Sequence[float], two: Sequence[float], seconds: float) -> Vector:
    """Return the mean velocity between two points, in metres per second."""
    x, y, z = ((b - a) / seconds for a, b in zip(one, two, strict=True))
    return (x, y, z)
