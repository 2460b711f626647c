"""Read meshes: Wavefront .obj, and .stl as text or binary.

A simulator reads such a file by code that trusts it: a corner that is not there or a file without triangles ends the
process, and an .obj leads on to other files, of materials and of textures. So it gets one that is written here, of the
points and triangles that were understood, and nothing else.
"""

from __future__ import annotations

import math
import struct
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import NamedTuple

from prag_asp.errors import SceneError
from prag_asp.reading import read_bytes

HEADER, TRIANGLE = 84, 50
LARGEST = 32_000_000
"""Bytes of a mesh."""

INDEXED = {"v": 3, "vt": 2, "vn": 3}
"""What the corners of a face in an .obj name by its number, each with how many numbers it has."""

GROUPS = ("o", "g")
Point = tuple[float, float, float]


class Mesh(NamedTuple):
    """The points that faces of a mesh have as corners, in its own unit, and a file of nothing but those."""

    points: list[Point]
    written: bytes


def mesh_points(path: str) -> list[Point]:
    """Return the points of a mesh, in its own unit.

    Raises:
        SceneError: the file cannot be read, is of another format, or has no finite points.
    """
    return read_mesh(path).points


def read_mesh(path: str) -> Mesh:
    """Return what a file says of a mesh.

    Raises:
        SceneError: the file cannot be read, is of another format, has no finite points, or faces without corners.
    """
    suffix = Path(path).suffix.lower()
    if suffix not in (".obj", ".stl"):
        raise SceneError(f"{path}: a mesh of unknown format; give an .obj or an .stl")
    try:
        content = read_bytes(path, at_most=LARGEST)
        mesh = _obj(content) if suffix == ".obj" else _stl(content)
    except OSError as error:
        raise SceneError(f"{path}: cannot be read: {error.strerror}") from error
    except (ValueError, struct.error) as error:
        raise SceneError(f"{path}: not a mesh: {error}; export it anew") from error
    if not mesh.points or not all(math.isfinite(value) for point in mesh.points for value in point):
        raise SceneError(f"{path}: not a mesh: it has no points, or some that are not finite; export it anew")
    return mesh


def thickness(points: Sequence[Point]) -> float:
    """Return how far points reach along the direction in which they are spread least."""
    import numpy as np  # noqa: PLC0415 - few domains have meshes

    centred = np.array(points) - np.mean(points, axis=0)
    least = np.linalg.eigh(centred.T @ centred)[1][:, 0]
    return float(np.ptp(centred @ least))


def _obj(content: bytes) -> Mesh:
    """Return the mesh of a Wavefront .obj: what its faces are made of, in the groups that they stand in."""
    rows = [line.split() for line in content.decode("utf-8", "replace").split("\n")]
    found: dict[str, list[Sequence[float]]] = {kind: [] for kind in INDEXED}
    totals = {kind: sum(row[:1] == [kind] for row in rows) for kind in INDEXED}
    lines: list[str] = []
    corners: set[int] = set()
    for row in rows:
        if not row:
            continue
        kind, *words = row
        if kind in INDEXED:
            values = _numbers(words[: INDEXED[kind]], INDEXED[kind])
            found[kind].append(values)
            lines.append(f"{kind} {' '.join(map(repr, values))}")
        elif kind == "f":
            face = [_corner(word, found, totals) for word in words]
            if len(face) < 3:
                raise ValueError(f"a face has {len(face)} corners")
            corners |= {numbers[0] for numbers in face}
            lines.append(f"f {' '.join('/'.join(str(n or '') for n in numbers).rstrip('/') for numbers in face)}")
        elif kind in GROUPS:
            lines.append(f"{kind} part")
    if not corners:  # a cloud of points; the simulator takes those of faces only
        corners = {*range(1, totals["v"] + 1)}
        lines += [f"f {number} {number} {number}" for number in corners]
    points = [_point(found["v"][number - 1]) for number in sorted(corners)]
    return Mesh(points, "\n".join([*lines, ""]).encode())


def _corner(word: str, found: dict[str, list[Sequence[float]]], totals: dict[str, int]) -> tuple[int, ...]:
    """Return the numbers of the point, the texture's point and the normal of a corner, from 1; 0 where it has none.

    Raises:
        ValueError: it is no corner, or names something that is not there.
    """
    numbers = []
    for kind, text in zip(INDEXED, word.split("/"), strict=False):
        number = int(text) if text or kind == "v" else None
        if number is not None and number < 0:  # counted back from the last one above
            number += len(found[kind]) + 1
        if number is not None and not 1 <= number <= totals[kind]:
            raise ValueError(f"a face has the corner {word[:40]!r}, which is not there")
        numbers.append(number or 0)
    return tuple(numbers)


def _stl(content: bytes) -> Mesh:
    """Return the mesh of an .stl; a binary one says how many triangles it has."""
    count = struct.unpack_from("<I", content, HEADER - 4)[0] if len(content) >= HEADER else -1
    if len(content) == HEADER + count * TRIANGLE:
        rows = [struct.unpack_from("<12f", content, HEADER + i * TRIANGLE) for i in range(count)]
    else:
        rows = list(_triangles(content))
    points = [_point(row[k : k + 3]) for row in rows for k in (3, 6, 9)]
    written = b"".join(struct.pack("<12fH", *row, 0) for row in rows)
    return Mesh(points, bytes(HEADER - 4) + struct.pack("<I", len(rows)) + written)


def _triangles(content: bytes) -> Iterator[tuple[float, ...]]:
    """Yield the triangles of an .stl that is text, each with a normal of zeros and three corners."""
    rows = (line.split() for line in content.decode("utf-8", "replace").split("\n"))
    corners = [_numbers(row[1:4], 3) for row in rows if row and row[0] == "vertex"]
    if len(corners) % 3:
        raise ValueError("a triangle has three corners")
    for k in range(0, len(corners), 3):
        yield (0.0, 0.0, 0.0, *corners[k], *corners[k + 1], *corners[k + 2])


def _numbers(words: Sequence[str], count: int) -> list[float]:
    """Return words as so many finite numbers.

    Raises:
        ValueError: they are not.
    """
    values = list(map(float, words))
    if len(values) != count or not all(map(math.isfinite, values)):
        raise ValueError(f"{' '.join(words)[:40]!r} is not {count} finite numbers")
    return values


def _point(values: Sequence[float]) -> Point:
    """Return three numbers as a point."""
    x, y, z = values
    return (x, y, z)
