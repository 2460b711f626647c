"""Episodes: the arrays that are recorded while robots execute a task, and how they are saved and loaded."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from io import BytesIO
from pathlib import Path
from typing import TYPE_CHECKING, Any, BinaryIO

import numpy as np
from numpy.typing import NDArray

from prag_asp.array_archive import BadArchive, read_arrays
from prag_asp.errors import OutputError, QueryError
from prag_asp.output import replace_file
from prag_asp.physics.demonstration.footage import Footage, are_equal, read_footage, require_arrays
from prag_asp.physics.demonstration.packed_arrays import with_packed
from prag_asp.physics.witness import VERSION, Arm
from prag_asp.safe_reading import open_binary
from prag_asp.scene.geometry import Pose
from prag_asp.scene.scene import Scene
from prag_asp.scene.variation import Variation, variation_of
from prag_asp.tables.report import shown

if TYPE_CHECKING:
    from prag_asp.physics.demonstration.contacts import Touch
    from prag_asp.physics.situation import Situation

Floats = NDArray[np.float32]
Integers = NDArray[np.int32]
ARRAYS: Mapping[str, type[np.number[Any]]] = {
    **dict.fromkeys(("times", "joints", "widths", "commands", "sizes", "poses", "openings"), np.float32),
    "contacts": np.int32,
    "forces": np.float32,
    "ends": np.int32,
}
"""The arrays of an episode with their types, in the order in which they are stored."""

LISTS, TEXTS = ("robots", "bodies", "objects", "furniture"), ("cause", "detail")

VARIED = "varied"
"""The name of the array that holds the variation as text, which most episodes lack."""

LARGEST_FILE, LARGEST = 1_000_000_000, 256_000_000
"""The largest size in bytes of an episode's file, and of its arrays without camera images, which remain compressed."""

FRAMES_A_SECOND = 20


@dataclass(frozen=True, eq=False)
class Demonstration:
    """An episode at 20 Hz: T frames of the execution of a task with O objects (F of them furniture) and R robots.

    `times` (T,) are in seconds; `joints` (T, R, 7) in radians, in the order of `robots`; `widths` (T, R) are the
    openings of their grippers in metres; `commands` (T, R, 8) are the targets of the motors: joint angles and opening.
    `sizes` (O, 3) are the dimensions in metres of the bounding boxes of `objects`; `poses` (T, O, 7) are their x, y, z
    in metres and a quaternion x, y, z, w; `openings` (T, F) are the openings of `furniture` in metres or radians. Each
    row of `contacts` (C, 3) is a frame and the indices of two bodies in `bodies`; `forces` (C,) are the largest normal
    forces between them since the previous frame, in newtons. `ends` holds, for each state of the task that was reached,
    the frame in which its facts were checked, the initial state first. `cause` is empty if the task succeeded and one
    of `CAUSES` otherwise, and `detail` describes the fault and its time. `footage` holds the camera images, if there
    were cameras, and `variation` the changes of the world, if it was varied.
    """

    robots: tuple[str, ...]
    objects: tuple[str, ...]
    bodies: tuple[str, ...]
    times: Floats
    joints: Floats
    widths: Floats
    commands: Floats
    sizes: Floats
    poses: Floats
    openings: Floats
    contacts: Integers
    forces: Floats
    ends: Integers
    furniture: tuple[str, ...] = ()
    cause: str = ""
    detail: str = ""
    footage: Footage | None = None
    variation: Variation | None = None

    @property
    def success(self) -> bool:
        """Whether every state of the task was reached."""
        return not self.cause

    def __eq__(self, other: object) -> bool:
        """Return whether two episodes are equal, bit by bit."""
        return are_equal(self, other) if isinstance(other, Demonstration) else NotImplemented

    __hash__ = None  # type: ignore[assignment]

    def sized_scene(self, scene: Scene) -> Scene:
        """Return a scene with the sizes of the episode's objects and with its variation.

        Raises:
            SceneError: the scene does not allow a size or the variation.
        """
        pairs = zip(self.objects, self.sizes.tolist(), strict=True)
        sized = scene.with_sizes({entity: (x, y, z) for entity, (x, y, z) in pairs if entity in scene.ranges})
        return sized if self.variation is None else self.variation.applied(sized)

    def situation(self, scene: Scene, frame: int) -> Situation:
        """Return the situation in a frame, for predicates.

        Raises:
            SceneError: the scene does not allow the size of an object.
        """
        return situation_of(
            self.sized_scene(scene), self.objects, self.poses[frame], self.openings_at(frame), self.arms(frame)
        )

    def arms(self, frame: int) -> dict[str, Arm]:
        """Return the states of the arms in a frame, by name of robot."""
        rows = zip(self.robots, self.joints[frame].tolist(), self.widths[frame].tolist(), strict=True)
        return {name: Arm(tuple(angles), width) for name, angles, width in rows}

    def openings_at(self, frame: int) -> dict[str, float]:
        """Return the opening of furniture in a frame, in metres or radians."""
        return dict(zip(self.furniture, self.openings[frame].tolist(), strict=True))

    def touches(self, first: int, last: int) -> Iterator[Touch]:
        """Yield the contacts in the frames from `first` to `last`, both included."""
        from prag_asp.physics.demonstration.contacts import Touch  # noqa: PLC0415

        frames = self.contacts[:, 0]
        those = (frames >= first) & (frames <= last)
        for (frame, one, two), force in zip(self.contacts[those].tolist(), self.forces[those].tolist(), strict=True):
            yield Touch(frame, self.bodies[one], self.bodies[two], force)

    def save(self, path: Path) -> None:
        """Write the episode atomically as a compressed .npz file with a `version`; equal episodes give equal bytes.

        Raises:
            OutputError: the file cannot be written.
        """
        try:
            replace_file(path, self.to_bytes())
        except ValueError as error:
            raise OutputError(f"{path}: {error}") from None

    def to_bytes(self) -> bytes:
        """Return the content of the file that `save` writes.

        Raises:
            ValueError: the footage cannot be packed.
        """
        content: dict[str, Any] = {"version": np.array(VERSION)}
        content |= {name: getattr(self, name) for name in ARRAYS}
        content |= {name: np.array(getattr(self, name)) for name in (*LISTS, *TEXTS)}
        content |= {} if self.variation is None else {VARIED: np.array(self.variation.to_text())}
        content |= {} if self.footage is None else self.footage.arrays()
        buffer = BytesIO()
        np.savez_compressed(buffer, **content)
        archive = buffer.getvalue()
        return archive if self.footage is None else with_packed(archive, self.footage.packed_arrays())

    @classmethod
    def load(cls, path: str | Path, *, within: str | Path | None = None) -> Demonstration:
        """Return the episode that `save` wrote.

        If the path comes from an untrusted source, `within` is the folder that has to contain the file.

        Raises:
            QueryError: the file cannot be read, is not an episode, is too large, or lies outside `within`.
        """
        names = ("version", *ARRAYS, *LISTS, *TEXTS)
        with _open_episode(path, within) as file:
            content = read_arrays(file, (*names, VARIED), LARGEST)
            if "version" in content and (content["version"].shape != () or content["version"] != VERSION):
                version = shown(content["version"].tolist())
                raise QueryError(f"{path}: an episode of the version {version}; this program reads {VERSION}")
            for name in names:
                if name not in content:
                    raise BadArchive(f"it has no {name}")
            _require_fitting(content)
            arrays: dict[str, Any] = {name: content[name].astype(kind) for name, kind in ARRAYS.items()}
            arrays |= {name: tuple(map(str, content[name].tolist())) for name in LISTS}
            arrays |= {name: str(content[name]) for name in TEXTS}
            footage = read_footage(file, len(arrays["times"]), len(arrays["robots"]), LARGEST)
            return cls(**arrays, footage=footage, variation=_variation(content.get(VARIED)))


@contextmanager
def _open_episode(path: str | Path, within: str | Path | None) -> Iterator[BinaryIO]:
    """Open the file of an episode.

    Raises:
        QueryError: the file cannot be read, or code in the `with` block finds that it is not an episode.
    """
    try:
        with open_binary(path, within=within, at_most=LARGEST_FILE) as file:
            yield file
    except OSError as error:
        raise QueryError(f"{path}: cannot be read: {error.strerror or error}") from None
    except (BadArchive, ValueError) as error:
        raise QueryError(f"{path}: this is not a demonstration: {error}") from None


def read_variation(path: str | Path, *, within: str | Path | None = None) -> Variation | None:
    """Return the variation of the episode in a file, or None if it has none, without reading anything else.

    Raises:
        QueryError: the file cannot be read, or is not an episode.
    """
    with _open_episode(path, within) as file:
        return _variation(read_arrays(file, (VARIED,), LARGEST).get(VARIED))


def _variation(text: NDArray[Any] | None) -> Variation | None:
    """Parse the variation of an episode, or return None if there is none.

    Raises:
        ValueError: the text has a wrong format.
    """
    if text is None:
        return None
    if text.shape != () or text.dtype.kind != "U":
        raise ValueError(f"{VARIED} has to hold a text")
    try:
        return variation_of(str(text))
    except QueryError as error:
        raise ValueError(str(error)) from None


def situation_of(
    scene: Scene, objects: Sequence[str], poses: Floats, openings: Mapping[str, float], arms: Mapping[str, Arm]
) -> Situation:
    """Return the situation given by the poses of objects, shape (O, 7), and the states of the arms.

    `openings` are the openings of furniture, in metres or radians.
    """
    from prag_asp.physics.situation import Situation  # noqa: PLC0415 - verdicts are read without predicates

    placed = {entity: pose_of(row) for entity, row in zip(objects, poses.tolist(), strict=True)}
    return Situation(scene, placed, arms, openings)


def pose_of(row: list[float]) -> Pose:
    """Return the pose that seven numbers describe."""
    x, y, z, qx, qy, qz, qw = row
    return Pose((x, y, z), (qx, qy, qz, qw))


def _require_fitting(content: Mapping[str, NDArray[Any]]) -> None:
    """Check that the shapes and types of an episode's arrays are consistent.

    Raises:
        ValueError: the shape or type of an array does not match the others.
    """
    for name in ("times", "forces", "ends", *LISTS):
        if content[name].ndim != 1:
            raise ValueError(f"{name} has the shape {content[name].shape}; it has to be a list")
    frames, touches, robots = len(content["times"]), len(content["forces"]), len(content["robots"])
    shapes: dict[str, tuple[int, ...]] = {
        "times": (frames,),
        "joints": (frames, robots, 7),
        "widths": (frames, robots),
        "commands": (frames, robots, 8),
        "sizes": (len(content["objects"]), 3),
        "poses": (frames, len(content["objects"]), 7),
        "openings": (frames, len(content["furniture"])),
        "contacts": (touches, 3),
        "forces": (touches,),
        "ends": (len(content["ends"]),),
    }
    require_arrays(
        content, {name: (shape, "iu" if ARRAYS[name] is np.int32 else "iuf") for name, shape in shapes.items()}
    )
    if frames == 0 or (len(content["ends"]) and not 0 <= content["ends"].min() <= content["ends"].max() < frames):
        raise ValueError(f"ends has to hold numbers of frames; it has {frames} frames")
    limits = (frames, len(content["bodies"]), len(content["bodies"]))
    if ((content["contacts"] < 0) | (content["contacts"] >= limits)).any():
        raise ValueError("contacts has to hold a frame and the positions of two bodies")
    for name in TEXTS:
        if content[name].shape != () or content[name].dtype.kind != "U":
            raise ValueError(f"{name} has to hold a text")
