"""What is recorded while the robot performs a task, as arrays that round-trip to a file."""

from __future__ import annotations

import zipfile
from collections.abc import Mapping
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from prag_asp.domain.scene import Scene
from prag_asp.errors import OutputError, QueryError, SceneError
from prag_asp.physics.facts import problem
from prag_asp.physics.geometry import Pose
from prag_asp.physics.kinematics import tool_pose
from prag_asp.physics.situation import Situation
from prag_asp.space.task import Task

Floats = NDArray[np.float32]
Integers = NDArray[np.int32]
ARRAYS = ("times", "joints", "widths", "commands", "poses", "contacts", "forces", "ends")
TEXTS = ("bodies", "objects", "cause", "detail")


@dataclass(frozen=True, eq=False)
class Demonstration:
    """A recording at 20 Hz of the robot performing a task: T frames, O objects, C contacts.

    `times` (T,) in seconds; `joints` (T, 7) in radians; `widths` (T,) how far the gripper is open in metres;
    `commands` (T, 8) the joint angles and the opening that the motors drive to; `poses` (T, O, 7) of `objects`
    as x, y, z in metres and a quaternion x, y, z, w; `contacts` (C, 3) as the frame and the positions of two
    bodies in `bodies`, `forces` (C,) the normal force between them in newtons. `ends` holds for each state of the
    task that was reached the frame in which its facts were checked, the initial state first. `cause` is empty
    where the task succeeded, otherwise one of `CAUSES`, and `detail` says what went wrong when.
    """

    objects: tuple[str, ...]
    bodies: tuple[str, ...]
    times: Floats
    joints: Floats
    widths: Floats
    commands: Floats
    poses: Floats
    contacts: Integers
    forces: Floats
    ends: Integers
    cause: str = ""
    detail: str = ""

    @property
    def success(self) -> bool:
        """Whether every state of the task was reached."""
        return not self.cause

    def __eq__(self, other: object) -> bool:
        """Tell whether two recordings are the same, bit by bit."""
        if not isinstance(other, Demonstration):
            return NotImplemented
        return all(np.array_equal(getattr(self, each.name), getattr(other, each.name)) for each in fields(self))

    __hash__ = None  # type: ignore[assignment]

    def situation(self, scene: Scene, frame: int) -> Situation:
        """Return what a frame shows, for predicates to check."""
        poses = {entity: _pose(row) for entity, row in zip(self.objects, self.poses[frame].tolist(), strict=True)}
        return Situation(scene, poses, tool_pose(tuple(self.joints[frame].tolist())), float(self.widths[frame]))

    def save(self, path: Path) -> None:
        """Write the recording as a compressed .npz file, the same bytes for the same recording.

        Raises:
            OutputError: the file cannot be written.
        """
        content: dict[str, Any] = {name: getattr(self, name) for name in ARRAYS}
        content |= {name: np.array(getattr(self, name)) for name in TEXTS}
        try:
            with path.open("wb") as file:
                np.savez_compressed(file, **content)
        except OSError as error:
            raise OutputError(f"{path}: the demonstration cannot be written: {error}") from error

    @classmethod
    def load(cls, path: Path) -> Demonstration:
        """Return the recording that `save` wrote.

        Raises:
            QueryError: the file cannot be read, or holds something else.
        """
        try:
            with np.load(path, allow_pickle=False) as content:
                return _from_arrays({name: content[name] for name in (*ARRAYS, *TEXTS)})
        except (OSError, KeyError, ValueError, IndexError, EOFError, zipfile.BadZipFile) as error:
            raise QueryError(f"{path}: this is not a demonstration: {error}") from error


def check_demonstration(task: Task, demonstration: Demonstration, scene: Scene) -> list[str]:
    """Return which facts of the task do not hold in the recorded frames, nothing where the task is performed.

    Raises:
        SceneError: the task speaks about something for which the scene has no shape.
    """
    states = problem(task, scene).states
    if len(demonstration.ends) != len(states):
        return [f"{len(demonstration.ends)} states are reached; the task has {len(states)}"]
    found = []
    for k, (frame, facts) in enumerate(zip(demonstration.ends.tolist(), states, strict=True)):
        if not 0 <= frame < len(demonstration.times):
            return [f"state {k}: there is no frame {frame}"]
        situation = demonstration.situation(scene, frame)
        for fact in facts:
            try:
                satisfied = fact.satisfied(situation)
            except SceneError as error:
                return [f"state {k}: {error}"]
            if not satisfied:
                found.append(f"state {k}: it does not hold that {fact.sentence()}")
    return found


def _pose(row: list[float]) -> Pose:
    """Return a pose from its seven numbers."""
    x, y, z, qx, qy, qz, qw = row
    return Pose((x, y, z), (qx, qy, qz, qw))


def _from_arrays(content: Mapping[str, NDArray[Any]]) -> Demonstration:
    """Return a recording from the arrays of a file.

    Raises:
        ValueError: their shapes do not belong together.
    """
    objects, bodies = tuple(map(str, content["objects"].tolist())), tuple(map(str, content["bodies"].tolist()))
    frames, touches = len(content["times"]), len(content["forces"])
    wanted = {
        "times": (frames,),
        "joints": (frames, 7),
        "widths": (frames,),
        "commands": (frames, 8),
        "poses": (frames, len(objects), 7),
        "contacts": (touches, 3),
        "forces": (touches,),
        "ends": (len(content["ends"]),),
    }
    for name, shape in wanted.items():
        if content[name].shape != shape:
            raise ValueError(f"{name} has the shape {content[name].shape} in place of {shape}")
    arrays = {name: content[name].astype(np.int32 if name in ("contacts", "ends") else np.float32) for name in ARRAYS}
    return Demonstration(objects, bodies, **arrays, cause=str(content["cause"]), detail=str(content["detail"]))
