"""Film an episode: let cameras see every so many of its frames again."""

from __future__ import annotations

import math
from bisect import bisect_left
from collections.abc import Mapping, Sequence
from dataclasses import replace
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from prag_asp.physics.demonstration.demonstration import FRAMES_A_SECOND, Demonstration, pose_of
from prag_asp.physics.demonstration.footage import DEPTH, RGB, Film, Footage, Picture, segmentation_type
from prag_asp.physics.demonstration.packing import Packed, Packer
from prag_asp.physics.filming.episode_options import Staging
from prag_asp.physics.filming.studio import open_studio
from prag_asp.physics.robot.kinematics import tool_pose
from prag_asp.physics.witness import Moment
from prag_asp.scene.cameras import Camera
from prag_asp.scene.geometry import Pose, multiply
from prag_asp.scene.robots import robot_of
from prag_asp.scene.scene import Scene
from prag_asp.scene.variation import USUAL_LIGHT


def film(demonstration: Demonstration, scene: Scene, staging: Staging) -> Demonstration:
    """Return an episode with what cameras see of it; light, colours and cameras are those that were drawn for it.

    Each picture is compressed as it is taken: memory holds one of each camera, and what is compressed.

    Raises:
        QueryError: the scene has no such camera.
        SceneError: the scene does not allow the size of an object, or a robot cannot be loaded.
    """
    frames = range(0, len(demonstration.times), FRAMES_A_SECOND // staging.rate)
    footage = film_frames(demonstration, scene, staging.cameras_of(demonstration.sized_scene(scene)), frames)
    return replace(demonstration, footage=footage)


def film_frames(
    demonstration: Demonstration, scene: Scene, cameras: Mapping[str, Camera], frames: Sequence[int]
) -> Footage:
    """Return what cameras see in some frames of an episode.

    Raises:
        SceneError: the scene does not allow the size of an object, or a robot cannot be loaded.
    """
    drawn = demonstration.variation
    light = USUAL_LIGHT if drawn is None or drawn.light is None else drawn.light
    tools = [_tools(demonstration, scene, frame) for frame in frames]
    with open_studio(demonstration.sized_scene(scene), demonstration.objects, light) as studio:
        reels = {name: _FilmRecorder(camera, len(frames), studio.legend) for name, camera in cameras.items()}
        for frame in frames:
            studio.show(moment_of(demonstration, frame))
            for reel in reels.values():
                reel.add(studio.take(reel.camera), studio.pose(reel.camera))
        legend = studio.legend
    return Footage(
        frames=np.array(frames, dtype=np.int32),
        tools=np.array([[[*p.position, *p.quaternion] for p in row] for row in tools], dtype=np.float32),
        deltas=_deltas(tools),
        grippers=demonstration.widths[list(frames)],
        subgoals=np.array([subgoal_at(demonstration, frame) for frame in frames], dtype=np.int32),
        legend=legend,
        films={name: reel.film() for name, reel in reels.items()},
    )


def subgoal_at(demonstration: Demonstration, frame: int) -> int:
    """Return which subgoal is being worked for in a frame, 0 the first."""
    ends = demonstration.ends.tolist()
    return max(0, min(bisect_left(ends, frame), len(ends) - 1) - 1)


def moment_of(demonstration: Demonstration, frame: int) -> Moment:
    """Return what a frame of a demonstration shows."""
    poses = dict(zip(demonstration.objects, map(pose_of, demonstration.poses[frame].tolist()), strict=True))
    return Moment(poses, demonstration.arms(frame), demonstration.openings_at(frame))


class _FilmRecorder:
    """The film of a camera that is being taken."""

    def __init__(self, camera: Camera, count: int, legend: Sequence[str]):
        width, height = camera.size
        pixels = (height, width)
        self.camera = camera
        self._packers = (
            Packer(count, (*pixels, 3), RGB),
            Packer(count, pixels, DEPTH),
            Packer(count, pixels, segmentation_type(legend)),
        )
        self._poses: list[NDArray[np.float64]] = []

    def add(self, picture: Picture, pose: NDArray[np.float64]) -> None:
        """Add a picture, and where the camera was."""
        for packer, name in zip(self._packers, Picture._fields, strict=True):
            packer.add(getattr(picture, name))
        self._poses.append(pose)

    def film(self) -> Film:
        """Return the film, of which all pictures are there."""
        rgb, depth, segmentation = (packer.finish() for packer in self._packers)
        packed: tuple[Packed, Packed, Packed] = (rgb, depth, segmentation)
        camera = self.camera
        return Film(
            camera.intrinsics.astype(np.float32),
            np.array(self._poses, dtype=np.float32),
            np.array([camera.near, camera.far], dtype=np.float32),
            packed,
        )


def _tools(demonstration: Demonstration, scene: Scene, frame: int) -> list[Pose]:
    """Return where the tool of each robot is in a frame."""
    return [tool_pose(robot_of(scene, name), arm.joints) for name, arm in demonstration.arms(frame).items()]


def _deltas(tools: Sequence[Sequence[Pose]]) -> NDArray[np.float32]:
    """Return how tools move from each picture to the next, not at all after the last, shape (N, R, 6)."""
    rows = [[_moved(*pair) for pair in zip(*pictures, strict=True)] for pictures in pairwise(tools)]
    rows.append([[0.0] * 6 for _ in tools[0]])
    return np.array(rows, dtype=np.float32)


def _moved(before: Pose, after: Pose) -> list[float]:
    """Return the way from one pose to another: metres, and a rotation vector in radians."""
    x, y, z, w = before.quaternion
    x, y, z, w = multiply(after.quaternion, (-x, -y, -z, w))
    length = math.hypot(x, y, z)
    angle = 2 * math.atan2(length, w) if w >= 0 else -2 * math.atan2(length, -w)
    scale = angle / length if length else 0.0
    way = [end - begin for begin, end in zip(before.position, after.position, strict=True)]
    return [*way, x * scale, y * scale, z * scale]
