"""A visible surface: triangles of the same material."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


class Surface(NamedTuple):
    """Triangles of the same material; without a colour or a texture, they have the colour of their entity.

    `corners` and `normals` have the shape (n, 3, 3); `places`, which are the texture coordinates of the corners, have
    the shape (n, 3, 2) and range from 0 at the lower left to 1 at the upper right. `normals` and `places` are None if
    the file has none. `color` is ``#rrggbb``, `texture` the content of an image file, and `suffix` the suffix of its
    name.
    """

    corners: Floats
    normals: Floats | None = None
    places: Floats | None = None
    color: str = ""
    texture: bytes = b""
    suffix: str = ".png"


def hex_color(red: float, green: float, blue: float) -> str:
    """Return a colour like ``#e4572e`` from its components between 0 and 1."""
    return "#" + "".join(f"{round(255 * min(1.0, max(0.0, part))):02x}" for part in (red, green, blue))
