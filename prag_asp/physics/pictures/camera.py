"""Render a moment with PyBullet's software renderer, in front of a gradient."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from prag_asp.errors import PicturesMissingError
from prag_asp.physics.bullet import pybullet
from prag_asp.physics.filming.backdrop import AMBIENT, DIFFUSE, SPECULAR, sky
from prag_asp.physics.filming.studio import LIGHT_DISTANCE
from prag_asp.physics.pictures.views import View
from prag_asp.physics.witness import Moment
from prag_asp.physics.world.simulator import Simulator
from prag_asp.scene.cameras import FIELD_OF_VIEW
from prag_asp.scene.variation import USUAL_LIGHT

if TYPE_CHECKING:
    from PIL import Image

OVERSAMPLING = 2
"""The factor by which a picture is rendered larger than needed; scaling it down smooths its edges."""


def picture(simulator: Simulator, moment: Moment, size: tuple[int, int], view: View) -> Image.Image:
    """Return a picture of a moment, `size` in pixels; the simulator must have been opened with `visual`."""
    image_type = pillow()
    simulator.show(moment)
    width, height = size[0] * OVERSAMPLING, size[1] * OVERSAMPLING
    result = pybullet.getCameraImage(
        width,
        height,
        pybullet.computeViewMatrix(*view, (0.0, 0.0, 1.0)),
        pybullet.computeProjectionMatrixFOV(FIELD_OF_VIEW, width / height, 0.1, 5.0),
        lightDirection=USUAL_LIGHT,
        lightAmbientCoeff=AMBIENT,
        lightDiffuseCoeff=DIFFUSE,
        lightSpecularCoeff=SPECULAR,
        lightDistance=LIGHT_DISTANCE,
        shadow=True,
        renderer=pybullet.ER_TINY_RENDERER,
        physicsClientId=simulator.client,
    )
    # A PyBullet that was built without NumPy returns flat tuples.
    colors = np.asarray(result[2], dtype=np.uint8).reshape(height, width, 4)[:, :, :3].copy()
    nothing = np.asarray(result[4], dtype=np.int64).reshape(height, width) < 0
    colors[nothing] = sky((width, height))[nothing]
    image: Image.Image = image_type.fromarray(colors).resize(size, image_type.Resampling.LANCZOS)
    return image


def pillow() -> Any:
    """Return Pillow's image module.

    Raises:
        PicturesMissingError: Pillow is not installed.
    """
    try:
        from PIL import Image  # noqa: PLC0415 - pictures are optional
    except ImportError as error:
        raise PicturesMissingError('pictures need Pillow: pip install "prag_asp[pictures]"') from error
    return Image
