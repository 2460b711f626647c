"""The camera recordings of an episode: videos, and the motion of the grippers between images."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, fields
from typing import Any, BinaryIO, NamedTuple

import numpy as np
from numpy.typing import NDArray

from prag_asp.array_archive import BadArchive, read_arrays
from prag_asp.physics.demonstration.packed_arrays import Packed, read_packed

RGB, DEPTH = "u1", "<f2"
"""The types of stored images: a depth has eleven significant bits, which give a precision of half a millimetre at 1 m.
"""

BYTES = 256

NOTHING = "nothing"
"""The name in the legend for pixels that show no entity."""

LISTS = ("frames", "tools", "deltas", "grippers", "subgoals", "legend", "cameras")
OF_CAMERA = ("intrinsics", "extrinsics", "limits")
PIXEL_LIMIT = 4096


def segmentation_type(legend: Sequence[str]) -> str:
    """Return the data type of indices into a legend."""
    return "u1" if len(legend) <= BYTES else "<u2"


def are_equal(one: Any, other: Any) -> bool:
    """Return whether all fields of two instances of a dataclass are equal, with arrays compared bit by bit."""
    pairs = ((getattr(one, each.name), getattr(other, each.name)) for each in fields(one))
    return all(np.array_equal(a, b) if isinstance(a, np.ndarray) else bool(a == b) for a, b in pairs)


class CameraImage(NamedTuple):
    """A camera image: `rgb` (H, W, 3), `depth` (H, W) in metres, and `segmentation` (H, W).

    The depth is measured along the axis of the camera, and is 0 for the background. The segmentation consists of
    indices into the legend.
    """

    rgb: NDArray[np.uint8]
    depth: NDArray[np.float16]
    segmentation: NDArray[np.unsignedinteger[Any]]


@dataclass(frozen=True)
class CameraVideo:
    """The video from one camera: N images of H x W pixels; see `CameraImage`.

    `intrinsics` (3, 3) contains fx, fy, cx and cy in pixels; `extrinsics` (N, 4, 4) contains the poses of the camera in
    the scene in metres, with x to the right, y down and z forwards; `limits` (2,) are the distances of the near and far
    planes in metres.
    """

    intrinsics: NDArray[np.float32]
    extrinsics: NDArray[np.float32]
    limits: NDArray[np.float32]
    packed: tuple[Packed, Packed, Packed]

    @property
    def size(self) -> tuple[int, int]:
        """The width and height of an image in pixels."""
        _, height, width = self.packed[1].shape
        return width, height

    @property
    def rgb(self) -> NDArray[np.uint8]:
        """All colour images, shape (N, H, W, 3)."""
        return self.packed[0].array()

    @property
    def depth(self) -> NDArray[np.float16]:
        """All depth images in metres, shape (N, H, W)."""
        return self.packed[1].array()

    @property
    def segmentation(self) -> NDArray[np.unsignedinteger[Any]]:
        """The entity of each pixel as an index into the legend, shape (N, H, W)."""
        return self.packed[2].array()

    def images(self) -> Iterator[CameraImage]:
        """Yield the images in turn, unpacking one at a time."""
        for rgb, depth, segmentation in zip(*(each.rows() for each in self.packed), strict=True):
            yield CameraImage(rgb, depth, segmentation)

    def __eq__(self, other: object) -> bool:
        """Return whether two videos are equal, bit by bit."""
        return are_equal(self, other) if isinstance(other, CameraVideo) else NotImplemented

    __hash__ = None  # type: ignore[assignment]


@dataclass(frozen=True, eq=False)
class Footage:
    """The videos of an episode by camera name, and the motion of its R robots at each of the N images.

    `frames` (N,) are the frames of the episode of which images were taken; `tools` (N, R, 7) are the tool poses as x,
    y, z in metres and a quaternion x, y, z, w; `deltas` (N, R, 6) are the motions of the tools until the next image: a
    translation in metres and a rotation vector in radians, both along the axes of the scene; `grippers` (N, R) are the
    openings in metres; `subgoals` (N,) are the indices of the current subgoals. `legend` holds the names that the
    numbers in the segmentation stand for.
    """

    frames: NDArray[np.int32]
    tools: NDArray[np.float32]
    deltas: NDArray[np.float32]
    grippers: NDArray[np.float32]
    subgoals: NDArray[np.int32]
    legend: tuple[str, ...]
    videos: Mapping[str, CameraVideo]

    def __eq__(self, other: object) -> bool:
        """Return whether two instances are equal, bit by bit."""
        return are_equal(self, other) if isinstance(other, Footage) else NotImplemented

    __hash__ = None  # type: ignore[assignment]

    def arrays(self) -> dict[str, NDArray[Any]]:
        """Return the small arrays of the file."""
        result: dict[str, NDArray[Any]] = {name: getattr(self, name) for name in LISTS[:5]}
        result |= {"legend": np.array(self.legend), "cameras": np.array(tuple(self.videos))}
        for name, video in self.videos.items():
            result |= {f"{name}/{each}": getattr(video, each) for each in OF_CAMERA}
        return result

    def packed_arrays(self) -> dict[str, Packed]:
        """Return the large arrays of the file, compressed."""
        return {
            f"{name}/{what}": packed
            for name, video in self.videos.items()
            for what, packed in zip(CameraImage._fields, video.packed, strict=True)
        }


def read_footage(file: BinaryIO, frames: int, robots: int, at_most: int) -> Footage | None:
    """Return the footage of an episode with the given numbers of frames and robots, or None if it has no footage.

    `at_most` limits the size in bytes of the arrays that contain no images.

    Raises:
        OSError: the file cannot be read.
        BadArchive: the videos have a wrong format.
        ValueError: the footage does not match the episode.
    """
    lists = read_arrays(file, LISTS, at_most)
    if not lists:
        return None
    for name in LISTS:
        if name not in lists:
            raise BadArchive(f"it has no {name}")
    for name in ("legend", "cameras"):
        if lists[name].ndim != 1 or lists[name].dtype.kind != "U":
            raise ValueError(f"{name} has to hold a list of names")
    legend, cameras = (tuple(map(str, lists[name].tolist())) for name in ("legend", "cameras"))
    count = len(lists["frames"]) if lists["frames"].ndim == 1 else -1
    required = {
        "frames": ((count,), "iu"),
        "tools": ((count, robots, 7), "f"),
        "deltas": ((count, robots, 6), "f"),
        "grippers": ((count, robots), "f"),
        "subgoals": ((count,), "iu"),
    }
    require_arrays(lists, required)
    if count < 1 or not 0 <= lists["frames"].min() <= lists["frames"].max() < frames:
        raise ValueError(f"frames has to hold numbers of frames; it has {frames} frames")
    videos = {name: _video(file, name, count, segmentation_type(legend), at_most) for name in cameras}
    arrays: dict[str, Any] = {
        name: lists[name].astype(np.int32 if kinds == "iu" else np.float32) for name, (_, kinds) in required.items()
    }
    return Footage(**arrays, legend=legend, videos=videos)


def _video(file: BinaryIO, camera: str, count: int, segmented: str, at_most: int) -> CameraVideo:
    """Return the video from one camera.

    Raises:
        BadArchive: an array of the video is missing or has a wrong format.
        ValueError: the video does not match the others.
    """
    names = [f"{camera}/{name}" for name in OF_CAMERA]
    content = read_arrays(file, names, at_most)
    shapes = [(3, 3), (count, 4, 4), (2,)]
    require_arrays(content, {name: (shape, "f") for name, shape in zip(names, shapes, strict=True)})
    intrinsics, extrinsics, limits = (content[name].astype(np.float32) for name in names)
    # The principal point is the centre of the image.
    width, height = (round(2 * float(intrinsics[i, 2])) for i in (0, 1))
    if not (0 < width <= PIXEL_LIMIT and 0 < height <= PIXEL_LIMIT):
        raise ValueError(f"{camera}/intrinsics is for images of {width} x {height} pixels")
    pixels = (count, height, width)
    forms = (((*pixels, 3), RGB), (pixels, DEPTH), (pixels, segmented))
    packed = read_packed(file, dict(zip((f"{camera}/{name}" for name in CameraImage._fields), forms, strict=True)))
    rgb, depth, segmentation = packed.values()
    return CameraVideo(intrinsics, extrinsics, limits, (rgb, depth, segmentation))


def require_arrays(content: Mapping[str, NDArray[Any]], required: Mapping[str, tuple[tuple[int, ...], str]]) -> None:
    """Check the shapes and types of arrays; a type is given by its possible NumPy kinds.

    Raises:
        BadArchive: an array is missing.
        ValueError: an array has a wrong shape or type.
    """
    for name, (shape, kinds) in required.items():
        if name not in content:
            raise BadArchive(f"it has no {name}")
        if content[name].shape != shape:
            raise ValueError(f"{name} has the shape {content[name].shape} in place of {shape}")
        if content[name].dtype.kind not in kinds or not np.isfinite(content[name]).all():
            raise ValueError(f"{name} has to hold {'whole' if kinds == 'iu' else 'finite'} numbers")
