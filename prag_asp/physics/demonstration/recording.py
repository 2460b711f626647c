"""Record a dynamic simulation, frame by frame."""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Mapping, Sequence

import numpy as np

from prag_asp.physics.demonstration.contacts import Touch
from prag_asp.physics.demonstration.demonstration import Demonstration, situation_of
from prag_asp.physics.situation import Situation
from prag_asp.physics.witness import Arm
from prag_asp.physics.world.dynamics import NO_PRESSING, ArmCommand, Dynamics, Pressing
from prag_asp.physics.world.time_step import TIME_STEP

FRAME_STEPS = 6
"""The number of time steps per frame, for 20 frames per second."""


class Recorder:
    """A collector of the frames of an episode, as the numbers that the file of the episode will contain."""

    def __init__(self, world: Dynamics, objects: Sequence[str]):
        self._world = world
        self._objects = tuple(objects)
        self._arms: list[list[list[float]]] = []
        self._commands: list[list[list[float]]] = []
        self._poses: list[list[list[float]]] = []
        self._openings: list[list[float]] = []
        self._contacts: list[tuple[int, int, int]] = []
        self._forces: list[float] = []
        self._depths: list[float] = []
        self._pressing: dict[tuple[int, int], Pressing] = {}
        self._ends: list[int] = []

    def step(self) -> None:
        """Collect contact forces and depths after a time step; the next frame records the largest ones."""
        for pair, (force, depth) in self._world.contacts().items():
            before = self._pressing.get(pair, NO_PRESSING)
            if force > before.force or depth > before.depth:
                self._pressing[pair] = Pressing(max(force, before.force), max(depth, before.depth))

    def frame(self, commands: Mapping[str, ArmCommand]) -> None:
        """Record a frame, including the targets of each arm's motors."""
        arms = self._world.arms()
        rows = [[*pose.position, *pose.quaternion] for pose in self._world.poses().values()]
        for (one, two), (force, depth) in sorted(self._pressing.items()):
            self._contacts.append((len(self._arms), one, two))
            self._forces.append(force)
            self._depths.append(depth)
        self._pressing.clear()
        self._arms.append([[*arm.joints, arm.width] for arm in arms.values()])
        self._commands.append([[*commands[name].joints, commands[name].opening] for name in arms])
        self._poses.append(rows)
        self._openings.append(list(self._world.openings().values()))

    def touches(self) -> list[Touch]:
        """Return the contacts recorded between the ends of the last two states."""
        first = self._ends[-2] + 1 if len(self._ends) > 1 else 0
        begun = bisect_left(self._contacts, (first, 0, 0))
        forces = np.array(self._forces[begun:], dtype=np.float32).tolist()
        names = (*self._world.parts, *self._objects)
        return [
            Touch(frame, names[one], names[two], force, depth)
            for (frame, one, two), force, depth in zip(
                self._contacts[begun:], forces, self._depths[begun:], strict=True
            )
        ]

    def end_state(self) -> Situation:
        """Mark the last frame as the end of a state of the task, and return the recorded situation."""
        self._ends.append(len(self._arms) - 1)
        rows, poses = np.array(self._arms[-1], dtype=np.float32), np.array(self._poses[-1], dtype=np.float32)
        arms = {
            name: Arm(tuple(joints), width)
            for name, (*joints, width) in zip(self._world.scene.robots, rows.tolist(), strict=True)
        }
        opened = np.array(self._openings[-1], dtype=np.float32).tolist()
        openings = dict(zip(self._world.openings(), opened, strict=True))
        return situation_of(self._world.scene, self._objects, poses, openings, arms)

    def finish(self, cause: str = "", detail: str = "") -> Demonstration:
        """Return the episode."""
        shapes, robots = self._world.scene.shapes, tuple(self._world.scene.robots)
        arms, frames = np.array(self._arms, dtype=np.float32), len(self._arms)
        return Demonstration(
            objects=self._objects,
            bodies=(*self._world.parts, *self._objects),
            times=(np.arange(frames) * FRAME_STEPS * TIME_STEP).astype(np.float32),
            joints=arms[..., :7],
            widths=arms[..., 7],
            commands=np.array(self._commands, dtype=np.float32),
            sizes=np.array([shapes[entity].size for entity in self._objects], dtype=np.float32).reshape(-1, 3),
            poses=np.array(self._poses, dtype=np.float32).reshape(frames, len(self._objects), 7),
            furniture=tuple(self._world.openings()),
            openings=np.array(self._openings, dtype=np.float32).reshape(frames, -1),
            contacts=np.array(self._contacts, dtype=np.int32).reshape(-1, 3),
            forces=np.array(self._forces, dtype=np.float32),
            ends=np.array(self._ends, dtype=np.int32),
            cause=cause,
            detail=detail,
            robots=robots,
        )
