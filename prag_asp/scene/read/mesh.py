"""Read the triangles of a mesh: Wavefront .obj, and .stl as text or binary.

A mesh is as large as the corners of its faces say, exactly: points that no face uses are not part of it, and no margin
of a simulator is. Simulators are handed what is read here, not the file, so that both have the same body.
"""

from __future__ import annotations

import math
import struct
from collections.abc import Iterable, Sequence
from functools import lru_cache
from itertools import chain, pairwise
from pathlib import Path

from prag_asp.errors import SceneError
from prag_asp.safe_reading import read_bytes
from prag_asp.scene.read.scene_values import SMALLEST

LARGEST = 32_000_000
"""Bytes of a mesh."""

HEADER, TRIANGLE = 84, 50
CORNERS = 3
GROUPS = ("o", "g")
Point = tuple[float, float, float]
Triangle = tuple[Point, Point, Point]
Part = tuple[Triangle, ...]


def mesh_parts(path: str, scale: Point = (1.0, 1.0, 1.0)) -> tuple[Part, ...]:
    """Return the triangles of a mesh, multiplied by a scale along each axis, by its parts.

    A body collides as the convex hull of each part. The objects and groups of an .obj are its parts, so that what is
    hollow can be made of convex ones; where one of them is thinner than `SMALLEST` metres, say a side of a box, the
    mesh is one part.

    Raises:
        SceneError: the file cannot be read, is of another format, or has no faces or no finite points.
    """
    scaled = tuple(
        tuple((_scaled(one, scale), _scaled(two, scale), _scaled(three, scale)) for one, two, three in part)
        for part in _parts(path)
    )
    if len(scaled) > 1 and min(thickness(_corners(part)) for part in scaled) < SMALLEST:
        return (tuple(chain.from_iterable(scaled)),)
    return scaled


def mesh_points(path: str, scale: Point = (1.0, 1.0, 1.0)) -> list[Point]:
    """Return the corners of the faces of a mesh, each once, multiplied by a scale along each axis.

    Raises:
        SceneError: as for `mesh_parts`.
    """
    return [_scaled(point, scale) for point in _corners(chain.from_iterable(_parts(path)))]


def thickness(points: Sequence[Point]) -> float:
    """Return how far points reach along the direction in which they are spread least."""
    import numpy as np  # noqa: PLC0415 - few domains have meshes

    centred = np.array(points) - np.mean(points, axis=0)
    least = np.linalg.eigh(centred.T @ centred)[1][:, 0]
    return float(np.ptp(centred @ least))


def _corners(triangles: Iterable[Triangle]) -> list[Point]:
    """Return the corners of triangles, each once."""
    return list(dict.fromkeys(chain.from_iterable(triangles)))


def _scaled(point: Point, scale: Point) -> Point:
    return (point[0] * scale[0], point[1] * scale[1], point[2] * scale[2])


def _parts(path: str) -> tuple[Part, ...]:
    """Return the parts of a mesh in its own unit; a file is read again only where it has changed.

    Raises:
        SceneError: as for `mesh_parts`.
    """
    if Path(path).suffix.lower() not in (".obj", ".stl"):
        raise SceneError(f"{path}: a mesh of unknown format; give an .obj or an .stl")
    return _read(path, *state_of(path))


def state_of(path: str) -> tuple[int, int]:
    """Return when a mesh was modified, in nanoseconds, and its size in bytes: they identify its contents.

    Raises:
        SceneError: the file cannot be read.
    """
    try:
        about = Path(path).stat()
    except OSError as error:
        raise SceneError(f"{path}: cannot be read: {error.strerror}") from error
    return about.st_mtime_ns, about.st_size


@lru_cache(maxsize=32)
def _read(path: str, modified: int, size: int) -> tuple[Part, ...]:
    """Return the parts of a mesh in its own unit; when it was modified and its size identify the contents.

    Raises:
        SceneError: as for `mesh_parts`.
    """
    try:
        content = read_bytes(path, at_most=LARGEST)
        parts = _obj(content) if Path(path).suffix.lower() == ".obj" else [_stl(content)]
    except OSError as error:
        raise SceneError(f"{path}: cannot be read: {error.strerror}") from error
    except (ValueError, struct.error) as error:
        raise SceneError(f"{path}: not a mesh: {error}; export it anew") from error
    result = tuple(tuple(part) for part in parts if part)
    if not result:
        raise SceneError(f"{path}: not a mesh: it has no faces; export it anew")
    if not all(math.isfinite(value) for point in _corners(chain.from_iterable(result)) for value in point):
        raise SceneError(f"{path}: not a mesh: a point is not finite; export it anew")
    return result


def _obj(content: bytes) -> list[list[Triangle]]:
    """Return the triangles of a Wavefront .obj by its objects and groups; a face of more corners is a fan of them."""
    points: list[Point] = []
    parts: list[list[Triangle]] = [[]]
    text = content.decode("utf-8", "replace").replace("\\\r\n", " ").replace("\\\n", " ")
    for number, line in enumerate(text.splitlines(), 1):
        match line.split():
            case ["v", *words]:
                points.append(_point(words[:CORNERS]))
            case ["f", *words]:
                if len(words) < CORNERS:
                    raise ValueError(f"a face of {len(words)} corners in line {number}")
                first, *others = [_corner(word, points, number) for word in words]
                parts[-1] += [(first, one, two) for one, two in pairwise(others)]
            case [group, *_] if group in GROUPS:
                parts.append([])
    return parts


def _corner(word: str, points: Sequence[Point], number: int) -> Point:
    """Return the corner of a face that a word such as ``3/1/2`` names: from 1 on, or from -1 back.

    Raises:
        ValueError: there is no such point before this line.
    """
    index = int(word.partition("/")[0])
    if index == 0 or not -len(points) <= index <= len(points):
        raise ValueError(f"a face with the corner {index} of {len(points)} points in line {number}")
    return points[index - 1 if index > 0 else index]


def _stl(content: bytes) -> list[Triangle]:
    """Return the triangles of an .stl; a binary one says how many it has."""
    count = struct.unpack_from("<I", content, HEADER - 4)[0] if len(content) >= HEADER else -1
    if len(content) == HEADER + count * TRIANGLE:
        rows = (struct.unpack_from("<12f", content, HEADER + i * TRIANGLE) for i in range(count))
        return [(row[3:6], row[6:9], row[9:12]) for row in rows]
    words = (line.split() for line in content.decode("utf-8", "replace").splitlines())
    points = [_point(row[1:4]) for row in words if row and row[0] == "vertex"]
    if len(points) % CORNERS:
        raise ValueError(f"{len(points)} corners, which make no triangles")
    return list(zip(points[::3], points[1::3], points[2::3], strict=True))


def _point(words: list[str]) -> Point:
    """Return three words as a point."""
    x, y, z = map(float, words)
    return (x, y, z)
