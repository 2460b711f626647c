"""Perceptual colours in CIELAB, where equal distances look equally large.

The distance is the Delta E of 1976: from about 10 on, colours differ at a glance; from 20 on, most have different
names.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

TO_XYZ = np.array(
    [[0.4124564, 0.3575761, 0.1804375], [0.2126729, 0.7151522, 0.0721750], [0.0193339, 0.119192, 0.9503041]]
)
"""The matrix from linear sRGB (IEC 61966-2-1) to XYZ, for daylight D65."""

DAYLIGHT = TO_XYZ.sum(axis=1)
EDGE = 6 / 29
WHITE = "#ffffff"
"""The colour that leaves a body as it looks in its file, because the visual parts are multiplied by the body's
colour."""

LEVELS = (0x10, 0x38, 0x60, 0x88, 0xB0, 0xD8, 0xF8)
"""The levels of red, green and blue that `more_colours` combines."""

LIGHTNESS, CHROMA = (28.0, 88.0), (28.0, 90.0)
"""The ranges of lightness and chroma for the colours of objects: they exclude the grey of robots and trays, and the
most saturated blue of a screen."""


def rgb(color: str) -> tuple[int, int, int]:
    """Return the red, green and blue components of a colour like ``#e4572e``, from 0 to 255."""
    return int(color[1:3], 16), int(color[3:5], 16), int(color[5:7], 16)


@lru_cache(maxsize=256)
def to_lab(color: str) -> NDArray[np.float64]:
    """Return the CIELAB components (lightness, a and b) of a colour like ``#e4572e``."""
    lab: NDArray[np.float64] = _lab(np.array([rgb(color)]))[0]
    return lab


def from_lab(lab: NDArray[np.float64]) -> str:
    """Return the sRGB colour, like ``#e4572e``, of CIELAB components (lightness, a and b), clipped to valid values."""
    y = (lab[0] + 16) / 116
    bent = np.array([y + lab[1] / 500, y, y - lab[2] / 200])
    xyz = DAYLIGHT * np.where(bent > EDGE, bent**3, 3 * EDGE**2 * (bent - 4 / 29))
    linear = np.clip(np.linalg.solve(TO_XYZ, xyz), 0.0, 1.0)
    bright = np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055)
    return "#" + "".join(f"{round(255 * part):02x}" for part in bright.tolist())


def apart(one: str, two: str) -> float:
    """Return the perceptual difference of two colours: Delta E."""
    return float(np.linalg.norm(to_lab(one) - to_lab(two)))


@lru_cache(maxsize=64)
def more_colours(taken: Sequence[str], count: int) -> tuple[str, ...]:
    """Return `count` colours, each as different as possible from the colours already taken or chosen.

    The method is farthest-point-first (Gonzalez, "Clustering to minimize the maximum intercluster distance", 1985).
    """
    colors = np.array([(red, green, blue) for red in LEVELS for green in LEVELS for blue in LEVELS])
    lab = _lab(colors)
    chroma = np.hypot(lab[:, 1], lab[:, 2])
    fine = np.ones(len(lab), dtype=bool)
    for values, (low, high) in ((lab[:, 0], LIGHTNESS), (chroma, CHROMA)):
        fine &= (values >= low) & (values <= high)
    colors, lab = colors[fine], lab[fine]
    nearest = np.full(len(lab), np.inf)
    for color in taken:
        nearest = np.minimum(nearest, np.linalg.norm(lab - to_lab(color), axis=1))
    result = []
    for _ in range(count):
        best = int(nearest.argmax())
        nearest = np.minimum(nearest, np.linalg.norm(lab - lab[best], axis=1))
        red, green, blue = colors[best].tolist()
        result.append(f"#{red:02x}{green:02x}{blue:02x}")
    return tuple(result)


def _lab(colors: NDArray[np.int64]) -> NDArray[np.float64]:
    """Return the CIELAB components, shape (N, 3), of colours given by red, green and blue from 0 to 255."""
    bright = colors / 255
    linear = np.where(bright <= 0.04045, bright / 12.92, ((bright + 0.055) / 1.055) ** 2.4)
    xyz = linear @ TO_XYZ.T / DAYLIGHT
    bent = np.where(xyz > EDGE**3, np.cbrt(xyz), xyz / (3 * EDGE**2) + 4 / 29)
    x, y, z = bent.T
    return np.stack([116 * y - 16, 500 * (x - y), 200 * (y - z)], axis=1)
