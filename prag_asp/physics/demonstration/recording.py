"""Take down what happens in a world with forces, frame by frame."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from prag_asp.physics.demonstration.demonstration import Demonstration, situation_of
from prag_asp.physics.situation import Situation
from prag_asp.physics.world.dynamics import PARTS, TIME_STEP, Dynamics

FRAME_STEPS = 6
"""Time steps of a frame: 20 frames a second."""


class Recorder:
    """Collects the frames of one performance, each as the numbers that will be in the file."""

    def __init__(self, world: Dynamics, objects: Sequence[str]):
        self._world = world
        self._objects = tuple(objects)
        self._arms: list[list[float]] = []
        self._commands: list[Sequence[float]] = []
        self._poses: list[list[list[float]]] = []
        self._openings: list[list[float]] = []
        self._contacts: list[tuple[int, int, int]] = []
        self._forces: list[float] = []
        self._ends: list[int] = []

    def frame(self, command: Sequence[float]) -> None:
        """Record the world as it is, with what the motors drive to: seven joint angles and an opening."""
        joints, width = self._world.arm()
        rows = [[*pose.position, *pose.quaternion] for pose in self._world.poses().values()]
        for (one, two), force in self._world.contacts().items():
            self._contacts.append((len(self._arms), one, two))
            self._forces.append(force)
        self._arms.append([*joints, width])
        self._commands.append(command)
        self._poses.append(rows)
        self._openings.append(list(self._world.openings().values()))

    def end_state(self) -> Situation:
        """Note that a state of the task ends with the last frame, and return what that shows, as it is recorded."""
        self._ends.append(len(self._arms) - 1)
        arm, poses = np.array(self._arms[-1], dtype=np.float32), np.array(self._poses[-1], dtype=np.float32)
        opened = np.array(self._openings[-1], dtype=np.float32).tolist()
        openings = dict(zip(self._world.openings(), opened, strict=True))
        return situation_of(self._world.scene, self._objects, arm, poses, openings)

    def finish(self, cause: str = "", detail: str = "") -> Demonstration:
        """Return the recording."""
        shapes = self._world.scene.shapes
        arm, frames = np.array(self._arms, dtype=np.float32), len(self._arms)
        return Demonstration(
            objects=self._objects,
            bodies=(*PARTS, *self._objects),
            times=(np.arange(frames) * FRAME_STEPS * TIME_STEP).astype(np.float32),
            joints=arm[:, :7],
            widths=arm[:, 7],
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
        )
