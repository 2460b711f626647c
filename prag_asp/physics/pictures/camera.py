"""Take a picture of a moment with PyBullet's software renderer."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from prag_asp.errors import PicturesMissingError
from prag_asp.physics.bullet import pybullet
from prag_asp.physics.witness import Moment
from prag_asp.physics.world.simulator import Simulator
from prag_asp.scene.boxes import Vector
from prag_asp.scene.cameras import FIELD_OF_VIEW, fitted
from prag_asp.scene.model import Scene
from prag_asp.scene.variation import USUAL_LIGHT

if TYPE_CHECKING:
    from PIL import Image

ABOVE_TABLE, ABOVE_BASE = 0.06, 0.78
"""How high over the table things stand, and the elbow of a robot over its base, in metres."""

LIGHT_DISTANCE = 3.0
SKY, GROUND = (247, 249, 252), (214, 221, 230)
OVERSAMPLING = 2


def picture(simulator: Simulator, moment: Moment, size: tuple[int, int]) -> Image.Image:
    """Return one state as a picture of `size` pixels; the simulator must have been opened with `visual`."""
    image_type = pillow()
    simulator.show(moment)
    pixels = _render(simulator, (size[0] * OVERSAMPLING, size[1] * OVERSAMPLING))
    image: Image.Image = image_type.fromarray(pixels).resize(size, image_type.Resampling.LANCZOS)
    return image


def pillow() -> Any:
    """Return Pillow's module of images.

    Raises:
        PicturesMissingError: it is not installed.
    """
    try:
        from PIL import Image  # noqa: PLC0415 - pictures are optional
    except ImportError as error:
        raise PicturesMissingError('pictures need Pillow: pip install "prag_asp[pictures]"') from error
    return Image


def _render(simulator: Simulator, size: tuple[int, int]) -> NDArray[np.uint8]:
    """Return what the camera sees before a gradient, shape (height, width, 3)."""
    width, height = size
    eye, target = viewpoint(simulator.scene, width / height)
    view = pybullet.computeViewMatrix(eye, target, (0.0, 0.0, 1.0))
    projection = pybullet.computeProjectionMatrixFOV(FIELD_OF_VIEW, width / height, 0.1, 5.0)
    result = pybullet.getCameraImage(
        width,
        height,
        view,
        projection,
        lightDirection=USUAL_LIGHT,
        lightAmbientCoeff=0.62,
        lightDiffuseCoeff=0.42,
        lightSpecularCoeff=0.12,
        lightDistance=LIGHT_DISTANCE,
        shadow=True,
        renderer=pybullet.ER_TINY_RENDERER,
        physicsClientId=simulator.client,
    )
    # A PyBullet that was built without NumPy returns flat tuples.
    colors: NDArray[np.uint8] = np.asarray(result[2], dtype=np.uint8).reshape(height, width, 4)[:, :, :3].copy()
    nothing = np.asarray(result[4], dtype=np.int64).reshape(height, width) < 0
    share = np.linspace(0.0, 1.0, height)[:, None]
    rows = np.asarray(SKY) * (1 - share) + np.asarray(GROUND) * share
    gradient = np.broadcast_to(rows[:, None, :], (height, width, 3)).astype(np.uint8)
    colors[nothing] = gradient[nothing]
    return colors


def viewpoint(scene: Scene, aspect: float) -> tuple[Vector, Vector]:
    """Return where the eye of a picture is and what it looks at, in metres: all of the workspace and the robot."""
    low_x, high_x, low_y, high_y = scene.workspace
    corners = [(x, y, z) for x in (low_x, high_x) for y in (low_y, high_y) for z in (0.0, ABOVE_TABLE)]
    bases = [(mount.x, mount.y) for mount in scene.robots.values()]
    robots = [(x, y, z) for x, y in bases for z in (0.0, ABOVE_BASE)]
    if len(bases) > 1:  # the elbows of several arms swing out to the sides
        robots += [(x, y + side, ABOVE_BASE / 2) for x, y in bases for side in (-ABOVE_BASE / 2, ABOVE_BASE / 2)]
    return fitted((*corners, *robots), aspect)
