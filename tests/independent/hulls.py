"""Convex hulls of points and of the meshes that come with PyBullet, and points spread over their surfaces.

What the check sees of two hulls, or of a hull and a primitive, is points of the one within the other: a point that is
so deep in a body proves that the two overlap by as much, so that nothing is reported that is not so. What lies between
two such points it can miss: where a face is flat nothing, where an edge pokes in about a millimetre.
"""

from __future__ import annotations

from functools import cache
from itertools import combinations
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pybullet_data
from numpy.typing import NDArray

from tests.independent.frames import Array

Whole = NDArray[np.int64]

GRAIN = 1e-5
"""Metres to which corners are rounded, and by which one may stand out of its hull: corners that nearly lie in a plane
would else make slivers of faces."""


class Hull(NamedTuple):
    """A convex solid: unit normals of its faces (m, 3), their distances from the origin (m,), points on it (n, 3).

    All of it lies within a ball. `corners`, shape (k, 3), are those of its faces.
    """

    normals: Array
    offsets: Array
    points: Array
    middle: Array
    radius: float
    corners: Array

    def within(self, points: Array) -> Array:
        """Return by how many metres points, shape (k, 3), lie within the hull; negative outside."""
        return np.asarray((self.offsets - points @ self.normals.T).min(axis=1))


def hull_of(corners: Array, spacing: float) -> Hull:
    """Return the hull of corners, shape (n, 3), with points on it no farther apart than about `spacing` metres."""
    corners = np.unique(corners.round(5), axis=0)
    faces = _faces(corners)
    triangles = corners[faces]
    normals = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    used = corners[np.unique(faces)]
    middle = (used.min(axis=0) + used.max(axis=0)) / 2
    radius = float(np.linalg.norm(used - middle, axis=1).max())
    points = _spread(used, triangles, spacing)
    return Hull(normals, (normals * triangles[:, 0]).sum(axis=1), points, middle, radius, used)


def _faces(corners: Array) -> Whole:
    """Return the triangles of a convex hull, shape (m, 3), each counter-clockwise seen from outside.

    It grows from a tetrahedron by the corner that is farthest out; what that corner sees is replaced by a cone.
    """
    faces, left = _tetrahedron(corners), np.arange(len(corners))
    while True:
        normals, offsets = _planes(corners, faces)
        out = corners[left] @ normals.T - offsets
        left, out = left[out.max(axis=1) > GRAIN], out[out.max(axis=1) > GRAIN]
        if not len(left):
            return faces
        farthest = int(out.max(axis=1).argmax())
        seen = out[farthest] > 0.0
        edges = {(a, b) for face in faces[seen].tolist() for a, b in zip(face, face[1:] + face[:1], strict=True)}
        rim = [(a, b, int(left[farthest])) for a, b in edges if (b, a) not in edges]
        faces = np.concatenate([faces[~seen], np.array(sorted(rim))])


def _planes(corners: Array, faces: Whole) -> tuple[Array, Array]:
    """Return the outward normals of triangles and how far their planes are from the origin."""
    one, two, three = (corners[faces[:, k]] for k in range(3))
    normals = np.cross(two - one, three - one)
    normals /= np.maximum(np.linalg.norm(normals, axis=1), 1e-300)[:, None]
    return normals, (normals * one).sum(axis=1)


def _tetrahedron(corners: Array) -> Whole:
    """Return the faces of a tetrahedron of four corners that are far apart."""
    a, b = int(corners[:, 0].argmin()), int(corners[:, 0].argmax())
    along = corners[b] - corners[a]
    c = int(np.linalg.norm(np.cross(corners - corners[a], along), axis=1).argmax())
    normal = np.cross(along, corners[c] - corners[a])
    d = int(np.abs((corners - corners[a]) @ normal).argmax())
    middle = corners[[a, b, c, d]].mean(axis=0)
    faces = []
    for i, j, k in combinations((a, b, c, d), 3):
        outward = np.cross(corners[j] - corners[i], corners[k] - corners[i]) @ (corners[i] - middle) > 0.0
        faces.append((i, j, k) if outward else (i, k, j))
    return np.array(faces)


def _spread(corners: Array, triangles: Array, spacing: float) -> Array:
    """Return the corners and points of the triangles, one of those that share a cell of a grid."""
    found = [corners]
    for a, b, c in triangles:
        longest = max(np.linalg.norm(b - a), np.linalg.norm(c - a), np.linalg.norm(c - b))
        steps = int(longest / (spacing / 2)) + 1
        i, j = np.nonzero(np.add.outer(np.arange(steps + 1), np.arange(steps + 1)) <= steps)
        found.append(a + np.outer(i / steps, b - a) + np.outer(j / steps, c - a))
    points = np.concatenate(found)
    cells = np.floor(points / spacing).astype(int)
    _, first = np.unique(cells, axis=0, return_index=True)
    return np.asarray(points[np.sort(first)])


@cache
def mesh_hull(path: str, spacing: float) -> Hull:
    """Return the hull of a mesh that comes with PyBullet: an OBJ of text, or an STL of bytes."""
    file = Path(pybullet_data.getDataPath()) / path
    return hull_of(_stl(file) if file.suffix == ".stl" else _obj(file), spacing)


def _obj(file: Path) -> Array:
    """Return the corners of all faces of an OBJ file; a face names them by numbers that begin with 1."""
    lines = [line.split() for line in file.read_text().splitlines()]
    corners = np.array([line[1:4] for line in lines if line[:1] == ["v"]], dtype=float)
    used = {int(word.split("/")[0]) - 1 for line in lines if line[:1] == ["f"] for word in line[1:]}
    return np.asarray(corners[sorted(used)])


def _stl(file: Path) -> Array:
    """Return the corners of an STL file: after 84 bytes each triangle is a normal, three corners and two bytes."""
    record = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("rest", "<u2")])
    return np.asarray(np.frombuffer(file.read_bytes()[84:], dtype=record)["corners"].reshape(-1, 3), dtype=float)


def box_hull(centre: tuple[float, float, float], size: tuple[float, float, float], spacing: float) -> Hull:
    """Return the hull of a box by its centre and its sides."""
    signs = np.array([(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)])
    return hull_of(np.array(centre) + signs * np.array(size) / 2, spacing)
