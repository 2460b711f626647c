"""Render the camera images of an episode at a given frame rate."""

from __future__ import annotations

import math
from bisect import bisect_left
from collections.abc import Mapping, Sequence
from dataclasses import replace
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from prag_asp.physics.demonstration.demonstration import FRAMES_A_SECOND, Demonstration, pose_of
from prag_asp.physics.demonstration.footage import DEPTH, RGB, CameraImage, CameraVideo, Footage, segmentation_type
from prag_asp.physics.demonstration.packed_arrays import Packed, Packer
from prag_asp.physics.filming.episode_options import Staging
from prag_asp.physics.filming.studio import open_studio
from prag_asp.physics.robot.kinematics import tool_pose
from prag_asp.physics.witness import Moment
from prag_asp.scene.cameras import Camera
from prag_asp.scene.geometry import Pose, multiply
from prag_asp.scene.robots import robot_of
from prag_asp.scene.scene import Scene
from prag_asp.scene.variation import USUAL_LIGHT


def render_cameras(demonstration: Demonstration, scene: Scene, staging: Staging) -> Demonstration:
    """Return an episode with camera images; its variation determines the light, the colours and the cameras.

    Each image is compressed when it is taken, so only one uncompressed image per camera is in memory.

    Raises:
        QueryError: the scene lacks one of the cameras.
        SceneError: the scene does not allow the size of an object, or a robot cannot be loaded.
    """
    frames = range(0, len(demonstration.times), FRAMES_A_SECOND // staging.rate)
    footage = render_frames(demonstration, scene, staging.cameras_of(demonstration.sized_scene(scene)), frames)
    return replace(demonstration, footage=footage)


def render_frames(
    demonstration: Demonstration, scene: Scene, cameras: Mapping[str, Camera], frames: Sequence[int]
) -> Footage:
    """Return the camera images for the selected frames of an episode.

    Raises:
        SceneError: the scene does not allow the size of an object, or a robot cannot be loaded.
    """
    variation = demonstration.variation
    light = USUAL_LIGHT if variation is None or variation.light is None else variation.light
    arms = [demonstration.arms(frame) for frame in frames]
    tools = [[tool_pose(robot_of(scene, name), arm.joints) for name, arm in row.items()] for row in arms]
    deltas = [[_motion(*pair) for pair in zip(*both, strict=True)] for both in pairwise(tools)]
    deltas.append([[0.0] * 6 for _ in tools[0]])  # no motion after the last image
    with open_studio(demonstration.sized_scene(scene), demonstration.objects, light) as studio:
        recorders = {name: _VideoRecorder(camera, len(frames), studio.legend) for name, camera in cameras.items()}
        for frame in frames:
            studio.show(moment_of(demonstration, frame))
            for each in recorders.values():
                each.add(studio.take(each.camera), studio.pose(each.camera))
        legend = studio.legend
    return Footage(
        frames=np.array(frames, dtype=np.int32),
        tools=np.array([[[*p.position, *p.quaternion] for p in row] for row in tools], dtype=np.float32),
        deltas=np.array(deltas, dtype=np.float32),
        grippers=demonstration.widths[list(frames)],
        subgoals=np.array([subgoal_at(demonstration, frame) for frame in frames], dtype=np.int32),
        legend=legend,
        videos={name: each.video() for name, each in recorders.items()},
    )


def subgoal_at(demonstration: Demonstration, frame: int) -> int:
    """Return the index of the current subgoal in a frame."""
    ends = demonstration.ends.tolist()
    return max(0, min(bisect_left(ends, frame), len(ends) - 1) - 1)


def moment_of(demonstration: Demonstration, frame: int) -> Moment:
    """Return a frame of an episode as a `Moment`."""
    poses = dict(zip(demonstration.objects, map(pose_of, demonstration.poses[frame].tolist()), strict=True))
    return Moment(poses, demonstration.arms(frame), demonstration.openings_at(frame))


class _VideoRecorder:
    """A recorder of the images from one camera."""

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

    def add(self, image: CameraImage, pose: NDArray[np.float64]) -> None:
        """Add an image, and the pose of the camera."""
        for packer, name in zip(self._packers, CameraImage._fields, strict=True):
            packer.add(getattr(image, name))
        self._poses.append(pose)

    def video(self) -> CameraVideo:
        """Return the video, once all images have been added."""
        rgb, depth, segmentation = (packer.finish() for packer in self._packers)
        packed: tuple[Packed, Packed, Packed] = (rgb, depth, segmentation)
        camera = self.camera
        return CameraVideo(
            camera.intrinsics.astype(np.float32),
            np.array(self._poses, dtype=np.float32),
            np.array([camera.near, camera.far], dtype=np.float32),
            packed,
        )


def _motion(before: Pose, after: Pose) -> list[float]:
    """Return the motion from one pose to another: a translation in metres, and a rotation vector in radians."""
    x, y, z, w = before.quaternion
    x, y, z, w = multiply(after.quaternion, (-x, -y, -z, w))
    length = math.hypot(x, y, z)
    angle = 2 * math.atan2(length, w) if w >= 0 else -2 * math.atan2(length, -w)
    scale = angle / length if length else 0.0
    way = [end - begin for begin, end in zip(before.position, after.position, strict=True)]
    return [*way, x * scale, y * scale, z * scale]
