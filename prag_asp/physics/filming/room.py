"""The room around the table, ray-traced: a concrete floor and plain walls that darken towards the corners.

The room is only a background: it has neither depth nor entities.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from prag_asp.physics.filming.textures import Floats, concrete
from prag_asp.scene.boxes import Vector
from prag_asp.scene.scene import TableTop

WALL, SKIRTING, FLOOR, CEILING = (226, 229, 231), (243, 243, 241), (178, 176, 173), (244, 244, 243)
"""Colours from 0 to 255."""

BEHIND, BESIDE, BEFORE = 0.6, 1.5, 3.0
"""The distances in metres of the walls behind, beside and in front of the table from its edges; cameras stand in front
of the table."""

FLOOR_HEIGHT, CEILING_HEIGHT, SKIRTING_HEIGHT = -0.74, 2.3, 0.08
"""Usual heights in metres: of the floor and the ceiling relative to the table top, and of the skirting above the
floor."""

CORNER, CORNER_WIDTH = 0.2, 0.3
"""The share by which a corner is darker, and the distance in metres over which this share decays by a factor of e."""

TABLE_SHADOW, TABLE_SOFTNESS = 0.32, 0.5
"""The share by which the table darkens the floor, and the width of the edge of its shadow in metres."""

LEVEL = np.float32(1e-7)
"""The minimum absolute value of a component of a ray direction, to avoid division by zero."""


def room_colours(
    table: TableTop, eye: Floats, ahead: tuple[Floats, Floats, Floats], focal: float, light: Vector
) -> NDArray[np.uint8]:
    """Return the colours (N, 3) of the room where rays from the point `eye` hit it.

    `ahead` holds the x, y and z components of the N ray directions, `focal` is the focal length of the camera in
    pixels, and `light` is the direction to the light.
    """
    half = np.array(table.size) / 2
    low = np.array([table.centre[0] - half[0] - BEHIND, table.centre[1] - half[1] - BESIDE, FLOOR_HEIGHT], np.float32)
    high = np.array(
        [table.centre[0] + half[0] + BEFORE, table.centre[1] + half[1] + BESIDE, CEILING_HEIGHT], np.float32
    )
    rays = [np.where(np.abs(ray) < LEVEL, LEVEL, ray) for ray in ahead]
    ways = np.stack([(np.where(r > 0, high[i], low[i]) - eye[i]) / r for i, r in enumerate(rays)])
    side = ways.argmin(axis=0)
    way = ways.min(axis=0)
    points = [eye[i] + way * ray for i, ray in enumerate(rays)]
    gaps = np.stack([np.where(side == i, np.inf, np.minimum(p - low[i], high[i] - p)) for i, p in enumerate(points)])
    shade = 1.0 - CORNER * np.exp(-np.maximum(gaps.min(axis=0), 0.0) / CORNER_WIDTH)
    floor, ceiling = (side == 2) & (rays[2] < 0), (side == 2) & (rays[2] > 0)
    colours = np.empty((len(way), 3), dtype=np.float32)
    colours[:] = WALL
    colours[(side < 2) & (points[2] < FLOOR_HEIGHT + SKIRTING_HEIGHT)] = SKIRTING
    colours[ceiling] = CEILING
    if floor.any():
        x, y, distance = points[0][floor], points[1][floor], way[floor]
        spots = concrete().at(x, y, float(np.median(distance)) / focal)
        slope = [np.float32(-FLOOR_HEIGHT * light[axis] / max(light[2], 0.1)) for axis in range(2)]
        beyond = np.maximum(
            np.abs(x + slope[0] - np.float32(table.centre[0])) - np.float32(half[0]),
            np.abs(y + slope[1] - np.float32(table.centre[1])) - np.float32(half[1]),
        )
        covered = np.clip(0.5 - beyond / TABLE_SOFTNESS, 0.0, 1.0)
        covered = covered * covered * (3.0 - 2.0 * covered)
        colours[floor] = np.array(FLOOR, np.float32) * (spots * (1.0 - TABLE_SHADOW * covered))[:, None]
    shaded: NDArray[np.uint8] = np.clip(colours * shade[:, None], 0.0, 255.0).astype(np.uint8)
    return shaded
