"""The recordings of a dataset as episodes of the same shape, from which all formats are written."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from prag_asp.dataset.store.dataset import Dataset
from prag_asp.dataset.store.entry import DatasetEntry
from prag_asp.dataset.store.instructions import LEVELS, PLAIN
from prag_asp.domain.load import load_scene
from prag_asp.errors import QueryError
from prag_asp.physics.demonstration.demonstration import FRAMES_A_SECOND, Demonstration
from prag_asp.physics.demonstration.footage import NOTHING, Film
from prag_asp.scene.robots import robot_of
from prag_asp.scene.scene import Scene
from prag_asp.scene.variation import table_of
from prag_asp.wording import did_you_mean

Floats = NDArray[np.float32]
POSE = ("x", "y", "z", "qx", "qy", "qz", "qw")
NO_TASK = "has no such task; request others"


@dataclass(frozen=True, eq=False)
class ExportEpisode:
    """A recording as N moments, each a camera image or a frame, and the actions between them; R robots.

    `frames` (N,) are the frames of the recording at these moments; `state` (N, 8R) has the joint angles in radians and
    the opening in metres of each robot, in the order of `EpisodeSource.joints`; `action` (N, 8R) what its motors drive
    to when the next moment comes, after the last one still the same. `subgoal` (N,) is which of the task's actions is
    being done, 0 the first; `subgoals` tells each in words.
    """

    entry: DatasetEntry
    start: int
    instruction: str
    demonstration: Demonstration
    frames: NDArray[np.int64]

    @property
    def length(self) -> int:
        """How many moments there are."""
        return len(self.frames)

    @property
    def subgoals(self) -> tuple[str, ...]:
        """The actions of the task in words; one without a word where the task has none."""
        return self.entry.subgoals or ("",)

    @property
    def plan(self) -> list[str]:
        """The actions of the task."""
        return list(map(str, self.entry.task.actions))

    @property
    def films(self) -> Mapping[str, Film]:
        """What the cameras saw, a picture for each moment; nothing where there are no cameras."""
        return self.demonstration.footage.films if self.demonstration.footage else {}

    @property
    def state(self) -> Floats:
        """Where the robots are."""
        shown = self.demonstration
        all_of_it = np.concatenate([shown.joints, shown.widths[..., None]], axis=2)
        found: Floats = all_of_it[self.frames].reshape(self.length, -1)
        return found

    @property
    def action(self) -> Floats:
        """What the motors drive to when the next moment comes."""
        after = np.append(self.frames[1:], len(self.demonstration.times) - 1)
        found: Floats = self.demonstration.commands[after].reshape(self.length, -1)
        return found

    @property
    def subgoal(self) -> NDArray[np.int64]:
        """Which action is being done: the first that is not over before the moment, by the `ends` of the recording."""
        over = np.searchsorted(self.demonstration.ends[1:], self.frames)
        return np.minimum(over, max(0, len(self.demonstration.ends) - 2))

    @property
    def rewards(self) -> Floats:
        """1 for the action that ends with the final state of the task, whose facts were checked; otherwise 0."""
        found = np.zeros(self.length, dtype=np.float32)
        found[-1] = self.demonstration.success
        return found


@dataclass(frozen=True)
class EpisodeSource:
    """A dataset to be written in another form; `level` is how much the instructions say, one of `LEVELS`."""

    data: Dataset
    level: str = "default"

    def __post_init__(self) -> None:
        if self.level not in LEVELS:
            raise QueryError(f"there are no instructions {self.level}; {did_you_mean(self.level, LEVELS)}")

    @cached_property
    def scene(self) -> Scene:
        """The scene of the domain."""
        return load_scene(self.data.domain)

    @property
    def robots(self) -> tuple[str, ...]:
        """The robots, in the order of the recordings."""
        return tuple(self.scene.robots)

    @property
    def joints(self) -> list[str]:
        """The names of the numbers of a state and of an action: ``panda/joint_1`` to ``panda/gripper``."""
        names = (*(f"joint_{number}" for number in range(1, 8)), "gripper")
        return [f"{robot}/{name}" for robot in self.robots for name in names]

    @cached_property
    def limits(self) -> tuple[Floats, Floats]:
        """The least and the largest values of an action that the robots allow, shapes (8R,)."""
        robots = [robot_of(self.scene, name) for name in self.robots]
        lower = [value for robot in robots for value in (*robot.lower, 0.0)]
        upper = [value for robot in robots for value in (*robot.upper, robot.opening)]
        return np.array(lower, dtype=np.float32), np.array(upper, dtype=np.float32)

    @cached_property
    def cameras(self) -> Mapping[str, tuple[int, int]]:
        """The cameras of the recordings, each with width and height in pixels.

        Raises:
            QueryError: the scene has none of this name, or a size or a rate cannot be.
        """
        staging = self.data.manifest.spec.staging
        return {} if staging is None else {name: each.size for name, each in staging.cameras_of(self.scene).items()}

    @property
    def rate(self) -> int:
        """How many moments an episode has in a second."""
        staging = self.data.manifest.spec.staging
        return staging.rate if staging and self.cameras else FRAMES_A_SECOND

    @cached_property
    def objects(self) -> list[str]:
        """All objects of the scene; a task may have some of them."""
        return [entity for entity, shape in self.scene.shapes.items() if shape.traits.body]

    @cached_property
    def furniture(self) -> list[str]:
        """Those objects that have a part on a joint."""
        return [entity for entity in self.objects if self.scene.shapes[entity].traits.furniture]

    @cached_property
    def legend(self) -> list[str]:
        """What the numbers of a segmentation mean, the same for all episodes."""
        others = [entity for entity, shape in self.scene.shapes.items() if not shape.traits.body]
        return list(dict.fromkeys([NOTHING, table_of(self.scene), *others, *self.robots, *self.objects]))

    @property
    def numbered(self) -> np.dtype[np.unsignedinteger]:
        """The type of the numbers of a segmentation: bytes as long as there is one to spare."""
        return np.dtype(np.uint8 if len(self.legend) < np.iinfo(np.uint8).max else np.uint16)

    @property
    def count(self) -> int:
        """How many episodes there are at most: conditions may leave some out."""
        return sum(note.rows("recordings") for note in self.data.manifest.parts if note.name in self.data.parts)

    def require_recordings(self) -> None:
        """Check that the dataset was made with recordings.

        Raises:
            QueryError: it was not.
        """
        if not self.data.manifest.spec.demonstrate:
            hint = "make a dataset that has, with prag-asp generate --demonstrate"
            raise QueryError(f"{self.data.folder}: has no recordings; {hint}")

    def episodes(self) -> Iterator[ExportEpisode]:
        """Yield the episodes, in the order of the tasks and their initial states.

        Raises:
            QueryError: there are none, or a recording is damaged, or is not of these robots and cameras.
        """
        found = False
        for entry, start, shown in self.data.demonstrations():
            found = True
            yield self._episode(entry, start, shown)
        if not found:
            raise QueryError(f"{self.data.folder}: {NO_TASK}")

    def instruction(self, entry: DatasetEntry) -> str:
        """Return the instruction of a task at this level, or the plain one if it has no other."""
        return entry.instruction.get(self.level, entry.instruction.get(PLAIN, ""))

    def objects_of(self, episode: ExportEpisode) -> Floats:
        """Return where the objects are, shape (N, objects, 8): 1 where the task has it, then its pose; else zeros."""
        shown = episode.demonstration
        found = np.zeros((episode.length, len(self.objects), 1 + len(POSE)), dtype=np.float32)
        for number, entity in enumerate(shown.objects):
            at = self.objects.index(entity)
            found[:, at, 0], found[:, at, 1:] = 1.0, shown.poses[episode.frames, number]
        return found

    def openings_of(self, episode: ExportEpisode) -> Floats:
        """Return how far furniture is open in metres or radians, shape (N, furniture); 0 where the task has it not."""
        shown = episode.demonstration
        found = np.zeros((episode.length, len(self.furniture)), dtype=np.float32)
        for number, entity in enumerate(shown.furniture):
            found[:, self.furniture.index(entity)] = shown.openings[episode.frames, number]
        return found

    def segmentation_of(self, episode: ExportEpisode, camera: str) -> NDArray[np.unsignedinteger]:
        """Return which entity each pixel shows, as positions in `legend`, shape (N, H, W)."""
        footage = episode.demonstration.footage
        assert footage is not None
        numbers = np.array([self.legend.index(entity) for entity in footage.legend], dtype=self.numbered)
        found: NDArray[np.unsignedinteger] = numbers[episode.films[camera].segmentation]
        return found

    def _episode(self, entry: DatasetEntry, start: int, shown: Demonstration) -> ExportEpisode:
        name = f"{self.data.folder}: the recording of task {entry.number} of {entry.part}"
        named = (*shown.objects, *(shown.footage.legend if shown.footage else ()))
        strange = [each for each in named if each not in self.legend]
        if shown.robots != self.robots or strange:
            what = strange[0] if strange else ", ".join(shown.robots)
            raise QueryError(f"{name}: has {what}, of which the scene knows nothing; copy the dataset once more")
        if len(shown.ends) != len(entry.task) + 1 or len(entry.subgoals) != len(entry.task):
            raise QueryError(f"{name}: does not show the states of its task; copy the dataset once more")
        sizes = {camera: film.size for camera, film in shown.footage.films.items()} if shown.footage else {}
        if sizes != dict(self.cameras):
            raise QueryError(f"{name}: is not of the cameras that dataset.json names; copy the dataset once more")
        frames = shown.footage.frames if shown.footage else np.arange(len(shown.times))
        return ExportEpisode(entry, start, self.instruction(entry), shown, frames.astype(np.int64))
