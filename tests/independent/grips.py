"""Whether two pads hold a body of boxes, judged by points on its surface; no geometry of the package is used."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import product

import numpy as np

from tests.independent.frames import Array, Frame

STEP = 0.0015
"""Metres between the points on a face."""

PAD, AHEAD = 0.0176, 0.009
"""The side of a pad, and how far it reaches beyond the tool; metres."""

OFF = 0.003
"""By how much a pad may be off the surface, in metres: 2 mm of the definition, and the step of the points."""

SLANT = 0.5
"""The least cosine between a pad and what it touches: friction of 45 degrees, and the points at edges."""

FINGER = ((-0.0088, 0.0088), (0.0, 0.0142), (-0.0086, 0.009))
"""The ends of a closed finger's pad along x, y and z of the tool, in metres."""


def points_on(boxes: Sequence[tuple[Array, Frame]]) -> tuple[Array, Array]:
    """Return points on the surface of boxes and their outward normals; a box is half its sides, and its place."""
    places, normals = [], []
    for (half, frame), axis, sign in product(boxes, range(3), (-1.0, 1.0)):
        ranges = [np.linspace(-side, side, max(2, round(2 * side / STEP))) for side in half]
        ranges[axis] = np.array([sign * half[axis]])
        grid = np.stack(np.meshgrid(*ranges), -1).reshape(-1, 3)
        places.append(grid @ frame.turn.T + frame.at)
        normals.append(np.tile(sign * frame.turn[:, axis], (len(grid), 1)))
    return np.concatenate(places), np.concatenate(normals)


def grip_faults(points: Array, normals: Array, tool: Frame, width: float) -> Iterator[str]:
    """Yield why pads that are a width apart do not hold a body, by points of its surface in the frame of the tool."""
    local, outward = (points - tool.at) @ tool.turn, normals @ tool.turn
    x, y, z = local.T
    between = (np.abs(x) < PAD / 2) & (z > AHEAD - PAD) & (z < AHEAD) & (np.abs(y) < width / 2 + OFF)
    for name, side in (("left", 1.0), ("right", -1.0)):
        near = between & (side * y > width / 2 - OFF) & (side * outward[:, 1] > SLANT)
        if not near.any():
            yield f"the {name} pad touches nothing"
        low, high = (np.array(ends) for ends in zip(*FINGER, strict=True))
        finger = local * [1.0, side, 1.0] - [0.0, width / 2, 0.0]
        if ((finger > low + OFF) & (finger < high - OFF)).all(1).any():
            yield f"the {name} finger is in the body"
