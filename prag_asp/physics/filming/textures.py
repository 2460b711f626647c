"""Procedural textures as brightness factors with mean 1: planks of wood for the table, concrete for the floor.

Both are made from value noise with fixed seeds on a periodic lattice, so they repeat without a seam.
"""

from __future__ import annotations

from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float32]

TEXELS = 1024
"""The number of texels along a side of a texture: a power of two, so that copies can be halved."""

WOOD_SIDE, FLOOR_SIDE = 1.6, 2.4
"""The side in metres of the square that a texture covers, for which a plank has the usual width of 10 cm."""

PLANKS, SEAM = 16, 2
"""The number of planks in the texture, and the width in texels of the groove between two planks, which is 3 mm."""


class Texture(NamedTuple):
    """Copies of a texture, each at half the resolution of the previous copy, and the side that they cover in metres."""

    levels: tuple[Floats, ...]
    side: float

    def at(self, x: Floats, y: Floats, pixel: float) -> Floats:
        """Return the factors at points given in metres; `pixel` is the size of a pixel at the points, in metres.

        The copy whose texels are about as large as a pixel is used, so that images do not flicker.
        """
        finest = self.side / TEXELS
        level = min(max(0, round(float(np.log2(max(pixel, finest) / finest)))), len(self.levels) - 1)
        texels = self.levels[level]
        scale = np.float32(len(texels) / self.side)
        rows = np.floor(y * scale).astype(np.int32) & (len(texels) - 1)
        columns = np.floor(x * scale).astype(np.int32) & (len(texels) - 1)
        found: Floats = texels[rows, columns]
        return found


@lru_cache(maxsize=1)
def wood() -> Texture:
    """Return planks of wood along y, each with its own brightness and grain."""
    rng = np.random.default_rng(1)
    columns = np.arange(TEXELS)
    planks = columns * PLANKS // TEXELS
    shift = rng.integers(TEXELS, size=PLANKS)[planks]
    rows = (np.arange(TEXELS)[:, None] + shift[None, :]) % TEXELS
    waves = _noise(rng, 6, 32)[rows, columns]
    rings = np.sin(2 * np.pi * (columns * 70 / TEXELS + 5.0 * waves))
    fibres = _noise(rng, 24, 512)[rows, columns] + 0.7 * _noise(rng, 8, 128)[rows, columns]
    tone = rng.normal(size=PLANKS)[planks]
    factors = 1.0 + 0.025 * rings + 0.045 * fibres + 0.03 * tone
    factors[:, columns % (TEXELS // PLANKS) < SEAM] *= 0.80
    return _texture(factors, WOOD_SIDE)


@lru_cache(maxsize=1)
def concrete() -> Texture:
    """Return a floor of concrete: spots of several sizes."""
    rng = np.random.default_rng(2)
    spots = np.sum([_noise(rng, cells, cells) for cells in (8, 32, 128, 512)], axis=0)
    return _texture(1.0 + 0.02 * spots, FLOOR_SIDE)


def _texture(factors: NDArray[np.float64], side: float) -> Texture:
    """Return a texture together with its halved copies."""
    level = (factors / factors.mean()).astype(np.float32)
    levels = [level]
    while len(level) > 1:
        level = (level[::2, ::2] + level[1::2, ::2] + level[::2, 1::2] + level[1::2, 1::2]) / np.float32(4.0)
        levels.append(level)
    return Texture(tuple(levels), side)


def _noise(rng: np.random.Generator, rows: int, columns: int) -> NDArray[np.float64]:
    """Return value noise from -1 to 1 on a periodic lattice (Perlin's smooth step between random values)."""
    values = rng.uniform(-1.0, 1.0, size=(rows, columns))
    for axis, cells in enumerate((rows, columns)):
        place = np.arange(TEXELS) * cells / TEXELS
        low = place.astype(np.int64)
        share = place - low
        share = share * share * (3.0 - 2.0 * share)
        share = share[:, None] if axis == 0 else share[None, :]
        before, after = values.take(low, axis), values.take((low + 1) % cells, axis)
        values = before + (after - before) * share
    return values
