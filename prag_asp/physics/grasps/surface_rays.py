"""Find where lines through a body leave it."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from prag_asp.physics.grasps.pads import crossed

Floats = NDArray[np.float64]

PARALLEL = 1e-15
"""The triple product, in m², of a triangle's sides and a unit vector below which the vector counts as parallel to the
triangle."""


class SurfaceRays:
    """The triangles (n, 3, 3) of a body in metres, prepared for intersections with lines."""

    def __init__(self, triangles: Floats) -> None:
        self._corner = triangles[:, 0]
        self._one, self._two = triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0]
        facing = crossed(self._one, self._two)
        self._facing = facing / np.linalg.norm(facing, axis=1)[:, None]

    def lengths(self, point: Floats, direction: Floats, least: float, longest: float) -> Sequence[float]:
        """Return the distances in metres, up to `longest`, at which a line leaves the body.

        The line begins at a point (3,) and has a unit vector as its direction. `least` is the smallest cosine between
        the direction and the normal of the surface.
        """
        # Möller and Trumbore, "Fast, minimum storage ray/triangle intersection", 1997.
        cross = crossed(direction, self._two)
        scale = np.einsum("ij,ij->i", self._one, cross)
        # A triangle parallel to the line is not hit; the distance along the line is then set to 0.
        scale[np.abs(scale) < PARALLEL] = math.inf
        offset = point - self._corner
        u = np.einsum("ij,ij->i", offset, cross) / scale
        other = crossed(offset, self._one)
        v = (other @ direction) / scale
        way = np.einsum("ij,ij->i", self._two, other) / scale
        hit = (u >= 0.0) & (v >= 0.0) & (u + v <= 1.0) & (way > 1e-5) & (way <= longest)
        hit &= self._facing @ direction >= least
        return sorted({round(float(each), 6) for each in way[hit]})
