"""Take pictures of moments: rendered larger than needed, then reduced, so that edges are smooth."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from prag_asp.errors import PicturesMissingError
from prag_asp.physics.demonstration.footage import CameraImage
from prag_asp.physics.filming.studio import Studio
from prag_asp.physics.pictures.views import View
from prag_asp.scene.cameras import FIELD_OF_VIEW, Camera

if TYPE_CHECKING:
    from PIL import Image

OVERSAMPLING = 2
"""The factor by which a picture is rendered larger than needed; scaling it down smooths its edges."""

NEAR, FAR = 0.1, 10.0
"""The distances in metres of the clipping planes for pictures."""


def view_camera(view: View, size: tuple[int, int], oversampling: int = OVERSAMPLING) -> Camera:
    """Return the camera for pictures from a view; `size` is in pixels."""
    return Camera(*view, FIELD_OF_VIEW, size=(size[0] * oversampling, size[1] * oversampling), near=NEAR, far=FAR)


def picture(studio: Studio, size: tuple[int, int], view: View) -> Image.Image:
    """Return a picture of the moment that the studio shows; `size` is in pixels."""
    return reduced(studio.take(view_camera(view, size)), size)


def reduced(taken: CameraImage, size: tuple[int, int]) -> Image.Image:
    """Return the colours of an image, scaled down to a size in pixels."""
    image_type = pillow()
    image: Image.Image = image_type.fromarray(taken.rgb).resize(size, image_type.Resampling.BOX)
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
