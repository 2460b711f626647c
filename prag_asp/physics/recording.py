"""Take down what happens in a world with forces, frame by frame."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from prag_asp.physics.demonstration import Demonstration
from prag_asp.physics.dynamics import PARTS, TIME_STEP, Dynamics
from prag_asp.physics.situation import Situation

FRAME_STEPS = 6
"""Time steps of a frame: 20 frames a second."""


class Recorder:
    """Collects the frames of one performance, each as the numbers that will be in the file."""

    def __init__(self, world: Dynamics, objects: Sequence[str]):
        self._world = world
        self._objects = tuple(objects)
        self._frames: list[tuple[list[float], list[float], list[list[float]]]] = []
        self._contacts: list[tuple[int, int, int]] = []
        self._forces: list[float] = []
        self._ends: list[int] = []

    def frame(self, command: Sequence[float]) -> None:
        """Record the world as it is, with what the motors drive to: seven joint angles and an opening."""
        joints, width = self._world.arm()
        rows = [[*pose.position, *pose.quaternion] for pose in self._world.poses().values()]
        for (one, two), force in self._world.contacts().items():
            self._contacts.append((len(self._frames), one, two))
            self._forces.append(force)
        self._frames.append(([*joints, width], list(command), rows))

    def end_state(self) -> Situation:
        """Note that a state of the task ends with the last frame, and return what that shows, as it is recorded."""
        self._ends.append(len(self._frames) - 1)
        return self.finish().situation(self._world.scene, self._ends[-1])

    def finish(self, cause: str = "", detail: str = "") -> Demonstration:
        """Return the recording."""
        arms, commands, rows = zip(*self._frames, strict=True)
        arm = np.array(arms, dtype=np.float32)
        frames = len(self._frames)
        return Demonstration(
            objects=self._objects,
            bodies=(*PARTS, *self._objects),
            times=(np.arange(frames) * FRAME_STEPS * TIME_STEP).astype(np.float32),
            joints=arm[:, :7],
            widths=arm[:, 7],
            commands=np.array(commands, dtype=np.float32),
            poses=np.array(rows, dtype=np.float32).reshape(frames, len(self._objects), 7),
            contacts=np.array(self._contacts, dtype=np.int32).reshape(-1, 3),
            forces=np.array(self._forces, dtype=np.float32),
            ends=np.array(self._ends, dtype=np.int32),
            cause=cause,
            detail=detail,
        )
