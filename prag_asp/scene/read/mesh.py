"""Read the points of a mesh: Wavefront .obj, and .stl as text or binary."""

from __future__ import annotations

import math
import struct
from collections.abc import Sequence
from pathlib import Path

from prag_asp.errors import SceneError

HEADER, TRIANGLE = 84, 50
Point = tuple[float, float, float]


def mesh_points(path: str) -> list[Point]:
    """Return the points of a mesh, in its own unit.

    Raises:
        SceneError: the file cannot be read, is of another format, or has no finite points.
    """
    suffix = Path(path).suffix.lower()
    if suffix not in (".obj", ".stl"):
        raise SceneError(f"{path}: a mesh of unknown format; give an .obj or an .stl")
    try:
        content = Path(path).read_bytes()
        points = _obj(content) if suffix == ".obj" else _stl(content)
    except OSError as error:
        raise SceneError(f"{path}: cannot be read: {error.strerror}") from error
    except (ValueError, struct.error) as error:
        raise SceneError(f"{path}: not a mesh: {error}; export it anew") from error
    if not points or not all(math.isfinite(value) for point in points for value in point):
        raise SceneError(f"{path}: not a mesh: it has no points, or some that are not finite; export it anew")
    return points


def thickness(points: Sequence[Point]) -> float:
    """Return how far points reach along the direction in which they are spread least."""
    import numpy as np  # noqa: PLC0415 - few domains have meshes

    centred = np.array(points) - np.mean(points, axis=0)
    least = np.linalg.eigh(centred.T @ centred)[1][:, 0]
    return float(np.ptp(centred @ least))


def _obj(content: bytes) -> list[Point]:
    """Return the points of a Wavefront .obj."""
    rows = (line.split() for line in content.decode("utf-8", "replace").splitlines())
    return [_point(row[1:4]) for row in rows if row and row[0] == "v"]


def _stl(content: bytes) -> list[Point]:
    """Return the points of an .stl; a binary one says how many triangles it has."""
    count = struct.unpack_from("<I", content, HEADER - 4)[0] if len(content) >= HEADER else -1
    if len(content) == HEADER + count * TRIANGLE:
        found: list[Point] = []
        for i in range(count):
            values = struct.unpack_from("<12f", content, HEADER + i * TRIANGLE)
            found += [(values[k], values[k + 1], values[k + 2]) for k in (3, 6, 9)]
        return found
    rows = (line.split() for line in content.decode("utf-8", "replace").splitlines())
    return [_point(row[1:4]) for row in rows if row and row[0] == "vertex"]


def _point(words: list[str]) -> Point:
    """Return three words as a point."""
    x, y, z = map(float, words)
    return (x, y, z)
