"""What a view shows of the things that a task moves, and whether another box would hide any part of them."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np
from numpy.typing import NDArray

from prag_asp.physics.filming.studio import Studio
from prag_asp.physics.pictures.views import View, counting_camera
from prag_asp.physics.witness import Moment
from prag_asp.scene.boxes import Corners
from prag_asp.scene.cameras import Camera
from prag_asp.scene.geometry import hull

Boxes = NDArray[np.float64]
"""The lowest and the highest corners of bounding boxes in metres, shape (n, 2, 3)."""


@dataclass(frozen=True)
class Sight:
    """What a camera sees: the largest distance in metres at which each pixel shows a hand, an object or a moving part.

    The distance is 0 where none is ever seen.
    """

    camera: Camera
    distances: NDArray[np.float32]

    @classmethod
    def of(cls, studio: Studio, view: tuple[View, tuple[int, int]], moments: Iterable[Moment]) -> Sight:
        """Return the sight of a view in the given moments; the view includes the size of the picture in pixels."""
        camera = counting_camera(*view)
        distances = np.zeros(camera.size[::-1], dtype=np.float32)
        for moment in moments:
            studio.show(moment)
            np.maximum(distances, studio.distances(camera, {*studio.movable, *moment.arms}), out=distances)
        return cls(camera, distances)

    def shows(self, box: Corners) -> bool:
        """Return whether a box is entirely in the image."""
        pixels, _ = self._projected(box)
        return bool((pixels >= 0).all() and (pixels <= self.camera.size).all())

    def is_hidden_by(self, box: Corners) -> bool:
        """Return whether a box may hide part of what the camera sees, because it is closer at some pixel."""
        pixels, nearest = self._projected(box)
        outline = np.array(hull([(x, y) for x, y in pixels.tolist()]))
        sides = np.roll(outline, -1, axis=0) - outline
        width, height = self.camera.size
        x, y = np.meshgrid(np.arange(width) + 0.5, np.arange(height) + 0.5)
        covers = np.ones((height, width), dtype=np.bool_)
        for (left, top), (across, down) in zip(outline.tolist(), sides.tolist(), strict=True):
            # Half a pixel more on each side: a thing is hidden if a pixel shows a part of both.
            covers &= across * (y - top) - down * (x - left) >= -0.5 * (abs(across) + abs(down))
        return bool((self.distances[covers] > nearest).any())

    def _projected(self, box: Corners) -> tuple[NDArray[np.float64], float]:
        """Return the pixels of the corners of a box, shape (8, 2), and their smallest distance in metres."""
        corners = np.array(list(product(*zip(*box, strict=True))))
        back = np.linalg.inv(self.camera.pose)
        points = corners @ back[:3, :3].T + back[:3, 3]
        ahead = np.maximum(points[:, 2:], self.camera.near)
        return (points @ self.camera.intrinsics.T)[:, :2] / ahead, float(ahead.min())


def boxes_of(corners: Sequence[Corners]) -> Boxes:
    """Return bounding boxes as an array."""
    return np.array(corners, dtype=np.float64).reshape(-1, 2, 3)
