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

SAME_ANGLE = 1e-6
"""The angle in radians within which two faces at an edge lie on each other."""

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
    """Return whether triangles (n, 3, 3) bound a volume: on each edge, there are as many in one direction as the other.

    No triangle may be there twice.
    """
    faces = _numbered(triangles)[1]
    ordered = np.take_along_axis(faces, (faces.argmin(1)[:, None] + np.arange(3)) % 3, 1)
    edges = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])
    keys, back = (edges[:, i] * 3 * len(triangles) + edges[:, 1 - i] for i in (0, 1))
    return len(np.unique(ordered, axis=0)) == len(faces) and bool(np.array_equal(np.sort(keys), np.sort(back)))


def separate_solids(triangles: Floats) -> list[Floats]:
    """Return the triangles of each solid of a mesh whose surface consists of several closed surfaces.

    The solids may overlap, or touch each other at corners, edges and faces. The result is empty if a surface is open or
    faces inwards, as that of a hollow space does.
    """
    if not is_closed(triangles):
        return []
    points, faces = _numbered(triangles)
    pairs = _adjacent_faces(points, faces)
    # Each face takes the smallest number of its neighbours until all faces of a solid have the same number.
    labels, before = np.arange(len(faces)), np.zeros(0)
    while not np.array_equal(labels, before):
        before = labels.copy()
        least = labels[pairs].min(1)
        np.minimum.at(labels, pairs[:, 0], least)
        np.minimum.at(labels, pairs[:, 1], least)
        labels = labels[labels]
    members = [labels == label for label in np.unique(labels)]
    if len(members) == 1:
        return []
    solids = [triangles[own] for own in sorted(members, key=lambda own: int(faces[own].min()))]
    volumes = [np.einsum("ij,ij->", solid[:, 0], np.cross(solid[:, 1], solid[:, 2])) for solid in solids]
    return solids if min(volumes) > 0 else []


def _numbered(triangles: Floats) -> tuple[Floats, NDArray[np.int_]]:
    """Return the distinct corners (m, 3) of triangles, and the triangles as their numbers (n, 3)."""
    points, numbers = np.unique(triangles.reshape(-1, 3), axis=0, return_inverse=True)
    return points, numbers.reshape(-1, 3)


def _adjacent_faces(points: Floats, faces: NDArray[np.int_]) -> NDArray[np.int_]:
    """Return the pairs (m, 2) of faces of a closed surface that meet at an edge and bound the same solid there."""
    begins, ends = faces.T.ravel(), faces[:, [1, 2, 0]].T.ravel()
    owners, others = np.tile(np.arange(len(faces)), 3), faces[:, [2, 0, 1]].T.ravel()
    forward = begins < ends
    keys = np.minimum(begins, ends) * len(points) + np.maximum(begins, ends)
    order = np.lexsort((~forward, keys))
    starts = np.flatnonzero(np.diff(keys[order], prepend=-1))
    counts = np.diff(starts, append=len(order))
    plain = starts[counts == 2]
    pairs = [np.stack([owners[order[plain]], owners[order[plain + 1]]], 1)]
    for start, count in zip(starts[counts > 2].tolist(), counts[counts > 2].tolist(), strict=True):
        met = order[start : start + count]
        edge = points[max(begins[met[0]], ends[met[0]])] - points[min(begins[met[0]], ends[met[0]])]
        ranks = _ranks_about(edge, points[others[met]] - points[begins[met]])
        pairs.append(owners[met][_wedges(ranks, forward[met])])
    return np.concatenate(pairs)


def _ranks_about(edge: Floats, directions: Floats) -> NDArray[np.int_]:
    """Return the ranks of directions (n, 3) by their angles about an edge; those within `SAME_ANGLE` are equal."""
    edge = edge / np.linalg.norm(edge)
    across = directions - np.outer(directions @ edge, edge)
    angles = np.arctan2(across @ np.cross(edge, across[0]), across @ across[0])
    order = np.argsort(angles)
    apart = np.diff(angles[order], prepend=angles[order[-1]] - 2 * np.pi) > SAME_ANGLE
    ranks = np.empty(len(angles), dtype=int)
    # The first directions may equal the last ones, half a turn from the first direction.
    ranks[order] = np.cumsum(apart) % max(int(apart.sum()), 1)
    return ranks


def _wedges(ranks: NDArray[np.int_], closes: NDArray[np.bool_]) -> NDArray[np.int_]:
    """Return the pairs (n / 2, 2) of faces about an edge between which a solid lies.

    Counter-clockwise about the edge, a solid begins behind a face that does not run along the edge, and ends at one
    that `closes` it. The pairs are nested as brackets are.
    """
    order = np.lexsort((~closes, ranks))
    depth = np.cumsum(np.where(closes[order], -1, 1))
    opened, pairs = list[int](), list[tuple[int, int]]()
    for face in np.roll(order, -int(depth.argmin()) - 1).tolist():
        if closes[face]:
            pairs.append((opened.pop(), face))
        else:
            opened.append(face)
    return np.array(pairs)


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
