"""Compute the extent of a rotated body from the shape of a primitive or the solids of a model.

The bounding box of a model along the axes of its file says little about a body that stands obliquely in that file, so
everything is measured on the convex hull of the solids. Lengths are metres.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from prag_asp.scene.boxes import Vector
from prag_asp.scene.forms import FORMS, Outline
from prag_asp.scene.geometry import IDENTITY, Pose, Quaternion, extents, hull, matrix, outline, rotate
from prag_asp.scene.read.convex import convex_hull
from prag_asp.scene.read.stability import rotation
from prag_asp.scene.scene import Shape, Solid
from prag_asp.scene.solids import solids
from prag_asp.scene.surfaces import cached_by_geometry, solid_parts, surface

Floats = NDArray[np.float64]

ORIGIN: Vector = (0.0, 0.0, 0.0)

OBLIQUE = 0.98
"""A body is measured along the smallest rectangle around it if the area of this rectangle is at most this share of the
area of the rectangle along the axes of the file."""


class BodyExtent(NamedTuple):
    """A bounding box: its centre relative to the origin of the body, and its half-extents, in metres.

    For a body without a model, the centre is the origin.
    """

    centre: Vector
    half: Vector


class _Hull(NamedTuple):
    """The corners (n, 3) of the convex hull of a body's boxes and meshes, and its round solids."""

    corners: Floats
    rounds: tuple[Solid, ...]


@cached_by_geometry(maxsize=1 << 11)
def extent(shape: Shape, quaternion: Quaternion) -> BodyExtent:
    """Return the axis-aligned bounding box of a rotated body at the origin."""
    if shape.model is None:
        return BodyExtent(ORIGIN, extents(shape, quaternion))
    low, high = reach(shape, matrix(Pose(ORIGIN, quaternion))[:3, :3])
    (x, y, z), (dx, dy, dz) = ((high + low) / 2).tolist(), ((high - low) / 2).tolist()
    return BodyExtent((x, y, z), (dx, dy, dz))


@cached_by_geometry(maxsize=1 << 11)
def extent_along(shape: Shape, quaternion: Quaternion, direction: Vector) -> tuple[float, float]:
    """Return the middle of a rotated body along a unit vector, relative to the body's origin, and half of its width."""
    x, y, z, w = quaternion
    along = rotate((-x, -y, -z, w), direction)
    if shape.model is None:
        return 0.0, shape.traits.form.reach(shape.half, along)
    low, high = reach(shape, np.array([along]))
    return float(high[0] + low[0]) / 2, float(high[0] - low[0]) / 2


def reach(shape: Shape, directions: Floats) -> tuple[Floats, Floats]:
    """Return the least and the greatest coordinates (n,) of a body with a model along unit vectors (n, 3) in its frame.

    Raises:
        SceneError: a mesh cannot be read.
    """
    corners, rounds = _hull(shape)
    lows, highs = [], []
    if len(corners):
        along = directions @ corners.T
        lows, highs = [along.min(1)], [along.max(1)]
    for solid in rounds:
        half = (solid.size[0] / 2, solid.size[1] / 2, solid.size[2] / 2)
        own = directions @ np.array(rotation(solid.turn))
        far = np.array([FORMS[solid.kind].reach(half, (x, y, z)) for x, y, z in own.tolist()])
        middle = directions @ np.array(solid.at)
        lows.append(middle - far)
        highs.append(middle + far)
    return np.min(lows, axis=0), np.max(highs, axis=0)


@cached_by_geometry(maxsize=256)
def _hull(shape: Shape) -> _Hull:
    """Return the corners of the hull of a body with a model, and its round solids."""
    rounds = tuple(solid for solid in solids(shape) if solid.kind in ("cylinder", "sphere"))
    parts = [part for solid in solids(shape) if solid not in rounds for part in solid_parts(solid)]
    if not parts:
        return _Hull(np.empty((0, 3)), rounds)
    triangles = convex_hull(np.concatenate(parts).reshape(-1, 3))
    return _Hull(np.unique(triangles.reshape(-1, 3), axis=0), rounds)


@cached_by_geometry(maxsize=1 << 11)
def silhouette(shape: Shape, pose: Pose) -> Outline:
    """Return the convex outline of a body seen from above, counter-clockwise.

    Round solids of a model are tessellated; a body without a model has to be upright.
    """
    if shape.model is None:
        return outline(shape, pose)
    placed = surface(shape).reshape(-1, 3) @ matrix(pose)[:2, :3].T + pose.position[:2]
    return hull([(x, y) for x, y in placed.round(9).tolist()])


@cached_by_geometry(maxsize=256)
def side_yaw(shape: Shape) -> float:
    """Return the yaw in radians, in the frame of an upright body, of the smallest rectangle around it.

    The yaw is 0 if a rectangle along the axes of the frame is about as small, as for round bodies.
    """
    if shape.model is None or shape.traits.round:
        return 0.0
    corners = np.array(silhouette(shape, Pose(ORIGIN, IDENTITY)))
    edges = np.roll(corners, -1, 0) - corners
    yaws = np.append(0.0, np.arctan2(edges[:, 1], edges[:, 0]) % (math.pi / 2))
    along = np.stack([np.cos(yaws), np.sin(yaws)], 1)
    across = np.stack([-along[:, 1], along[:, 0]], 1)
    areas = np.ptp(along @ corners.T, axis=1) * np.ptp(across @ corners.T, axis=1)
    best = int(areas.argmin())
    if areas[best] > OBLIQUE * areas[0]:
        return 0.0
    # the smallest of the four equivalent yaws
    return float(yaws[best] - math.pi / 2 if yaws[best] > math.pi / 4 else yaws[best])


@cached_by_geometry(maxsize=256)
def least_reach(shape: Shape) -> float:
    """Return a lower bound, in metres, on the extent of a body from its origin in any direction.

    For a convex body that contains its origin, the bound is the distance to the nearest face. It is negative if the
    origin is outside the body.
    """
    if shape.model is None:
        return min(shape.half)
    triangles = convex_hull(surface(shape).reshape(-1, 3))
    normals = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    lengths = np.linalg.norm(normals, axis=1)
    flat = lengths > 0.0
    nearest = float((np.einsum("ij,ij->i", normals, triangles[:, 0])[flat] / lengths[flat]).min())
    # The least reach is minus the distance from the origin to the body, which is at most the distance to a corner.
    return nearest if nearest >= 0.0 else -float(np.linalg.norm(triangles.reshape(-1, 3), axis=1).min())
