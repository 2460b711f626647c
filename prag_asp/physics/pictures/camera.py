"""Render a moment with PyBullet's software renderer."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from prag_asp.errors import PicturesMissingError
from prag_asp.physics.bullet import pybullet
from prag_asp.physics.pictures.views import View
from prag_asp.physics.witness import Moment
from prag_asp.physics.world.simulator import Simulator
from prag_asp.scene.cameras import FIELD_OF_VIEW
from prag_asp.scene.variation import USUAL_LIGHT

if TYPE_CHECKING:
    from PIL import Image

LIGHT_DISTANCE = 3.0
SKY, GROUND = (247, 249, 252), (214, 221, 230)
OVERSAMPLING = 2


def picture(simulator: Simulator, moment: Moment, size: tuple[int, int], view: View) -> Image.Image:
    """Return a picture of a moment in `size` pixels; the simulator must have been opened with `visual`."""
    image_type = pillow()
    simulator.show(moment)
    pixels = _render(simulator, (size[0] * OVERSAMPLING, size[1] * OVERSAMPLING), view)
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


def _render(simulator: Simulator, size: tuple[int, int], seen_from: View) -> NDArray[np.uint8]:
    """Return the image of a camera in front of a gradient, shape (height, width, 3)."""
    width, height = size
    view = pybullet.computeViewMatrix(*seen_from, (0.0, 0.0, 1.0))
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
