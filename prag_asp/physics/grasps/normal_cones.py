"""The faces, edges and corners of a convex part, and the directions from which a flat pad can touch them.

A flat pad touches an edge or a corner in any direction of its normal cone: the non-negative combinations of the outward
normals of the faces that meet there (Rockafellar, "Convex analysis", 1970, section 2).
"""

from __future__ import annotations

import math
from collections import defaultdict
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

SAME = 9
"""The number of decimals to which coordinates of corners, in metres, are compared."""

ROUNDING = 1e-6
"""The length below which a cross product of unit vectors is 0."""


class Feature(NamedTuple):
    """A face, an edge or a corner: a triangle (3, 3) in metres, with repeated points, and the cone's normals (n, 3)."""

    place: Floats
    normals: Floats


def unit_normals(triangles: Floats) -> Floats:
    """Return the unit normals (n, 3) of triangles (n, 3, 3)."""
    normals = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    return np.asarray(normals / np.linalg.norm(normals, axis=1)[:, None])


def edges_and_corners(part: Floats) -> list[Feature]:
    """Return the edges and corners of a convex part that is given by its triangles (n, 3, 3)."""
    met: dict[tuple[tuple[float, ...], ...], list[Floats]] = defaultdict(list)
    for triangle, normal in zip(part, unit_normals(part), strict=True):
        corners = [tuple(corner) for corner in (np.round(triangle, SAME) + 0.0).tolist()]
        for i, corner in enumerate(corners):
            met[corner,].append(normal)
            met[tuple(sorted((corner, corners[i - 1])))].append(normal)
    features = (
        (np.array([*place, place[-1], place[-1]][:3]), distinct_normals(normals)) for place, normals in met.items()
    )
    return [Feature(place, normals) for place, normals in features]


def distinct_normals(normals: list[Floats]) -> Floats:
    """Return the unit normals (n, 3) of faces, only once for parallel faces."""
    kept: list[Floats] = []
    for normal in normals:
        if all(normal @ other < 1 - 1e-12 for other in kept):
            kept.append(normal)
    return np.array(kept)


def caps(features: list[Feature]) -> tuple[Floats, Floats]:
    """Return the axes (n, 3) and the half angles (n) in radians of circular cones that contain the normal cones."""
    sums = np.array([feature.normals.mean(0) for feature in features])
    axes = sums / np.maximum(np.linalg.norm(sums, axis=1), 1e-12)[:, None]
    cosines = [(feature.normals @ axis).min() for feature, axis in zip(features, axes, strict=True)]
    # A circular cone that is not convex need not contain the cone of its normals.
    return axes, np.where(np.array(cosines) > 0, np.arccos(np.clip(cosines, -1, 1)), math.pi)


def angle_between(one: Floats, two: Floats) -> float:
    """Return the least angle in radians between the convex cones that two sets of unit vectors generate.

    If no plane separates the cones, the angle is 0. Otherwise the least angle is at a generator of one of the cones.
    """
    if not _are_separate(one, two):
        return 0.0
    return math.acos(min(1.0, max(_largest_cosine(one, two), _largest_cosine(two, one))))


def _are_separate(one: Floats, two: Floats) -> bool:
    """Return whether a plane through two generators, or halfway between two, has the cones on different sides."""
    every = np.concatenate([one, two])
    i, j = np.triu_indices(len(every), 1)
    planes = np.concatenate([np.cross(every[i], every[j]), every[i] - every[j]])
    planes = planes[np.linalg.norm(planes, axis=1) > ROUNDING]
    above, below = planes @ one.T, planes @ two.T
    sides = [((sign * above >= -(ROUNDING**2)).all(1) & (sign * below <= ROUNDING**2).all(1)).any() for sign in (1, -1)]
    return any(sides)


def _largest_cosine(directions: Floats, cone: Floats) -> float:
    """Return the largest cosine between a direction and a vector in the faces of a cone."""
    cosines = directions @ cone.T
    i, j = np.triu_indices(len(cone), 1)
    between = np.einsum("ij,ij->i", cone[i], cone[j])
    i, j, between = (each[np.abs(between) < 1 - ROUNDING] for each in (i, j, between))
    # The projection of a direction onto the plane of two generators is a combination of them.
    first = (cosines[:, i] - between * cosines[:, j]) / (1 - between**2)
    second = (cosines[:, j] - between * cosines[:, i]) / (1 - between**2)
    squares = first * cosines[:, i] + second * cosines[:, j]
    inside = (first >= 0) & (second >= 0)
    on_faces = np.sqrt(np.clip(squares[inside], 0, 1))
    return float(max(cosines.max(), on_faces.max(initial=-1.0)))
