"""Compute convex hulls of points in space, and whether a mesh is closed or convex."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

ROUNDING = 1e-9
"""The distance within which a point counts as on a face of the hull, as a share of the extent of all points."""

CONVEX = 0.02
"""The share of the hull that may be empty, and the depth that corners may have inside it, as a share of the smallest
extent."""

CHUNK = 1024
"""The number of points whose distances from all faces of a hull are computed at once, to limit the memory."""

DENT = 0.0005
"""The depth in metres of a dent that does not affect collisions, because PyBullet's contacts are less exact than that.
"""


def convex_hull(points: Floats) -> Floats:
    """Return the triangles (n, 3, 3) of the convex hull of points (m, 3), counter-clockwise seen from outside.

    The hull grows by the farthest point outside a face: all faces that are visible from the point are replaced by the
    triangles between the point and the border of these faces (Barber, Dobkin and Huhdanpaa, "The Quickhull algorithm",
    1996). Points that are on a face, apart from rounding errors, are left out. The points must not all lie in a plane.
    """
    points = np.unique(points, axis=0)
    rounding = ROUNDING * float(np.ptp(points, axis=0).max())
    start = _tetrahedron(points)
    inner = points[start].mean(0)
    faces: list[tuple[int, int, int]] = []
    normals, offsets = np.empty((0, 3)), np.empty(0)

    def planes(new: list[tuple[int, int, int]]) -> tuple[Floats, Floats]:
        a, b, c = (points[[face[i] for face in new]] for i in range(3))
        normal = np.cross(b - a, c - a)
        normal /= np.maximum(np.linalg.norm(normal, axis=1), 1e-300)[:, None]
        return normal, np.einsum("ij,ij->i", normal, a)

    for a, b, c in ((0, 1, 2), (0, 1, 3), (0, 2, 3), (1, 2, 3)):
        one, two, three = points[start[a]], points[start[b]], points[start[c]]
        outward = np.cross(two - one, three - one) @ (one - inner) > 0.0
        faces.append((start[a], start[b], start[c]) if outward else (start[a], start[c], start[b]))
    normals, offsets = planes(faces)
    # Each outside point is assigned to the face that it is farthest above, so only replaced faces reassign their
    # points.
    numbers, following = np.arange(len(faces)), len(faces)
    heights = points @ normals.T - offsets
    owner, height = numbers[heights.argmax(1)], heights.max(1)
    height[start] = -np.inf
    while height[highest := int(height.argmax())] > rounding:
        seen = normals @ points[highest] - offsets > rounding
        height[highest] = -np.inf
        edges = {(face[i - 1], face[i]) for face, each in zip(faces, seen, strict=True) if each for i in range(3)}
        new = [(one, two, highest) for one, two in sorted(edges) if (two, one) not in edges]
        moved = np.isin(owner, numbers[seen]) & (height > rounding)
        faces = [face for face, each in zip(faces, seen, strict=True) if not each] + new
        more, further = planes(new)
        fresh = np.arange(following, following + len(new))
        following += len(new)
        normals, offsets = np.concatenate([normals[~seen], more]), np.concatenate([offsets[~seen], further])
        numbers = np.concatenate([numbers[~seen], fresh])
        if moved.any():
            above = points[moved] @ more.T - further
            owner[moved], height[moved] = fresh[above.argmax(1)], above.max(1)
    hull: Floats = points[np.array(faces)]
    return hull


def _tetrahedron(points: Floats) -> list[int]:
    """Return the indices of four points that span a tetrahedron, each the farthest from the previous ones."""
    first = int(points[:, 0].argmin())
    second = int(np.linalg.norm(points - points[first], axis=1).argmax())
    along = (points[second] - points[first]) / np.linalg.norm(points[second] - points[first])
    across = (points - points[first]) - np.outer((points - points[first]) @ along, along)
    third = int(np.linalg.norm(across, axis=1).argmax())
    normal = np.cross(along, across[third])
    fourth = int(np.abs((points - points[first]) @ normal).argmax())
    return [first, second, third, fourth]


def is_closed(triangles: Floats) -> bool:
    """Return whether triangles (n, 3, 3) bound a volume: on each edge, there is one triangle in each direction."""
    _, numbers = np.unique(triangles.reshape(-1, 3), axis=0, return_inverse=True)
    faces = numbers.reshape(-1, 3)
    edges = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])
    keys, back = (edges[:, i] * len(numbers) + edges[:, 1 - i] for i in (0, 1))
    return len(np.unique(keys)) == len(keys) and bool(np.array_equal(np.sort(keys), np.sort(back)))


def separate_solids(triangles: Floats) -> list[Floats]:
    """Return the triangles of each solid of a mesh whose surface consists of several closed surfaces.

    The solids may overlap. The result is empty if a surface is open or faces inwards, as that of a hollow space does.
    """
    points, numbers = np.unique(triangles.reshape(-1, 3), axis=0, return_inverse=True)
    faces = numbers.reshape(-1, 3)
    # Each corner takes the smallest number of its faces' corners until all corners of a solid have the same number.
    labels, before = np.arange(len(points)), np.zeros(0)
    while not np.array_equal(labels, before):
        before = labels.copy()
        np.minimum.at(labels, faces, labels[faces].min(1, keepdims=True))
        labels = labels[labels]
    if len(np.unique(labels)) == 1:
        return []
    solids = [triangles[labels[faces[:, 0]] == label] for label in np.unique(labels)]
    volumes = [np.einsum("ij,ij->", solid[:, 0], np.cross(solid[:, 1], solid[:, 2])) for solid in solids]
    return solids if min(volumes) > 0 and all(map(is_closed, solids)) else []


def is_convex(triangles: Floats) -> bool:
    """Return whether triangles (n, 3, 3) bound their convex hull, apart from small dents.

    No corner may be deep within the hull, and closed triangles must bound nearly its whole volume.
    """
    hull = convex_hull(triangles.reshape(-1, 3))
    points = np.unique(triangles.reshape(-1, 3), axis=0)
    normals = np.cross(hull[:, 1] - hull[:, 0], hull[:, 2] - hull[:, 0])
    normals /= np.maximum(np.linalg.norm(normals, axis=1), 1e-300)[:, None]
    offsets = np.einsum("ij,ij->i", normals, hull[:, 0])
    dent = min(DENT, CONVEX * float(np.ptp(points, axis=0).min()))
    for begin in range(0, len(points), CHUNK):
        if (offsets - points[begin : begin + CHUNK] @ normals.T).min(1).max() > dent:
            return False
    if not is_closed(triangles):
        return True
    volumes = (abs(float(np.linalg.det(each - hull[0, 0]).sum())) for each in (triangles, hull))
    return next(volumes) >= (1.0 - CONVEX) * next(volumes)
