"""Find the cavity of a body: where it would hold water if it stood in the rain.

Heights of the surface are measured on a grid from above. Water runs off at the border and through holes, and fills any
other point up to the lowest rim over which it can run off: the smallest, over all paths to the border, of the largest
height on the path (Barnes, Lehman and Mulla, "Priority-flood", 2014).
"""

from __future__ import annotations

import heapq

import numpy as np
from numpy.typing import NDArray

from prag_asp.scene.scene import Cavity

Floats = NDArray[np.float64]

CELLS = 64
"""The number of cells of the grid along the longest horizontal side of a body."""

SHALLOW, NARROW = 0.012, 0.02
"""The smallest depth and the smallest width of a cavity in metres: nothing stands in a smaller one."""

LEVEL = 0.004
"""The height in metres of the points of a floor above its lowest one."""

UPRIGHT = 1e-12
"""Twice the area in square metres, seen from above, below which a triangle is vertical."""


def find_cavity(triangles: Floats) -> Cavity | None:
    """Return the largest cavity of a body, given by triangles (n, 3, 3) in metres, None if there is none."""
    points = triangles.reshape(-1, 3)
    low, high = points.min(0), points.max(0)
    cell = float((high - low)[:2].max()) / CELLS
    xs, ys = (np.arange(low[i] - cell / 2, high[i] + cell, cell) for i in (0, 1))
    heights = np.full((len(xs), len(ys)), -np.inf)
    for triangle in triangles:
        _raise(heights, triangle, xs, ys)
    depths = _filled(heights) - np.maximum(heights, low[2])
    best: tuple[float, Cavity] | None = None
    for region in _regions(depths > LEVEL):
        inside = np.zeros_like(depths, dtype=bool)
        inside[tuple(np.array(region).T)] = True
        bottom = float(heights[inside].min())
        floor = inside & (heights <= bottom + LEVEL)
        depth = float(depths[inside].max())
        ends = [
            (axis[where.min()], axis[where.max()]) for axis, where in zip((xs, ys), np.nonzero(inside), strict=True)
        ]
        sides = [last - first + cell for first, last in ends]
        if depth >= SHALLOW and min(sides) >= NARROW and floor.sum() * cell * cell >= NARROW * NARROW / 4:
            x, y = ((first + last) / 2 for first, last in ends)
            found = Cavity((float(x), float(y), bottom), (float(sides[0]), float(sides[1]), depth))
            volume = float(depths[inside].sum())
            best = (volume, found) if best is None or volume > best[0] else best
    return None if best is None else best[1]


def _raise(heights: Floats, triangle: Floats, xs: Floats, ys: Floats) -> None:
    """Raise the heights of the points of a grid over which a triangle (3, 3) is to its own."""
    (ax, ay, az), (bx, by, bz), (cx, cy, cz) = triangle.tolist()
    area = (bx - ax) * (cy - ay) - (by - ay) * (cx - ax)
    if abs(area) < UPRIGHT:
        return
    rows = slice(*np.searchsorted(xs, (min(ax, bx, cx), max(ax, bx, cx))))
    columns = slice(*np.searchsorted(ys, (min(ay, by, cy), max(ay, by, cy))))
    x, y = xs[rows, None] - ax, ys[None, columns] - ay
    one = (x * (cy - ay) - y * (cx - ax)) / area
    two = (y * (bx - ax) - x * (by - ay)) / area
    covered = (one >= 0.0) & (two >= 0.0) & (one + two <= 1.0)
    own = az + one * (bz - az) + two * (cz - az)
    heights[rows, columns] = np.where(covered, np.maximum(heights[rows, columns], own), heights[rows, columns])


def _filled(heights: Floats) -> Floats:
    """Return the level of water at each point of a grid; it runs off at the border, and where there is no surface."""
    levels, waits = np.full_like(heights, np.inf), np.ones(heights.shape, dtype=bool)
    last_row, last_column = heights.shape[0] - 1, heights.shape[1] - 1
    queue: list[tuple[float, tuple[int, ...]]] = []
    for at in np.ndindex(heights.shape):
        if at[0] in (0, last_row) or at[1] in (0, last_column) or heights[at] == -np.inf:
            levels[at], waits[at] = heights[at], False
            heapq.heappush(queue, (float(heights[at]), at))
    while queue:
        level, (i, j) = heapq.heappop(queue)
        for at in ((i - 1, j), (i + 1, j), (i, j - 1), (i, j + 1)):
            if 0 <= at[0] <= last_row and 0 <= at[1] <= last_column and waits[at]:
                levels[at], waits[at] = max(level, float(heights[at])), False
                heapq.heappush(queue, (float(levels[at]), at))
    return levels


def _regions(wet: NDArray[np.bool_]) -> list[list[tuple[int, int]]]:
    """Return the points of each connected region of a grid."""
    left = {(int(i), int(j)) for i, j in zip(*np.nonzero(wet), strict=True)}
    regions = []
    while left:
        region = [left.pop()]
        for i, j in region:
            for at in ((i - 1, j), (i + 1, j), (i, j - 1), (i, j + 1)):
                if at in left:
                    left.remove(at)
                    region.append(at)
        regions.append(region)
    return regions
