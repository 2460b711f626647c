"""Check footage by rendering the episode again."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from prag_asp.errors import QueryError
from prag_asp.physics.demonstration.demonstration import Demonstration
from prag_asp.physics.demonstration.footage import OF_CAMERA, CameraVideo
from prag_asp.physics.filming.camera_rendering import render_frames
from prag_asp.scene.scene import Scene

NUMBERS = 1e-4
"""The tolerance for recomputed numbers, in metres, radians or pixels."""

ROUNDED = ("tools", "deltas", "grippers")
EXACT = ("subgoals", "legend")
COLOUR, DEPTH, SHARE = 8, 0.01, 0.02
"""The tolerances for a pixel's colour (0 to 255) and depth in metres, and the share of pixels that may exceed them,
because machines round differently."""


def check_footage(demonstration: Demonstration, scene: Scene) -> list[str]:
    """Return the differences of an episode's footage from the images that the scene's cameras should have recorded.

    Raises:
        SceneError: the scene does not allow the size of an object, or a robot cannot be loaded.
    """
    footage = demonstration.footage
    if footage is None:
        return []
    if demonstration.robots != tuple(scene.robots):
        return [f"it shows the robots {', '.join(demonstration.robots)}; the scene has {', '.join(scene.robots)}"]
    scene_cameras = demonstration.sized_scene(scene).cameras
    unknown = [f"the scene has no camera {name}" for name in footage.videos if name not in scene_cameras]
    cameras = {
        name: scene_cameras[name]._replace(size=each.size)
        for name, each in footage.videos.items()
        if name in scene_cameras
    }
    again = render_frames(demonstration, scene, cameras, footage.frames.tolist())
    differing = [
        name
        for name in ROUNDED
        if not np.allclose(getattr(footage, name), getattr(again, name), rtol=0.0, atol=NUMBERS)
    ]
    differing += [name for name in EXACT if not np.array_equal(getattr(footage, name), getattr(again, name))]
    faults = [f"{name} is not what the episode says" for name in differing]
    return [
        *unknown,
        *faults,
        *(f for name in cameras for f in _faults(name, footage.videos[name], again.videos[name])),
    ]


def _faults(camera: str, one: CameraVideo, two: CameraVideo) -> Iterator[str]:
    """Yield the differences of a video from the expected one, in the camera parameters and in the first wrong image."""
    for name in OF_CAMERA:
        if not np.allclose(getattr(one, name), getattr(two, name), rtol=0.0, atol=NUMBERS):
            yield f"{camera}/{name} is not that of the camera"
    try:
        for number, (seen, expected) in enumerate(zip(one.images(), two.images(), strict=True)):
            wrong = {
                "colours": np.abs(seen.rgb.astype(int) - expected.rgb).max(axis=-1) > COLOUR,
                "depth": ~(np.abs(seen.depth.astype(float) - expected.depth) <= DEPTH),
                "entities": seen.segmentation != expected.segmentation,
            }
            for what, pixels in wrong.items():
                if pixels.mean() > SHARE:
                    difference = f"differs in {what} by {pixels.mean():.0%} of its pixels from what the camera sees"
                    yield f"{camera}: picture {number} {difference}"
                    return
    except QueryError as error:
        yield f"{camera}: {error}"
