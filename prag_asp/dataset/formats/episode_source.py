"""The recordings in a dataset as episodes with uniform arrays, the input of all exports."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from prag_asp.dataset.formats.body_values import POSE, body_names, furniture_in, objects_in
from prag_asp.dataset.store.dataset import Dataset
from prag_asp.dataset.store.entry import DatasetEntry
from prag_asp.dataset.store.instructions import LEVELS, PLAIN
from prag_asp.domain.load import load_scene
from prag_asp.errors import QueryError
from prag_asp.physics.control.control import Control
from prag_asp.physics.control.names import CONTROLS, ControlName
from prag_asp.physics.control.recorded_actions import recorded_actions, state_names, states_in
from prag_asp.physics.demonstration.demonstration import FRAMES_A_SECOND, Demonstration
from prag_asp.physics.demonstration.footage import NOTHING, CameraVideo
from prag_asp.physics.robot.kinematics import tool_pose
from prag_asp.scene.robots import robot_of
from prag_asp.scene.scene import Scene
from prag_asp.scene.variation import table_of
from prag_asp.wording import did_you_mean, unknown

Floats = NDArray[np.float32]
NO_TASK = "has no such task; request others"


@dataclass(frozen=True, eq=False)
class ExportEpisode:
    """A recording of R robots as N time steps: one for each camera image or, without cameras, for each frame.

    `frames` (N,) holds the frames of the recording at these steps; `state` (N, 8R) holds the joint angles in radians
    and the gripper opening in metres of each robot, in the order of `EpisodeSource.joints`; `commands` (N + 1, R, 8)
    holds the motor commands at these steps and at the end of the recording. `subgoal` (N,) is the index of the action
    of the task that is being executed; `subgoals` holds a sentence for each action.
    """

    entry: DatasetEntry
    start: int
    instruction: str
    demonstration: Demonstration
    frames: NDArray[np.int64]

    @property
    def length(self) -> int:
        """The number N of time steps."""
        return len(self.frames)

    @property
    def subgoals(self) -> tuple[str, ...]:
        """A sentence for each action of the task, or a single empty sentence if the task has no actions."""
        return self.entry.subgoals or ("",)

    @property
    def plan(self) -> list[str]:
        """The actions of the task."""
        return list(map(str, self.entry.task.actions))

    @property
    def videos(self) -> Mapping[str, CameraVideo]:
        """The videos by name of camera, with an image for each step; empty if there are no cameras."""
        return self.demonstration.footage.videos if self.demonstration.footage else {}

    @property
    def state(self) -> Floats:
        """The joint angles and gripper openings at each step, shape (N, 8R)."""
        return self.arms.reshape(self.length, -1)

    @property
    def arms(self) -> Floats:
        """The joint angles and gripper openings of each robot at each step, shape (N, R, 8)."""
        demonstration = self.demonstration
        arms = np.concatenate([demonstration.joints, demonstration.widths[..., None]], axis=2)
        result: Floats = arms[self.frames]
        return result

    @property
    def commands(self) -> Floats:
        """The motor commands of each robot at each step and at the end of the recording, shape (N + 1, R, 8)."""
        result: Floats = self.demonstration.commands[np.append(self.frames, len(self.demonstration.times) - 1)]
        return result

    @property
    def subgoal(self) -> NDArray[np.int64]:
        """The index of the current action at each step, shape (N,): the first action that has not ended before."""
        over = np.searchsorted(self.demonstration.ends[1:], self.frames)
        return np.minimum(over, max(0, len(self.demonstration.ends) - 2))

    @property
    def rewards(self) -> Floats:
        """Rewards, shape (N,): 1 at the last step if the facts of the final state were verified, and 0 otherwise."""
        rewards = np.zeros(self.length, dtype=np.float32)
        rewards[-1] = self.demonstration.success
        return rewards


@dataclass(frozen=True)
class EpisodeSource:
    """A dataset to export.

    `level` is the level of detail of the instructions, one of `LEVELS`; `action` is the convention of actions, one of
    `CONTROLS`.
    """

    data: Dataset
    level: str = "default"
    action: str = "joint_position"

    def __post_init__(self) -> None:
        if self.level not in LEVELS:
            raise QueryError(f"there are no instructions {self.level}; {did_you_mean(self.level, LEVELS)}")
        if self.action not in CONTROLS:
            raise QueryError(unknown(self.action, CONTROLS, "control"))

    @cached_property
    def scene(self) -> Scene:
        """The scene of the domain."""
        return load_scene(self.data.domain)

    @property
    def robots(self) -> tuple[str, ...]:
        """The names of the robots, in the order of the recordings."""
        return tuple(self.scene.robots)

    @property
    def joints(self) -> list[str]:
        """The names of the 8R components of a state or an action: ``panda/joint_1`` to ``panda/gripper``."""
        return state_names(["joint_position"], self.scene)

    @cached_property
    def control(self) -> Control:
        """The convention of actions, for the robots and the rate of the recordings."""
        return Control.of(self.action, self.scene, self.rate)

    @cached_property
    def cameras(self) -> Mapping[str, tuple[int, int]]:
        """The cameras of the recordings, each with its width and height in pixels.

        Raises:
            QueryError: the scene has no camera with a requested name, or a size or a rate is invalid.
        """
        staging = self.data.manifest.spec.staging
        return {} if staging is None else {name: each.size for name, each in staging.cameras_of(self.scene).items()}

    @property
    def rate(self) -> int:
        """The number of time steps per second."""
        staging = self.data.manifest.spec.staging
        return staging.rate if staging and self.cameras else FRAMES_A_SECOND

    @cached_property
    def objects(self) -> list[str]:
        """All objects of the scene; a task may have only some of them."""
        return objects_in(self.scene)

    @cached_property
    def furniture(self) -> list[str]:
        """The objects with a jointed part."""
        return furniture_in(self.scene)

    @cached_property
    def legend(self) -> list[str]:
        """The entity for each value in segmentation images; it is the same for all episodes."""
        others = [entity for entity, shape in self.scene.shapes.items() if not shape.traits.body]
        return list(dict.fromkeys([NOTHING, table_of(self.scene), *others, *self.robots, *self.objects]))

    @property
    def segmentation_type(self) -> np.dtype[np.unsignedinteger]:
        """The type of the values in segmentation images: bytes, if they suffice with one value to spare."""
        return np.dtype(np.uint8 if len(self.legend) < np.iinfo(np.uint8).max else np.uint16)

    @property
    def count(self) -> int:
        """The number of recordings, an upper bound on the number of episodes, because conditions may exclude some."""
        return sum(note.rows("recordings") for note in self.data.manifest.parts if note.name in self.data.parts)

    def require_recordings(self) -> None:
        """Check that the dataset was generated with recordings.

        Raises:
            QueryError: the dataset was generated without recordings.
        """
        if not self.data.manifest.spec.demonstrate:
            hint = "generate a dataset with recordings: prag-asp generate --demonstrate"
            raise QueryError(f"{self.data.folder}: has no recordings; {hint}")

    def episodes(self) -> Iterator[ExportEpisode]:
        """Yield the episodes, in the order of the tasks and their initial states.

        Raises:
            QueryError: there are no episodes, or a recording is damaged, or has different robots or cameras.
        """
        empty = True
        for entry, start, demonstration in self.data.demonstrations():
            empty, footage = False, demonstration.footage
            name = f"{self.data.folder}: the recording of task {entry.number} of {entry.part}"
            entities = (*demonstration.objects, *(footage.legend if footage else ()))
            unknown = [entity for entity in entities if entity not in self.legend]
            if demonstration.robots != self.robots or unknown:
                what = unknown[0] if unknown else ", ".join(demonstration.robots)
                raise QueryError(f"{name}: has {what}, which the scene does not contain; copy the dataset again")
            if len(demonstration.ends) != len(entry.task) + 1 or len(entry.subgoals) != len(entry.task):
                raise QueryError(f"{name}: does not show the states of its task; copy the dataset again")
            sizes = {camera: video.size for camera, video in footage.videos.items()} if footage else {}
            if sizes != dict(self.cameras):
                raise QueryError(f"{name}: is not from the cameras in dataset.json; copy the dataset again")
            frames = footage.frames if footage else np.arange(len(demonstration.times))
            yield ExportEpisode(entry, start, self.instruction(entry), demonstration, frames.astype(np.int64))
        if empty:
            raise QueryError(f"{self.data.folder}: {NO_TASK}")

    def instruction(self, entry: DatasetEntry) -> str:
        """Return the instruction of a task at this level, or the plain instruction if it has no levels."""
        return entry.instruction.get(self.level, entry.instruction.get(PLAIN, ""))

    def actions_of(self, episode: ExportEpisode) -> Floats:
        """Return the actions of an episode, each from one time step to the next or to the end; shape (N, size).

        Raises:
            QueryError: the convention cannot express the recording.
        """
        try:
            return recorded_actions(self.control, self.scene, episode.commands).astype(np.float32)
        except QueryError as error:
            where = f"{self.data.folder}: the recording of task {episode.entry.number} of {episode.entry.part}"
            raise QueryError(f"{where}: {error}") from None

    def tools_of(self, episode: ExportEpisode) -> Floats:
        """Return the pose of each tool at each time step, shape (N, R, 7): x, y, z in metres, and a quaternion."""
        tools = np.empty((episode.length, len(self.robots), len(POSE)), dtype=np.float32)
        for i, name in enumerate(self.robots):
            robot = robot_of(self.scene, name)
            for step, row in enumerate(episode.arms[:, i].tolist()):
                tool = tool_pose(robot, tuple(row[:7]))
                tools[step, i] = *tool.position, *tool.quaternion
        return tools

    def objects_of(self, episode: ExportEpisode) -> Floats:
        """Return the poses of objects, shape (N, objects, 8): 1 and the pose, or zeros if the object is absent."""
        demonstration = episode.demonstration
        poses = np.zeros((episode.length, len(self.objects), 1 + len(POSE)), dtype=np.float32)
        for number, entity in enumerate(demonstration.objects):
            at = self.objects.index(entity)
            poses[:, at, 0], poses[:, at, 1:] = 1.0, demonstration.poses[episode.frames, number]
        return poses

    def openings_of(self, episode: ExportEpisode) -> Floats:
        """Return the openings of furniture in metres or radians, shape (N, furniture), or 0 if a piece is absent."""
        demonstration = episode.demonstration
        openings = np.zeros((episode.length, len(self.furniture)), dtype=np.float32)
        for number, entity in enumerate(demonstration.furniture):
            openings[:, self.furniture.index(entity)] = demonstration.openings[episode.frames, number]
        return openings

    @property
    def body_names(self) -> list[str]:
        """The names of the values that `bodies_of` returns."""
        return body_names(self.scene)

    def bodies_of(self, episode: ExportEpisode) -> Floats:
        """Return the poses of objects and the openings of furniture at each time step, shape (N, values)."""
        poses = self.objects_of(episode).reshape(episode.length, -1)
        return np.concatenate([poses, self.openings_of(episode)], axis=1)

    def states_of(self, episode: ExportEpisode, names: Sequence[ControlName]) -> Floats:
        """Return the states of the robots at each time step in given conventions, shape (N, components).

        `state_names` returns the names of the components.
        """
        result: Floats = states_in(names, self.scene, episode.arms).astype(np.float32)
        return result

    def segmentation_of(self, episode: ExportEpisode, camera: str) -> NDArray[np.unsignedinteger]:
        """Return the entity at each pixel as its index in `legend`, shape (N, H, W)."""
        footage = episode.demonstration.footage
        assert footage is not None
        numbers = np.array([self.legend.index(entity) for entity in footage.legend], dtype=self.segmentation_type)
        result: NDArray[np.unsignedinteger] = numbers[episode.videos[camera].segmentation]
        return result
