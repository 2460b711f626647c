"""Visible surfaces of objects, with texture coordinates and normals; millimetres."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
SHARP = math.cos(math.radians(50.0))
"""The cosine of the angle between two strips of a profile from which the edge between them is seen."""

WHOLE = (0.0, 0.0, 1.0, 1.0)
Region = tuple[float, float, float, float]
"""A part of a texture: its left, lower, right and upper end, from 0 to 1."""


class Patch(NamedTuple):
    """Quadrangles of a material: corners, texture coordinates and normals of shape (n, 4, 3 or 2)."""

    material: str
    corners: Floats
    places: Floats
    normals: Floats

    def moved(self, x: float = 0.0, y: float = 0.0, z: float = 0.0) -> Patch:
        """Return the patch at another place."""
        return self._replace(corners=np.add(self.corners, (x, y, z)))

    def stretched(self, x: float, y: float, z: float) -> Patch:
        """Return the patch with other proportions."""
        normals = self.normals / (x, y, z)
        normals /= np.maximum(np.linalg.norm(normals, axis=-1, keepdims=True), 1e-12)
        return self._replace(corners=self.corners * (x, y, z), normals=normals)


def turned(
    material: str, profile: Sequence[tuple[float, float]], sides: int = 32, region: Region = WHOLE, repeat: int = 1
) -> Patch:
    """Return a surface of revolution; the profile, radii and heights, has the outside on its right hand.

    The region of the texture goes around it `repeat` times, a divisor of the `sides`.
    """
    points = np.array(profile, dtype=float)
    steps = np.diff(points, axis=0)
    lengths = np.linalg.norm(steps, axis=1)
    flat = np.stack([steps[:, 1], -steps[:, 0]], 1) / np.maximum(lengths, 1e-9)[:, None]
    shares = np.concatenate([[0.0], np.cumsum(lengths) / lengths.sum()])
    turns = 2 * math.pi * np.arange(sides + 1) / sides
    left, low, right, high = region
    quads, places, normals = [], [], []
    for k, ((r0, z0), (r1, z1)) in enumerate(pairwise(profile)):
        ends = []
        for other in (k - 1, k + 1):
            blend = 0 <= other < len(flat) and float(flat[k] @ flat[other]) > SHARP
            normal = flat[k] + flat[other] if blend else flat[k]
            ends.append(normal / np.linalg.norm(normal))
        for one, two in pairwise(range(sides + 1)):
            begin = one * repeat % sides / sides
            along = ((one, r0, z0, 0), (two, r0, z0, 0), (two, r1, z1, 1), (one, r1, z1, 1))
            quads.append([(r * math.cos(turns[i]), r * math.sin(turns[i]), z) for i, r, z, _ in along])
            normals.append(
                [(ends[e][0] * math.cos(turns[i]), ends[e][0] * math.sin(turns[i]), ends[e][1]) for i, _, _, e in along]
            )
            places.append(
                [
                    (left + (right - left) * (begin + (i - one) * repeat / sides), low + (high - low) * shares[k + e])
                    for i, _, _, e in along
                ]
            )
    return Patch(material, np.array(quads), np.array(places), np.array(normals))


def tube(
    material: str,
    points: Sequence[Sequence[float]],
    radii: Sequence[tuple[float, float]],
    side: Sequence[float],
    sides: int = 10,
    region: Region = WHOLE,
    closed: bool = True,
) -> Patch:
    """Return a bar of elliptic sections along points; `side` is a direction in each section, `radii` along and across.

    With `closed` its ends are closed.
    """
    path = np.array(points, dtype=float)
    rings, outward = [], []
    for k in range(len(path)):
        along = path[min(k + 1, len(path) - 1)] - path[max(k - 1, 0)]
        along /= np.linalg.norm(along)
        one = np.array(side, dtype=float) - (np.array(side) @ along) * along
        one /= np.linalg.norm(one)
        two = np.cross(along, one)
        turns = 2 * math.pi * np.arange(sides + 1) / sides
        a, b = radii[k]
        rings.append(path[k] + np.outer(a * np.cos(turns), one) + np.outer(b * np.sin(turns), two))
        normal = np.outer(np.cos(turns) / max(a, 1e-3), one) + np.outer(np.sin(turns) / max(b, 1e-3), two)
        outward.append(normal / np.linalg.norm(normal, axis=1, keepdims=True))
    lengths = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(path, axis=0), axis=1))])
    left, low, right, high = region
    quads, places, normals = [], [], []
    for k, j in pairwise(range(len(path))):
        for one, two in pairwise(range(sides + 1)):
            corner = ((k, one), (k, two), (j, two), (j, one))
            quads.append([rings[a][b] for a, b in corner])
            normals.append([outward[a][b] for a, b in corner])
            places.append(
                [(left + (right - left) * lengths[a] / lengths[-1], low + (high - low) * b / sides) for a, b in corner]
            )
    for k, way in ((0, -1), (len(path) - 1, 1)) if closed else ():
        along = path[k] - path[k - way]
        along /= np.linalg.norm(along)
        for one, two in pairwise(range(sides + 1)):
            corner = (path[k], rings[k][one], rings[k][two], rings[k][two])
            quads.append(corner if way > 0 else (path[k], rings[k][two], rings[k][one], rings[k][one]))
            normals.append([along] * 4)
            places.append(
                [((left + right) / 2, low + (high - low) * x) for x in (0.5, one / sides, two / sides, two / sides)]
            )
    return Patch(material, np.array(quads), np.array(places), np.array(normals))


FACES = {
    "front": ((1, 0, 0), (0, 1, 0)),
    "back": ((-1, 0, 0), (0, -1, 0)),
    "left": ((0, 1, 0), (-1, 0, 0)),
    "right": ((0, -1, 0), (1, 0, 0)),
    "top": ((0, 0, 1), (0, 1, 0)),
    "bottom": ((0, 0, -1), (0, 1, 0)),
}
"""The faces of a block: the outward normal, and the direction in which its texture is read."""


def block(
    material: str, low: Sequence[float], high: Sequence[float], regions: Mapping[str, Region] | None = None
) -> Patch:
    """Return a block with a region of the texture on each face, all of it by default."""
    half, middle = np.subtract(high, low) / 2, np.add(high, low) / 2
    quads, places, normals = [], [], []
    for name, (outward, reading) in FACES.items():
        normal, right = np.array(outward, float), np.array(reading, float)
        up = np.cross(normal, right)
        left, lower, far, upper = (regions or {}).get(name, WHOLE)
        corners = [(a, b) for a, b in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
        quads.append([middle + half * (normal + a * right + b * up) for a, b in corners])
        normals.append([normal] * 4)
        places.append([((far if a > 0 else left), (upper if b > 0 else lower)) for a, b in corners])
    return Patch(material, np.array(quads), np.array(places), np.array(normals))
