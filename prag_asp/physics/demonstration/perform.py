"""Let the robot perform a task in a world with forces, as a witness shows it.

The robot sees where the objects are: it grasps each as the witness does, from where it really stands, and puts it
where the witness has it, however it lies in the hand. So small errors do not add up.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from contextlib import contextmanager

import numpy as np
from numpy.typing import NDArray

from prag_asp.domain.scene import Scene
from prag_asp.physics.demonstration.demonstration import Demonstration
from prag_asp.physics.demonstration.recording import FRAME_STEPS, Recorder
from prag_asp.physics.facts import Effect, Fact, Problem, problem
from prag_asp.physics.geometry import (
    Pose,
    compose,
    invert,
    multiply,
    raised,
    rotate,
    wrap,
    yaw_of,
    yaw_quaternion,
)
from prag_asp.physics.motion.route import Load, free_path, pulled, straight, vertical
from prag_asp.physics.motion.trajectory import LOADED_ACCELERATION, timed
from prag_asp.physics.robot import Joints
from prag_asp.physics.robot.kinematics import adjusted, tool_pose
from prag_asp.physics.search.attempt import LOST, NO_PATH, NOT_REACHED
from prag_asp.physics.situation import Situation
from prag_asp.physics.verdict import TRANSIT, Moment, Waypoint, Witness
from prag_asp.physics.world.dynamics import TIME_STEP, Dynamics, open_dynamics
from prag_asp.physics.world.simulator import Simulator, open_simulator
from prag_asp.space.task import Task

REST = 0.1
"""Seconds in which things come to rest after the gripper moved, and before a state is checked."""

SQUEEZE = 0.008
"""How much farther than an object is wide the gripper wants to close, in metres."""

FINGER_SPEED = 0.16
LARGEST_TURN = 0.3
STILL = (0.0,) * 7


class _Stopped(Exception):
    """The performance failed: its arguments are the cause and what went wrong. It never leaves this module."""


class Performer:
    """Performs witnesses in one world with forces; use `open_performer`, which closes it."""

    def __init__(self, world: Dynamics, planner: Simulator):
        self._scene = world.scene
        self._world = world
        self._planner = planner

    def perform(self, seen: Problem, witness: Witness) -> Demonstration:
        """Return the recording of a task as it is performed from the first state of a witness.

        After every action each fact of the state has to pass its predicate's check; otherwise the recording
        ends there, with the cause.
        """
        scene = self._scene.with_sizes(witness.sizes)
        self._planner.use(scene)
        performance = _Performance(self._world, self._planner, seen, witness, scene)
        try:
            performance.run()
        except _Stopped as stopped:
            cause, detail = stopped.args
            return performance.recorder.finish(cause, detail)
        return performance.recorder.finish()


@contextmanager
def open_performer(scene: Scene, planner: Simulator) -> Iterator[Performer]:
    """Open a world to perform witnesses in, and close it afterwards; `planner` finds the paths of the arm."""
    with open_dynamics(scene) as world:
        yield Performer(world, planner)


def demonstrate(task: Task, witness: Witness, scene: Scene) -> Demonstration:
    """Return the recording of the robot performing a task from the first state of a witness.

    Raises:
        SceneError: the task speaks about something for which the scene has no shape.
    """
    with open_simulator(scene) as planner, open_performer(scene, planner) as performer:
        return performer.perform(problem(task, scene), witness)


class _Performance:
    """One task while it is performed: what the motors are told, and where the witness is by then."""

    def __init__(self, world: Dynamics, planner: Simulator, seen: Problem, witness: Witness, scene: Scene):
        first = witness.moments[0]
        self.recorder = Recorder(world, seen.objects)
        self._world, self._planner = world, planner
        self._seen, self._witness = seen, witness
        self._joints = self._planned = first.joints
        self._opening, self._held = first.width, first.held
        self._steps = 0
        world.begin(seen.objects, first, scene)
        self.recorder.frame((*self._joints, self._opening))

    def run(self) -> None:
        """Perform all actions.

        Raises:
            _Stopped: a state was not reached.
        """
        if self._held is not None:
            self._move_fingers(self._opening - SQUEEZE)
        self._check(self._seen.initial, "the start")
        for k, (effect, motion) in enumerate(zip(self._seen.effects, self._witness.motions, strict=True)):
            way: list[Joints] = []
            for i, waypoint in enumerate(motion):
                if waypoint.name == TRANSIT:
                    way.append(waypoint.joints)
                    continue
                target = next((each.held for each in motion[i:] if each.held is not None), effect.visits)
                self._follow(waypoint, way, target, self._witness.moments[k : k + 2], effect)
                way = []
            self._check(effect.after, str(effect.action))

    def _check(self, facts: tuple[Fact, ...], after: str) -> None:
        """Let things come to rest, and check the facts of a state.

        Raises:
            _Stopped: one does not hold.
        """
        self._wait(REST)
        while self._steps % FRAME_STEPS:
            self._step(self._joints, STILL)
        situation = self.recorder.end_state()
        broken = [fact for fact in facts if not fact.satisfied(situation)]
        lost = [fact for fact in broken if fact.predicate.name == "holding" and fact.value]
        if broken:
            worst = (lost or broken)[0]
            what = f"after {after} it does not hold that {worst.sentence()}"
            raise _Stopped(LOST if lost else NOT_REACHED, what)

    def _follow(
        self, waypoint: Waypoint, way: list[Joints], target: str | None, around: tuple[Moment, ...], effect: Effect
    ) -> None:
        """Bring the arm to a waypoint, and close or open the gripper there."""
        if self._held is None and waypoint.held is None and waypoint.width != self._opening:
            self._move_fingers(waypoint.width)
        if waypoint.joints != self._planned:
            self._move(waypoint, way, target, around, effect)
        if waypoint.held != self._held:
            self._held = waypoint.held
            self._move_fingers(waypoint.width - (SQUEEZE if waypoint.held is not None else 0.0))
            self._wait(REST)

    def _move(
        self, waypoint: Waypoint, way: list[Joints], target: str | None, around: tuple[Moment, ...], effect: Effect
    ) -> None:
        """Bring the arm to a waypoint, straight up or down, on the way of the witness, or else on a free path.

        Raises:
            _Stopped: there is no free path.
        """
        situation = self._situation()
        if waypoint.opening is not None:
            self._pull(waypoint, situation)
            return
        load = self._load(situation)
        upright = vertical(self._planner.robot, self._planned, waypoint.joints)
        if upright:
            height = self._tool(waypoint.joints).position[2] - self._tool(self._planned).position[2]
            tool = raised(self._tool(self._joints), height)
            goal = adjusted(self._planner.robot, tool, waypoint.joints) or waypoint.joints
            path = straight(self._planner, self._joints, goal)
            angles = timed(path, TIME_STEP, load.acceleration, self._planner.robot.speed)
        else:
            tool = _corrected(waypoint, self._tool(waypoint.joints), target, around, situation)
            goal = adjusted(self._planner.robot, tool, waypoint.joints) or waypoint.joints
            speed = self._planner.robot.speed
            free = (
                timed(self._along(way, waypoint.joints, goal), TIME_STEP, load.acceleration, speed)
                if way
                else free_path(self._planner, situation, load, self._joints, goal, TIME_STEP)
            )
            if free is None:
                raise _Stopped(NO_PATH, f"{effect.action}: {NO_PATH} to the waypoint {waypoint.name}")
            angles = free
        self._drive(angles)
        self._joints, self._planned = goal, waypoint.joints

    def _pull(self, waypoint: Waypoint, situation: Situation) -> None:
        """Move the arm along the slide or the arc of the handle that it holds, up to a waypoint."""
        assert waypoint.held is not None and waypoint.opening is not None
        grip = compose(invert(situation.part(waypoint.held)), self._tool(self._joints))
        path = pulled(self._planner.robot, situation, grip, waypoint, self._joints)
        self._drive(timed(path, TIME_STEP, LOADED_ACCELERATION, self._planner.robot.speed))
        self._joints, self._planned = path[-1], waypoint.joints

    def _along(self, way: list[Joints], planned: Joints, goal: Joints) -> list[Joints]:
        """Return the way of the witness, from where the arm is to a goal: the small differences are spread over it."""
        first, last = np.subtract(self._joints, self._planned), np.subtract(goal, planned)
        shares = np.linspace(0.0, 1.0, len(way) + 2)[1:-1, None]
        between = np.array(way) + (1 - shares) * first + shares * last
        return [self._joints, *map(tuple, between.tolist()), goal]

    def _load(self, situation: Situation) -> Load:
        """Return what the gripper carries, as it lies in it."""
        if self._held is None:
            return Load(self._opening)
        return Load(situation.width, self._held, compose(invert(situation.tool), situation.poses[self._held]))

    def _situation(self) -> Situation:
        """Return where everything is now."""
        joints, width = self._world.arm()
        openings = self._world.openings()
        return Situation(self._world.scene, self._world.poses(), self._tool(joints), width, openings=openings)

    def _tool(self, joints: Joints) -> Pose:
        """Return the pose of the tool at joint angles."""
        return tool_pose(self._planner.robot, joints)

    def _drive(self, angles: NDArray[np.float64]) -> None:
        """Move the arm through the joint angles of every time step, shape (steps, 7)."""
        speeds = np.diff(angles, axis=0, prepend=np.array([self._joints])) / TIME_STEP
        for row, speed in zip(angles.tolist(), speeds.tolist(), strict=True):
            self._step(row, speed)

    def _move_fingers(self, opening: float) -> None:
        """Move the fingers to an opening in metres, at `FINGER_SPEED`."""
        begun = self._opening
        steps = math.ceil(abs(opening - begun) / FINGER_SPEED / TIME_STEP)
        for i in range(steps):
            self._opening = begun + (i + 1) / steps * (opening - begun)
            self._step(self._joints, STILL)
        self._opening = opening

    def _wait(self, seconds: float) -> None:
        """Let time pass."""
        for _ in range(round(seconds / TIME_STEP)):
            self._step(self._joints, STILL)

    def _step(self, joints: Joints | list[float], speeds: tuple[float, ...] | list[float]) -> None:
        """Let one time step pass, and record every frame."""
        self._world.step(joints, speeds, self._opening)
        self._steps += 1
        if self._steps % FRAME_STEPS == 0:
            self.recorder.frame((*joints, self._opening))


def _corrected(
    waypoint: Waypoint, planned: Pose, target: str | None, around: tuple[Moment, ...], situation: Situation
) -> Pose:
    """Return where the tool has to be at a waypoint, `planned` in the witness: objects are not just where it has them.

    A held object shall come to where it is in the witness; the tool shall stand to another, which it goes to,
    as in the witness.
    """
    before, after = around
    if waypoint.held is not None:
        grasp = before.grasp if before.held == waypoint.held else after.grasp
        assert grasp is not None
        wanted = compose(planned, grasp)
        grasped = compose(invert(situation.tool), situation.poses[waypoint.held])
        turn = _turn(compose(planned, grasped), wanted)
        quaternion = multiply(turn, planned.quaternion)
        return Pose(_minus(wanted.position, rotate(quaternion, grasped.position)), quaternion)
    if target is None:
        return planned
    there = Situation(situation.scene, before.poses, planned, 0.0, openings=before.openings).part(target)
    here = situation.part(target)
    round_body = situation.shape(target).traits.round
    turn = yaw_quaternion(0.0) if round_body else _turn(there, here)
    offset = rotate(turn, _minus(planned.position, there.position))
    x, y, z = (a + b for a, b in zip(here.position, offset, strict=True))
    return Pose((x, y, z), multiply(turn, planned.quaternion))


def _turn(one: Pose, two: Pose) -> tuple[float, float, float, float]:
    """Return the rotation about z from the heading of one pose to that of another, none where it is not small."""
    angle = wrap(yaw_of(two.quaternion) - yaw_of(one.quaternion))
    return yaw_quaternion(angle if abs(angle) < LARGEST_TURN else 0.0)


def _minus(one: tuple[float, float, float], two: tuple[float, float, float]) -> tuple[float, float, float]:
    """Return the difference of two vectors."""
    return (one[0] - two[0], one[1] - two[1], one[2] - two[2])
