"""Find the cavity of a body: the space that rain would fill with water.

The heights of the surface, seen from above, are measured on a grid. Water runs off at the border and through holes; at
any other point, it rises to the lowest rim over which it can run off: the minimum, over all paths to the border, of the
greatest height on the path (Barnes, Lehman and Mulla, "Priority-flood", 2014). Gaps and holes that are too narrow for
objects to fall through are closed first, so a basket is a container, and cracks between the triangles of a mesh do not
matter. If no cavity is found, the search is repeated with walls that are thinner than a cell of the grid. Parts above a
cavity that do not close it, such as the handle of a basket, are ignored: the surface is also measured from several
heights, without the parts above each of them.

The result is as exact as the grid, except for cavities between vertical walls, which are measured along the walls.
"""

from __future__ import annotations

import hashlib
import heapq
import json
import math
from collections.abc import Iterator
from typing import NamedTuple

import msgspec
import numpy as np
from numpy.typing import NDArray

from prag_asp.output.cache_files import cache_folder, read_cached, write_cached
from prag_asp.scene.read.cavities.box_cavities import boxed_cavity
from prag_asp.scene.read.scene_values import MAX_LENGTH
from prag_asp.scene.scene import Cavity

Floats = NDArray[np.float64]

CELLS, WIDEST = 64, 0.004
"""The smallest number of grid cells along the longest horizontal side of a body, and the largest width of a cell in
metres: half of `GAP`, so that gaps are closed in the grid of any body."""

SHALLOW, NARROW = 0.012, 0.02
"""The smallest depth and the smallest width of a cavity in metres; nothing can stand in a smaller cavity."""

GAP = 0.008
"""The approximate width in metres of the gaps and holes that are closed, because the grid has whole cells.

Gaps of up to 5 mm are always closed.
"""

LEVELS, OPEN = 12, 0.6
"""The number of heights from which a body is viewed, and the smallest share of a cavity's floor that must be visible
from above."""

LEVEL = 0.004
"""The largest height in metres of points on a floor above its lowest point."""

UPRIGHT = 1e-12
"""Twice the projected area in square metres below which a triangle counts as vertical."""

STEEP = 0.2
"""The largest ratio of a triangle's projected area, seen from above, to its area for which the triangle belongs to a
wall: its slope is then at least 78 degrees."""

FORM = 2
"""The version of the search; cached cavities of other versions are not read."""

LARGEST_FILE = 1_000
"""The largest size in bytes of a cached cavity."""


def cached_cavity(triangles: Floats) -> Cavity | None:
    """Return the cavity that `find_cavity` finds, from the user's cache if it was found before."""
    folder = cache_folder()
    if folder is None:
        return find_cavity(triangles)
    path = folder / f"{hashlib.sha256(f'{FORM} '.encode() + triangles.tobytes()).hexdigest()}.cavity"
    content = read_cached(path, LARGEST_FILE)
    if content is not None:
        return msgspec.json.decode(content, type=Cavity | None)
    cavity = find_cavity(triangles)
    write_cached(path, json.dumps(cavity).encode())
    return cavity


def find_cavity(triangles: Floats) -> Cavity | None:
    """Return the largest cavity of a body, given by triangles (n, 3, 3) in metres, or None if there is none.

    Bodies longer than `MAX_LENGTH` are not searched, because they are refused and their grids would not fit into
    memory.
    """
    points = triangles.reshape(-1, 3)
    low, high = points.min(0), points.max(0)
    if (high - low).max() > MAX_LENGTH:
        return None
    cell = min(float((high - low)[:2].max()) / CELLS, WIDEST)
    xs, ys = (np.arange(low[i] - cell / 2, high[i] + cell, cell) for i in (0, 1))
    shape = (LEVELS, len(xs), len(ys))
    cuts = np.append(np.linspace(low[2], high[2], LEVELS + 1)[1:-1], np.inf)
    heights, solid = np.full(shape, -np.inf), np.zeros(shape, dtype=int)
    for triangle in triangles:
        _raise(heights, solid, cuts, triangle, xs, ys)
    # Thin walls are added only if there is no cavity without them, because they take up whole cells.
    for thin in (False, True):
        walls = _Walls.of(triangles, cell / 2, (xs, ys)) if thin else None
        found: list[tuple[float, Cavity]] = []
        for cut, seen, within in zip(cuts, heights, solid, strict=True):
            # If nothing overhangs a surface, the view of the whole body shows the same.
            if cut == np.inf or ((heights[-1] > cut) & (within <= 0) & (seen > -np.inf)).any():
                surface = np.where((within > 0) & (cut < np.inf), cut, seen)
                if walls is not None:
                    raised = walls.added(surface, cut)
                    if raised is surface:
                        continue
                    surface = raised
                found += _cavities(_closed(surface, round(GAP / 2 / cell)), heights[-1], float(low[2]), (xs, ys))
        if found:
            cavity = max(found, key=lambda row: row[0])[1]
            return boxed_cavity(triangles, cavity, cell, GAP) or cavity
    return None


def _cavities(surface: Floats, top: Floats, low: float, grid: tuple[Floats, Floats]) -> Iterator[tuple[float, Cavity]]:
    """Yield the cavities of a surface, given by its heights on a grid, each with its volume in cells times metres.

    `top` is the surface of the whole body seen from above, and `low` is the height of its lowest point, in metres.
    """
    cell = float(grid[0][1] - grid[0][0])
    depths = _filled(surface) - np.maximum(surface, low)
    for region in _regions(depths > LEVEL):
        inside = np.zeros_like(depths, dtype=bool)
        inside[tuple(np.array(region).T)] = True
        bottom = float(surface[inside].min())
        floor = inside & (surface <= bottom + LEVEL)
        depth = float(depths[inside].max())
        ends = [(axis[where.min()], axis[where.max()]) for axis, where in zip(grid, np.nonzero(inside), strict=True)]
        sides = [last - first + cell for first, last in ends]
        is_open = (top[floor] <= surface[floor] + LEVEL).mean() >= OPEN
        large = min(sides) >= NARROW and floor.sum() * cell * cell >= NARROW * NARROW / 4
        if depth >= SHALLOW and large and is_open:
            x, y = ((first + last) / 2 for first, last in ends)
            volume = float(depths[inside].sum())
            yield volume, Cavity((float(x), float(y), bottom), (float(sides[0]), float(sides[1]), depth))


def _raise(heights: Floats, solid: NDArray[np.int_], cuts: Floats, triangle: Floats, xs: Floats, ys: Floats) -> None:
    """Add a triangle (3, 3) to the views of a grid from each of the heights `cuts`.

    `heights` are the heights of the highest surface below each cut; `solid` counts the solids that contain the cut: the
    surfaces below it that face down, minus those that face up.
    """
    (ax, ay, az), (bx, by, bz), (cx, cy, cz) = triangle.tolist()
    area = (bx - ax) * (cy - ay) - (by - ay) * (cx - ax)
    if abs(area) < UPRIGHT:
        return
    rows = slice(*np.searchsorted(xs, (min(ax, bx, cx), max(ax, bx, cx))))
    columns = slice(*np.searchsorted(ys, (min(ay, by, cy), max(ay, by, cy))))
    x, y = xs[rows, None] - ax, ys[None, columns] - ay
    one = (x * (cy - ay) - y * (cx - ax)) / area
    two = (y * (bx - ax) - x * (by - ay)) / area
    own = az + one * (bz - az) + two * (cz - az)
    covered = ((one >= 0.0) & (two >= 0.0) & (one + two <= 1.0)) & (own <= cuts[:, None, None])
    there = heights[:, rows, columns]
    heights[:, rows, columns] = np.where(covered, np.maximum(there, own), there)
    solid[:, rows, columns] += np.where(covered, -1 if area > 0.0 else 1, 0)


class _Walls(NamedTuple):
    """Points on steep triangles, over a grid: their `heights` in metres, shape (n,), and their `places`, shape (3, n).

    The places are indices into the flattened grid: of the grid point one cell in front of the wall, of the one on the
    wall, and of the one a cell behind it.
    """

    heights: Floats
    places: NDArray[np.intp]

    @classmethod
    def of(cls, triangles: Floats, spacing: float, grid: tuple[Floats, Floats]) -> _Walls:
        """Return points on those triangles (n, 3, 3) that are steep, at most about `spacing` metres apart."""
        one, two = triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0]
        normals = np.cross(one, two)
        lengths = np.linalg.norm(normals, axis=1)
        steep = (np.abs(normals[:, 2]) <= STEEP * lengths) & (lengths > 0.0)
        inside, across = [np.empty((0, 3))], [np.empty((0, 2))]
        for corner, u, v, normal in zip(triangles[steep, 0], one[steep], two[steep], normals[steep, :2], strict=True):
            longest = max(np.linalg.norm(u), np.linalg.norm(v), np.linalg.norm(u - v))
            shares = np.linspace(0.0, 1.0, math.ceil(float(longest) / spacing) + 1)
            first, second = np.nonzero(np.add.outer(shares, shares) <= 1.0 + 1e-9)
            inside.append(corner + shares[first, None] * u + shares[second, None] * v)
            across.append(np.broadcast_to(normal / np.linalg.norm(normal), (len(first), 2)))
        points, horizontal = np.concatenate(inside), np.concatenate(across)
        cell = float(grid[0][1] - grid[0][0])
        places = []
        for side in (-cell, 0.0, cell):
            beside = points[:, :2] + side * horizontal
            i, j = (
                np.clip(np.round((beside[:, axis] - line[0]) / cell).astype(np.intp), 0, len(line) - 1)
                for axis, line in enumerate(grid)
            )
            places.append(i * len(grid[1]) + j)
        return cls(points[:, 2], np.stack(places))

    def added(self, surface: Floats, cut: float) -> Floats:
        """Return a surface after adding the parts of walls below the height `cut` that it lacks.

        The surface is given by its heights on the grid, in metres. If no part is missing, the same array is returned.

        A wall is missing at a point if the surface is lower there, and a cell away on either side of the wall.
        """
        below = self.heights <= cut
        heights, places = self.heights[below], self.places[:, below]
        missing = heights > surface.ravel()[places].max(axis=0) + LEVEL
        if not missing.any():
            return surface
        raised: Floats = surface.copy()
        np.maximum.at(raised.ravel(), places[1, missing], heights[missing])
        return raised


def _closed(heights: Floats, reach: int) -> Floats:
    """Return heights with gaps of up to twice `reach` cells filled, by a morphological closing with a square."""
    padded = np.pad(heights, 2 * reach, constant_values=-np.inf)
    window = (2 * reach + 1, 2 * reach + 1)
    grown = np.lib.stride_tricks.sliding_window_view(padded, window).max((2, 3))
    closed: Floats = np.lib.stride_tricks.sliding_window_view(grown, window).min((2, 3))
    return closed


def _filled(heights: Floats) -> Floats:
    """Return the water level at each point of a grid; water runs off at the border and where there is no surface."""
    rows, columns = heights.shape
    border = np.ones(heights.shape, dtype=bool)
    border[1:-1, 1:-1] = False
    dry = border | (heights == -np.inf)
    # These are plain lists because the queue accesses single points, for which arrays are slow.
    levels = np.where(dry, heights, np.inf).ravel().tolist()
    waits, own = (~dry).ravel().tolist(), heights.ravel().tolist()
    queue = [(levels[at], at) for at in np.flatnonzero(dry).tolist()]
    heapq.heapify(queue)
    while queue:
        level, at = heapq.heappop(queue)
        row, column = divmod(at, columns)
        for near, inside in (
            (at - columns, row > 0),
            (at + columns, row < rows - 1),
            (at - 1, column > 0),
            (at + 1, column < columns - 1),
        ):
            if inside and waits[near]:
                levels[near], waits[near] = max(level, own[near]), False
                heapq.heappush(queue, (levels[near], near))
    return np.array(levels).reshape(heights.shape)


def _regions(wet: NDArray[np.bool_]) -> list[list[tuple[int, int]]]:
    """Return the points of each connected region in a grid."""
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
