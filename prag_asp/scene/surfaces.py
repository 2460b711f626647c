"""The surface of a body as triangles in its own frame, as used for grasps, proofs and cavities."""

from __future__ import annotations

import math
from collections.abc import Callable, Hashable
from functools import lru_cache, wraps
from itertools import pairwise, product
from typing import Any, NamedTuple, TypeVar, cast

import numpy as np
from numpy.typing import NDArray

from prag_asp.scene.geometry import Pose, Quaternion, extents, hull, matrix, outline
from prag_asp.scene.read.convex import convex_hull
from prag_asp.scene.read.mesh import mesh_parts, state_of
from prag_asp.scene.read.stability import rotation
from prag_asp.scene.scene import Shape, Solid
from prag_asp.scene.solids import solids

Floats = NDArray[np.float64]
Function = TypeVar("Function", bound=Callable[..., Any])

EDGE = 1e-9
"""The length in metres below which an edge has no direction."""

SIDES = 32
"""The number of sides of a tessellated cylinder or ball; the error is at most half a percent of the radius."""


NEAR = 1e-4
"""The error of a smallest width, as a fraction of the diameter, or of a smallest projection, as a fraction of the
surface."""

MOST_DIRECTIONS = 20_000
"""The maximum number of directions that are compared at once; for round bodies, the bounds remain coarse."""


def part_surfaces(shape: Shape) -> tuple[Floats, ...]:
    """Return the triangles (n, 3, 3) of each convex part of a body in its own frame, in metres.

    The corners of a triangle are counter-clockwise seen from outside.

    Raises:
        SceneError: a mesh cannot be read.
    """
    return _part_surfaces(shape, mesh_states(shape))


@lru_cache(maxsize=64)
def _part_surfaces(shape: Shape, files: tuple[tuple[int, int], ...]) -> tuple[Floats, ...]:
    """Return the triangles of each part; the cache key includes the states of the files."""
    return tuple(part for solid in solids(shape) for part in solid_parts(solid))


def surface(shape: Shape) -> Floats:
    """Return the triangles (n, 3, 3) of all parts of a body in its own frame, in metres.

    Raises:
        SceneError: a mesh cannot be read.
    """
    return np.concatenate(part_surfaces(shape))


class LeastExtent(NamedTuple):
    """Lower bounds on the width of a body in any direction, in metres, and on its projections, in square metres."""

    width: float
    area: float


def least_extent(shape: Shape) -> LeastExtent:
    """Return the least extent of the convex hull of a body with a model.

    Both bounds come from a branch and bound over directions: a width changes by at most the diameter, and the area of a
    projection by at most half the surface, per radian (Cauchy's formula for projections).

    Raises:
        SceneError: a mesh cannot be read.
    """
    return _least_extent(shape, mesh_states(shape))


@lru_cache(maxsize=256)
def _least_extent(shape: Shape, files: tuple[tuple[int, int], ...]) -> LeastExtent:
    """Return the least extent of a body; the cache key includes the states of its files."""
    triangles = convex_hull(surface(shape).reshape(-1, 3))
    corners = np.unique(triangles.reshape(-1, 3), axis=0)
    areas = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0]) / 2
    return LeastExtent(
        _least(lambda along: np.ptp(along @ corners.T, axis=1), float(np.linalg.norm(np.ptp(corners, axis=0)))),
        _least(lambda along: np.abs(along @ areas.T).sum(1) / 2, float(np.linalg.norm(areas, axis=1).sum()) / 2),
    )


def _least(value: Callable[[Floats], Floats], slope: float) -> float:
    """Return a lower bound on an even function of unit vectors (n, 3) that changes by at most `slope` per radian."""
    side, best, tolerance = 1.0, math.inf, NEAR * slope
    cells = np.array([(k, 0.0, 0.0) for k in range(3)])  # squares on three faces of a cube: the face, and the centre
    while True:
        along = np.insert(cells[:, 1:], 0, 1.0, axis=1)
        along = np.where(
            cells[:, :1] == 1, along[:, [2, 0, 1]], np.where(cells[:, :1] == 2, along[:, [1, 2, 0]], along)
        )
        values = value(along / np.linalg.norm(along, axis=1)[:, None])
        best = min(best, float(values.min()))
        # The faces of the cube are outside the unit sphere, so an angle is at most the distance between points on a
        # face.
        bounds = values - slope * math.sqrt(2.0) * side
        open_cells = cells[bounds < best - tolerance]
        if not len(open_cells):
            return max(0.0, best - tolerance)
        if 4 * len(open_cells) > MOST_DIRECTIONS:
            return max(0.0, float(bounds.min()))
        side /= 2
        shifts = np.array([(0.0, x * side, y * side) for x in (-1, 1) for y in (-1, 1)])
        cells = (open_cells[:, None] + shifts).reshape(-1, 3)


def cached_by_geometry(maxsize: int) -> Callable[[Function], Function]:
    """Return a decorator that caches results by a shape, the states of its mesh files and further arguments.

    The function takes all arguments by position, the shape first.
    """

    def decorate(function: Function) -> Function:
        @lru_cache(maxsize=maxsize)
        def cached(_files: tuple[tuple[int, int], ...], *arguments: Hashable) -> Any:
            return function(*arguments)

        @wraps(function)
        def call(shape: Shape, *others: Hashable) -> Any:
            return cached(() if shape.model is None else mesh_states(shape), shape, *others)

        return cast(Function, call)

    return decorate


def mesh_states(shape: Shape) -> tuple[tuple[int, int], ...]:
    """Return the states of the mesh files of a body, which identify their contents for caches.

    Raises:
        SceneError: a mesh cannot be read.
    """
    return tuple(state_of(solid.mesh) for solid in solids(shape) if solid.mesh)


def in_frame(triangles: Floats, frame: Pose) -> Floats:
    """Return triangles (n, 3, 3) transformed into a frame whose pose is given in their current frame."""
    turned = matrix(frame)
    result: Floats = (triangles - turned[:3, 3]) @ turned[:3, :3]
    return result


def solid_parts(solid: Solid) -> list[Floats]:
    """Return the triangles of the convex parts of a solid in the frame of its body.

    Raises:
        SceneError: a mesh cannot be read.
    """
    rows = np.array(rotation(solid.turn))
    if solid.mesh:
        # as in simulators, a part collides as its convex hull
        parts = [convex_hull(np.array(part).reshape(-1, 3)) for part in mesh_parts(solid.mesh, solid.size)]
    else:
        parts = [_primitive(solid.kind, solid.size)]
    return [part @ rows.T + solid.at for part in parts]


def _outward(triangles: Floats) -> Floats:
    """Return the triangles of a convex part, without degenerate ones, counter-clockwise seen from outside."""
    normals = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    inward = np.einsum("ij,ij->i", normals, triangles.mean(1) - triangles.mean((0, 1))) < 0.0
    triangles = np.where(inward[:, None, None], triangles[:, ::-1], triangles)
    kept: Floats = triangles[np.linalg.norm(normals, axis=1) > 0.0]
    return kept


@lru_cache(maxsize=256)
def _primitive(kind: str, size: tuple[float, float, float]) -> Floats:
    """Return the triangles of a box, cylinder or ball around the origin."""
    half = np.array(size) / 2
    if kind == "box":
        corners = np.array(list(product((-1.0, 1.0), repeat=3))) * half
        faces = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
        return _outward(corners[[(a, b, c) for a, b, c, _ in faces] + [(a, c, d) for a, _, c, d in faces]])
    angles = np.arange(SIDES) * 2 * np.pi / SIDES
    if kind == "cylinder":
        heights, radii = (-1.0, 1.0), (1.0, 1.0)
    else:
        slopes = np.linspace(-np.pi / 2, np.pi / 2, SIDES // 2 + 1)[1:-1]
        heights, radii = tuple(np.sin(slopes)), tuple(np.cos(slopes))
    rings = [
        np.stack([r * np.cos(angles), r * np.sin(angles), np.full(SIDES, h)], 1) * half
        for h, r in zip(heights, radii, strict=True)
    ]
    ends = [np.array([0.0, 0.0, z * half[2]]) for z in (-1.0, 1.0)]
    following = np.roll(np.arange(SIDES), -1)
    triangles = []
    for low, high in pairwise(rings):
        triangles += [np.stack([low, low[following], high], 1), np.stack([low[following], high[following], high], 1)]
    for end, ring in ((ends[0], rings[0]), (ends[1], rings[-1])):
        triangles.append(np.stack([np.broadcast_to(end, ring.shape), ring, ring[following]], 1))
    return _outward(np.concatenate(triangles))


@cached_by_geometry(maxsize=1 << 10)
def part_boxes(shape: Shape, quaternion: Quaternion) -> Floats:
    """Return the axis-aligned bounding boxes, in metres, of the convex parts of a rotated body at the origin.

    The array has the shape (n, 2, 3): centres and half-extents. A body without a model has one box.
    """
    if shape.model is None:
        return np.array([((0.0, 0.0, 0.0), extents(shape, quaternion))])
    rows = matrix(Pose((0.0, 0.0, 0.0), quaternion))[:3, :3]
    turned = [part.reshape(-1, 3) @ rows.T for part in part_surfaces(shape)]
    lows, highs = (np.array([end(part, 0) for part in turned]) for end in (np.min, np.max))
    return np.stack([(lows + highs) / 2, (highs - lows) / 2], 1)


class PartOutline(NamedTuple):
    """A convex outline, seen from above: its corners (n, 2) in metres, and the unit normals of its edges (2, n)."""

    corners: Floats
    normals: Floats

    @classmethod
    def of(cls, corners: Floats) -> PartOutline:
        """Return the outline with given corners (n, 2), which are counter-clockwise."""
        edges = np.roll(corners, -1, 0) - corners
        lengths = np.maximum(np.linalg.norm(edges, axis=1), EDGE)
        return cls(corners, np.stack([edges[:, 1], -edges[:, 0]]) / lengths)

    def meets(self, other: PartOutline, offset: Floats, spacing: float) -> bool:
        """Return whether this outline, moved by an offset (2,), may be less than a spacing in metres from another.

        The outlines are farther apart if an edge separates them by at least this spacing (separating axis theorem).
        """
        normals = np.concatenate([self.normals, other.normals], 1)
        ours, theirs = (self.corners + offset) @ normals, other.corners @ normals
        gaps = np.maximum(theirs.min(0) - ours.max(0), ours.min(0) - theirs.max(0))
        return bool(gaps.max() < spacing)


@cached_by_geometry(maxsize=1 << 10)
def part_outlines(shape: Shape, quaternion: Quaternion) -> tuple[PartOutline, ...]:
    """Return the convex outline, seen from above, of each part of a rotated body, in the order of `part_boxes`."""
    if shape.model is None:
        return (PartOutline.of(np.array(outline(shape, Pose((0.0, 0.0, 0.0), quaternion)))),)
    rows = matrix(Pose((0.0, 0.0, 0.0), quaternion))[:2, :3]
    flat = (part.reshape(-1, 3) @ rows.T for part in part_surfaces(shape))
    return tuple(PartOutline.of(np.array(hull([(x, y) for x, y in part.round(7).tolist()]))) for part in flat)
