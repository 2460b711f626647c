"""Convex parts of objects, of which collisions and grasps are computed; millimetres."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from itertools import pairwise, product

import numpy as np
from numpy.typing import NDArray

from prag_asp.scene.read.convex import convex_hull

Floats = NDArray[np.float64]
Ring = tuple[float, float, float]
"""The height of a section of a wall, and its inner and outer radius."""


def hull(points: Iterable[Sequence[float]]) -> Floats:
    """Return the triangles (n, 3, 3) of the convex hull of points, rounded to what the files have."""
    return convex_hull(np.round(np.array(list(points), dtype=float), 2))


def box(low: Sequence[float], high: Sequence[float]) -> Floats:
    """Return a box between two corners."""
    return hull(product(*zip(low, high, strict=True)))


def circle(radius: float, z: float, sides: int, at: tuple[float, float] = (0.0, 0.0)) -> list[tuple[float, ...]]:
    """Return the corners of a regular polygon that is as far inside a circle as outside."""
    wide = radius * 2 / (1 + math.cos(math.pi / sides))
    turns = (2 * math.pi * k / sides for k in range(sides))
    return [(at[0] + wide * math.cos(turn), at[1] + wide * math.sin(turn), z) for turn in turns]


def lathe(sections: Sequence[tuple[float, float]], sides: int) -> Floats:
    """Return a convex solid of revolution, given by heights and radii."""
    return hull(point for z, radius in sections for point in circle(radius, z, sides))


def wall(rings: Sequence[Ring], sides: int) -> list[Floats]:
    """Return the parts of a round wall: one for each side between two rings."""
    parts = []
    for (low, low_in, low_out), (high, high_in, high_out) in pairwise(rings):
        polygons = [
            circle(radius, z, sides) for z, radius in ((low, low_in), (low, low_out), (high, high_in), (high, high_out))
        ]
        for k in range(sides):
            parts.append(hull(polygon[i % sides] for polygon in polygons for i in (k, k + 1)))
    return parts


def rod(points: Sequence[Sequence[float]], wide: Sequence[float], tall: Sequence[float]) -> list[Floats]:
    """Return the parts of a bar along points in a vertical plane; `wide` is its breadth across that plane at each.

    `tall` is its thickness within the plane.
    """
    sections = [_section(points, k, wide[k], tall[k]) for k in range(len(points))]
    return [hull([*one, *two]) for one, two in pairwise(sections)]


def _section(points: Sequence[Sequence[float]], k: int, wide: float, tall: float) -> list[tuple[float, ...]]:
    """Return the corners of a bar at one of its points."""
    before, after = points[max(k - 1, 0)], points[min(k + 1, len(points) - 1)]
    along = np.subtract(after, before) / np.linalg.norm(np.subtract(after, before))
    first, last = np.array(points[0], float), np.array(points[-1], float)
    flat = np.array([*(last - first)[:2], 0.0])
    if not flat.any():  # a handle that begins and ends one above the other stands out from the axis
        flat = np.array([*np.mean(points, axis=0)[:2], 0.0])
    across = np.cross([0.0, 0.0, 1.0], flat / np.linalg.norm(flat))
    up = np.cross(along, across)
    at = np.array(points[k], float)
    return [tuple(at + a * wide / 2 * across + b * tall / 2 * up) for a in (-1, 1) for b in (-1, 1)]
