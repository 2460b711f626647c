"""Soft shadows, computed from a depth image taken by a camera at the light.

See Williams, "Casting curved shadows on curved surfaces", 1978. The farther a body is from the surface, the more the
edges of its shadow are blurred (Fernando, "Percentage-closer soft shadows", 2005).
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from prag_asp.physics.filming.textures import Floats
from prag_asp.scene.boxes import Vector
from prag_asp.scene.cameras import Camera
from prag_asp.scene.scene import Scene

AWAY = 6.0
"""The distance of the light in metres, at which its rays are nearly parallel."""

ABOVE, AROUND = 0.3, 0.9
"""The height in metres of the centre of the ball that the light's camera covers, and the least radius of this ball in
metres: the reach of a robot."""

NARROW, WIDE, FAR_BODY = 0.006, 0.045, 0.35
"""The blur of the shadows of near bodies and of bodies at the distance `FAR_BODY`, in metres."""

BIAS = 0.003
"""The distance in metres by which a body has to be nearer to the light than a surface to cast a shadow on it."""

SLIGHT = np.float32(1e-4)
"""A small number that avoids division by zero."""

TAPS = tuple((row, column) for row in (-1, 0, 1) for column in (-1, 0, 1))
"""The offsets, in texels, of the neighbours over which the shadow at a point on a body is averaged."""


def light_camera(scene: Scene, light: Vector, side: int) -> Camera:
    """Return the camera at the light, with `side` x `side` pixels; `light` is the direction to the light."""
    low_x, high_x, low_y, high_y = scene.workspace
    xs = (low_x, high_x, *(mount.x for mount in scene.robots.values()))
    ys = (low_y, high_y, *(mount.y for mount in scene.robots.values()))
    centre = ((min(xs) + max(xs)) / 2, (min(ys) + max(ys)) / 2, ABOVE)
    radius = max(AROUND, math.hypot(max(xs) - min(xs), max(ys) - min(ys)) / 2 + ABOVE)
    length = math.hypot(*light)
    eye = (
        centre[0] + AWAY * light[0] / length,
        centre[1] + AWAY * light[1] / length,
        centre[2] + AWAY * light[2] / length,
    )
    angle = 2 * math.degrees(math.asin(radius / AWAY))
    return Camera(eye, centre, angle, size=(side, side), near=AWAY - 2.5, far=AWAY + 2.5)


class LightPlaces(NamedTuple):
    """The places, in the light's image, of the points shown by given pixels.

    `pixels` (N,) are the numbers of the pixels, `texels` (N,) are the numbers of the texels in the light's image, and
    `depths` (N,) are the distances in metres from the light along its axis.
    """

    pixels: NDArray[np.int64]
    texels: NDArray[np.int32]
    depths: Floats


class ShadowMap:
    """The depth image from the light, and the shadows that it casts on the table."""

    def __init__(self, camera: Camera):
        self.camera = camera
        self._outside = np.linalg.inv(camera.pose).astype(np.float32)
        self._focal = np.float32(camera.intrinsics[0, 0])
        side = camera.size[0]
        x = (np.arange(side, dtype=np.float32) + np.float32(0.5 - side / 2)) / self._focal
        turn, eye = camera.pose[:3, :3].astype(np.float32), camera.pose[:3, 3].astype(np.float32)
        down = turn[2, 0] * x[None, :] + turn[2, 1] * x[:, None] + turn[2, 2]
        self._table: Floats = np.where(down < 0, -eye[2] / np.minimum(down, -SLIGHT), np.float32(camera.far))
        self._texel = 2 * AWAY * math.tan(math.radians(camera.field_of_view) / 2) / side
        self.update(np.full_like(self._table, np.inf), np.zeros(self._table.shape, dtype=np.int32))

    def update(self, depths: Floats, bodies: NDArray[np.int32]) -> None:
        """Use a new image from the light: depths in metres (infinite where there is no body), and body numbers."""
        self._depths, self._bodies = depths, bodies
        gaps = self._table - depths
        shades = (gaps > BIAS).astype(np.float32)
        narrow = blurred(shades, max(1, round(NARROW / self._texel)))
        # The wide blur is taken from an image of half the size, which takes a quarter of the time.
        halves = _halved(np.stack([shades, np.where(shades > 0, gaps, np.float32(0.0))]))
        wide, gap = blurred(halves, max(1, round(WIDE / self._texel / 2)))
        share = np.minimum(gap / np.maximum(wide, SLIGHT) / np.float32(FAR_BODY), np.float32(1.0))
        far, share = _doubled(np.stack([wide, share]))
        self._table_shadow = narrow + (far - narrow) * share

    def places(self, pixels: NDArray[np.int64], points: tuple[Floats, Floats, Floats]) -> LightPlaces:
        """Return the places, in the light's image, of the points (in metres) that the given pixels show."""
        x, y, z = points
        across, down, depths = (row[0] * x + row[1] * y + row[2] * z + row[3] for row in self._outside[:3])
        side = self.camera.size[0]
        columns = np.clip(across / depths * self._focal + np.float32(side / 2), 0, side - 1).astype(np.int32)
        rows = np.clip(down / depths * self._focal + np.float32(side / 2), 0, side - 1).astype(np.int32)
        return LightPlaces(pixels, rows * np.int32(side) + columns, depths)

    def on_table(self, places: LightPlaces) -> Floats:
        """Return the share of the light that is hidden from points on the table, from 0 to 1."""
        hidden: Floats = self._table_shadow.ravel()[places.texels]
        return hidden

    def on_bodies(self, places: LightPlaces, bodies: NDArray[np.int32]) -> Floats:
        """Return the share of the light that other bodies hide from points on bodies, from 0 to 1, shape (N,).

        A body casts no shadow on itself, because the renderer already darkens what faces away from the light.
        """
        side, depths, owners = self.camera.size[0], self._depths.ravel(), self._bodies.ravel()
        limit = places.depths - np.float32(BIAS)
        texels = places.texels + np.array([row * side + column for row, column in TAPS], dtype=np.int32)[:, None]
        np.clip(texels, 0, side * side - 1, out=texels)
        shaded = (depths[texels] < limit) & (owners[texels] != bodies)
        hidden: Floats = shaded.sum(axis=0, dtype=np.float32) / np.float32(len(TAPS))
        return hidden


def _halved(images: Floats) -> Floats:
    """Return images (..., H, W) with half as many rows and columns."""
    corners = [images[..., row::2, column::2] for row, column in ((0, 0), (1, 0), (0, 1), (1, 1))]
    halved: Floats = (corners[0] + corners[1] + corners[2] + corners[3]) / np.float32(4.0)
    return halved


def _doubled(images: Floats) -> Floats:
    """Return images (..., H, W) with twice as many rows and columns, interpolated linearly."""
    for axis in (-2, -1):
        lines = images.swapaxes(0, axis)
        most = lines * np.float32(0.75)
        least = lines * np.float32(0.25)
        doubled = np.empty((2 * len(lines), *lines.shape[1:]), dtype=np.float32)
        doubled[0], doubled[2::2] = most[0] + least[0], most[1:] + least[:-1]
        doubled[-1], doubled[1:-1:2] = most[-1] + least[-1], most[:-1] + least[1:]
        images = doubled.swapaxes(0, axis)
    return images


def blurred(images: Floats, radius: int) -> Floats:
    """Return images (..., H, W) after two box filters with a radius in pixels; edge pixels are repeated outwards."""
    width = np.float32(2 * radius + 1)
    for _ in range(2):
        for axis in (-2, -1):
            lines = images.swapaxes(0, axis)
            count = len(lines)
            padded = np.empty((count + 2 * radius + 1, *lines.shape[1:]), dtype=np.float32)
            padded[: radius + 1], padded[radius + 1 : radius + 1 + count], padded[radius + 1 + count :] = (
                lines[0], lines, lines[-1],
            )  # fmt: skip
            sums = np.cumsum(padded, axis=0, out=padded)
            images = ((sums[2 * radius + 1 :] - sums[:count]) / width).swapaxes(0, axis)
    return images
