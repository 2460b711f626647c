"""A strip of camera images from an episode, for notebooks: the first image, and the last image of each subgoal."""

from __future__ import annotations

from base64 import b64encode
from importlib.util import find_spec
from io import BytesIO
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from prag_asp.physics.demonstration.footage import Footage

MOST_IMAGES, WIDTH = 8, 160
"""The maximum number of images in a strip, and the maximum width of an image in pixels."""


def strip_url(footage: Footage) -> str | None:
    """Return the strip for the first camera as a data URL of a PNG image, or None if there is no video or no Pillow."""
    if not footage.videos or find_spec("PIL") is None:
        return None
    from PIL import Image  # noqa: PLC0415 - an optional dependency

    images = next(iter(footage.videos.values())).rgb
    ends = np.flatnonzero(np.diff(footage.subgoals, append=-1))
    chosen = [images[0], *(images[end] for end in ends[: MOST_IMAGES - 1])]
    step = -(-images.shape[2] // WIDTH)
    row = np.concatenate([np.pad(image[::step, ::step], ((0, 0), (0, 4), (0, 0))) for image in chosen], axis=1)
    file = BytesIO()
    Image.fromarray(row).save(file, format="PNG")
    return f"data:image/png;base64,{b64encode(file.getvalue()).decode()}"
