"""Pairs of contacts at the edges of a body: between an edge and a face that is opposite to it, or between two edges.

A flat pad touches an edge in every direction of the edge's normal cone, and the force then acts along the normal of the
pad. A prism over a triangle, which has no parallel sides, can thus be held between an edge and the opposite side.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from prag_asp.physics.grasps.normal_cones import edges_and_corners, unit_normals
from prag_asp.physics.grasps.surface_rays import SurfaceRays

Floats = NDArray[np.float64]

MOST_EDGES, SHORTEST = 64, 0.004
"""The maximum number of edges of a body to consider, longest first, and the smallest length of an edge in metres."""

SPACING = 0.012
"""The largest distance in metres between two points on an edge."""

SIMILAR = math.cos(0.2)
"""The cosine of the angle between two closing axes at an edge from which they count as the same axis."""

NARROWEST = 0.002
"""The smallest distance in metres between two edges that are contacts of a grasp."""

ROUNDED = 6
"""The number of decimals to which the normals of faces are equal."""

PARALLEL = 1e-9
"""The squared sine of an angle below which two edges are parallel."""


class Edges(NamedTuple):
    """Convex edges of a body: where they begin (n, 3), their vectors (n, 3), and the normals of both faces (n, 2, 3).

    Lengths are in metres.
    """

    begins: Floats
    vectors: Floats
    normals: Floats

    def points(self, number: int) -> Floats:
        """Return evenly spaced points (m, 3) on an edge."""
        count = math.ceil(float(np.linalg.norm(self.vectors[number])) / SPACING)
        points: Floats = self.begins[number] + (np.arange(count)[:, None] + 0.5) / count * self.vectors[number]
        return points

    def cosines(self, axes: Floats) -> Floats:
        """Return the largest cosine between each axis (..., n, 3) and a direction in the normal cone of its edge."""
        one, two = (np.einsum("...nk,nk->...n", axes, self.normals[:, i]) for i in (0, 1))
        between = np.einsum("nk,nk->n", self.normals[:, 0], self.normals[:, 1])
        # The projection of an axis onto the plane of both normals is a combination of them.
        first, second = ((a - between * b) / (1 - between**2) for a, b in ((one, two), (two, one)))
        projected = np.sqrt(np.clip(first * one + second * two, 0.0, 1.0))
        cosines: Floats = np.where((first >= 0.0) & (second >= 0.0), projected, np.maximum(one, two))
        return cosines


def edge_pairs(
    parts: Sequence[Floats], rays: SurfaceRays, least: float, opening: float
) -> Iterator[tuple[Floats, Floats, Floats]]:
    """Yield points on edges, the points opposite to them, and the unit vectors from the latter to the former.

    `parts` (n, 3, 3) are convex parts as triangles in metres, and `rays` finds their faces; `least` is the cosine of
    the largest angle between the line of a grasp and a contact.
    """
    edges = _sharp_edges(parts, least)
    faces = np.unique(np.round(unit_normals(np.concatenate(parts)), ROUNDED), axis=0)
    for i in range(len(edges.begins)):
        points = edges.points(i)
        for axis in _axes(edges, i, faces, least):
            for point in points:
                for length in rays.lengths(point, -axis, least, opening):
                    yield point, point - length * axis, axis
        yield from _opposite_edges(edges, i, points, least, opening)


def _sharp_edges(parts: Sequence[Floats], least: float) -> Edges:
    """Return the longest edges of convex parts whose two faces are too oblique to each other to be held as one."""
    found = []
    for part in parts:
        for place, normals in edges_and_corners(part):
            length = float(np.linalg.norm(place[1] - place[0]))
            if len(normals) == 2 and normals[0] @ normals[1] < least and length >= SHORTEST:
                found.append((length, place, normals))
    found = sorted(found, key=lambda row: -row[0])[:MOST_EDGES]
    places = np.array([place for _, place, _ in found]).reshape(-1, 3, 3)
    return Edges(
        places[:, 0], places[:, 1] - places[:, 0], np.array([normals for *_, normals in found]).reshape(-1, 2, 3)
    )


def _axes(edges: Edges, number: int, faces: Floats, least: float) -> list[Floats]:
    """Return closing axes at an edge: opposite to faces of the body, and the bisector of the two faces of the edge."""
    middle = edges.normals[number].sum(0)
    axes = -faces
    within = Edges(*(each[number : number + 1] for each in edges)).cosines(axes[:, None])[:, 0] >= least
    kept: list[Floats] = []
    for axis in (*axes[within], middle / np.linalg.norm(middle)):
        if all(axis @ other < SIMILAR for other in kept):
            kept.append(axis)
    return kept


def _opposite_edges(
    edges: Edges, number: int, points: Floats, least: float, opening: float
) -> Iterator[tuple[Floats, Floats, Floats]]:
    """Yield pairs of points on an edge and on later edges, nearest to each other, as `edge_pairs` does."""
    after = Edges(*(each[number + 1 :] for each in edges))
    begin, vector = edges.begins[number], edges.vectors[number]
    between = begin - after.begins
    squares = np.einsum("nk,nk->n", after.vectors, after.vectors)
    product, along = after.vectors @ vector, np.einsum("nk,nk->n", after.vectors, between)
    scale = (vector @ vector) * squares - product**2
    skew = scale > PARALLEL * (vector @ vector) * squares
    share = np.where(skew, (product * along - squares * (between @ vector)) / np.where(skew, scale, 1.0), 0.5)
    # The point of the edge that is nearest to the other edge's line, and all points on the edge.
    near = begin + np.clip(share, 0.0, 1.0)[:, None] * vector
    starts = np.concatenate([np.broadcast_to(points[:, None], (len(points), *near.shape)), near[None]])
    shares = np.einsum("mnk,nk->mn", starts - after.begins, after.vectors) / squares
    ends = after.begins + np.clip(shares, 0.0, 1.0)[..., None] * after.vectors
    lines = starts - ends
    lengths = np.linalg.norm(lines, axis=2)
    axes = lines / np.maximum(lengths, NARROWEST)[..., None]
    own = Edges(*(each[number : number + 1] for each in edges))
    held = (lengths > NARROWEST) & (lengths <= opening) & (after.cosines(-axes) >= least)
    held &= own.cosines(axes[..., None, :])[..., 0] >= least
    for row, column in zip(*np.nonzero(held), strict=True):
        yield starts[row, column], ends[row, column], axes[row, column]
