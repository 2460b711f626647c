"""Read the triangles of a mesh, and divide it into convex parts.

Wavefront .obj files and text or binary .stl files are read here, and other formats by trimesh.

The size of a mesh is exactly that of its faces, without a margin: points that no face uses do not count. Simulators get
the triangles that this module reads, not the file, so that they simulate the same body that is measured here.
"""

from __future__ import annotations

import math
import os
import struct
from collections.abc import Iterable, Iterator, Mapping, Sequence
from functools import lru_cache
from io import BytesIO
from itertools import chain, pairwise
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from prag_asp.errors import LimitReached, SceneError
from prag_asp.safe_reading import read_bytes

LARGEST = 32_000_000
"""The largest size in bytes of a mesh file, or of a file that it refers to, such as a buffer of a .gltf."""

FLATTEST = 0.0005
"""The smallest thickness of a mesh part in metres; simulators do not collide with the hull of a flatter part."""

MOST_SOLIDS = 64
"""The maximum number of solids into which a part is divided; each solid is at least one part for collisions."""

HEADER, TRIANGLE = 84, 50
"""The sizes in bytes of the header of a binary .stl, and of each triangle."""

SUFFIXES = (".obj", ".stl", ".ply", ".glb", ".gltf", ".dae", ".off")
"""The file suffixes of meshes."""

CORNERS = 3
GROUPS = ("o", "g")
"""The words that begin a part in an .obj file: an object or a group."""

Point = tuple[float, float, float]
Triangle = tuple[Point, Point, Point]
MeshPart = tuple[Triangle, ...]


def mesh_parts(path: str, scale: Point = (1.0, 1.0, 1.0)) -> tuple[MeshPart, ...]:
    """Return the triangles of the convex parts of a mesh, multiplied by a scale along each axis.

    A convex part of the file is kept as it is. A concave part is divided into its separate solids, and solids that are
    concave are decomposed if CoACD is installed. For collision checks, each part is replaced by its convex hull.

    Raises:
        SceneError: as for `file_parts`.
    """
    return _convex_parts(path, scale, state_of(path))


@lru_cache(maxsize=64)
def _convex_parts(path: str, scale: Point, _state: tuple[int, int]) -> tuple[MeshPart, ...]:
    """Return the convex parts of a mesh; the state of the file is part of the cache key."""
    from prag_asp.scene.read.decomposition import can_decompose, decomposed  # noqa: PLC0415 - few domains have meshes

    parts: list[MeshPart] = []
    for part, concave in chain.from_iterable(map(_solids, file_parts(path, scale))):
        if concave and can_decompose():
            try:
                found = decomposed(np.array(part, dtype=float))
            except LimitReached as error:
                remedy = "simplify it, or make it of convex objects or groups of an .obj"
                why = f"it was stopped by {error.reason.prose()}"
                raise SceneError(
                    f"{path}: dividing the mesh into convex parts is too costly: {why}; {remedy}"
                ) from error
            parts += (tuple((_point(a), _point(b), _point(c)) for a, b, c in each.tolist()) for each in found)
        else:
            parts.append(part)
    return tuple(parts)


def is_concave(path: str, scale: Point = (1.0, 1.0, 1.0)) -> bool:
    """Return whether a part of a mesh file is not convex.

    Raises:
        SceneError: as for `file_parts`.
    """
    return any(concave for part in file_parts(path, scale) for _, concave in _solids(part))


def _solids(part: MeshPart) -> list[tuple[MeshPart, bool]]:
    """Return the separate solids of a concave part, or the part itself, and whether each of them is concave."""
    from prag_asp.scene.read.convex import separate_solids  # noqa: PLC0415 - few domains have meshes

    if not _concave(part):
        return [(part, False)]
    solids = separate_solids(np.array(part, dtype=float))
    if not 1 < len(solids) <= MOST_SOLIDS:
        return [(part, True)]
    divided = tuple(tuple((_point(a), _point(b), _point(c)) for a, b, c in solid.tolist()) for solid in solids)
    if min(thickness(_corners(solid)) for solid in divided) < FLATTEST:
        return [(part, True)]
    return [(solid, _concave(solid)) for solid in divided]


def _concave(part: MeshPart) -> bool:
    """Return whether a part is concave; a part that is too thin for a hull is not."""
    from prag_asp.scene.read.convex import is_convex  # noqa: PLC0415 - few domains have meshes

    return thickness(_corners(part)) >= FLATTEST and not is_convex(np.array(part, dtype=float))


def file_parts(path: str, scale: Point = (1.0, 1.0, 1.0)) -> tuple[MeshPart, ...]:
    """Return the triangles of each part of a mesh in its file, multiplied by a scale along each axis.

    The parts of an .obj file are its objects and groups, and those of a .glb, .gltf or .dae file are its nodes. If a
    part is thinner than `FLATTEST` metres, the mesh has only one part.

    Raises:
        SceneError: the file cannot be read, has an unknown format, no faces, or a point that is not finite.
    """
    scaled = tuple(
        tuple((_scaled(one, scale), _scaled(two, scale), _scaled(three, scale)) for one, two, three in part)
        for part in _parts(path)
    )
    if len(scaled) > 1 and min(thickness(_corners(part)) for part in scaled) < FLATTEST:
        return (tuple(chain.from_iterable(scaled)),)
    return scaled


def mesh_points(path: str, scale: Point = (1.0, 1.0, 1.0)) -> list[Point]:
    """Return the distinct corners of a mesh's faces, multiplied by a scale along each axis.

    Raises:
        SceneError: as for `file_parts`.
    """
    return [_scaled(point, scale) for point in _corners(chain.from_iterable(_parts(path)))]


def thickness(points: Sequence[Point]) -> float:
    """Return the extent of points in metres along the direction of their smallest variance."""
    centred = np.array(points) - np.mean(points, axis=0)
    least = np.linalg.eigh(centred.T @ centred)[1][:, 0]
    return float(np.ptp(centred @ least))


def _corners(triangles: Iterable[Triangle]) -> list[Point]:
    """Return the distinct corners of triangles."""
    return list(dict.fromkeys(chain.from_iterable(triangles)))


def _scaled(point: Point, scale: Point) -> Point:
    return (point[0] * scale[0], point[1] * scale[1], point[2] * scale[2])


def _parts(path: str) -> tuple[MeshPart, ...]:
    """Return the parts of a mesh in the unit of its file, which is read again only after a change."""
    if Path(path).suffix.lower() not in SUFFIXES:
        raise SceneError(f"{path}: a mesh of unknown format; known are {', '.join(SUFFIXES)}")
    return _read(path, *state_of(path))


def state_of(path: str) -> tuple[int, int]:
    """Return a file's modification time in nanoseconds and its size in bytes, which identify its contents.

    Raises:
        SceneError: the file cannot be read.
    """
    try:
        about = os.stat(path)  # noqa: PTH116 - pathlib takes several times as long, and caches call this often
    except OSError as error:
        raise SceneError(f"{path}: cannot be read: {error.strerror}") from error
    return about.st_mtime_ns, about.st_size


@lru_cache(maxsize=32)
def _read(path: str, modified: int, size: int) -> tuple[MeshPart, ...]:
    """Return the parts of a mesh in the unit of its file; the state of the file is part of the cache key."""
    try:
        content = read_bytes(path, at_most=LARGEST)
        if not content:
            raise ValueError("the file is empty")
        parts = _triangles(path, content)
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


def _triangles(path: str, content: bytes) -> list[list[Triangle]]:
    """Return the triangles of each part of a file; the format of the file determines the reader."""
    match Path(path).suffix.lower():
        case ".obj":
            return _obj(content)
        case ".stl":
            return [_stl(content)]

    return [[(_point(a), _point(b), _point(c)) for a, b, c in part.tolist()] for part in read_by_trimesh(path, content)]


def _obj(content: bytes) -> list[list[Triangle]]:
    """Return the triangles of each object and group in an .obj file; a face with more corners becomes a fan."""
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
                corners = []
                for word in words:  # such as 3/1/2: the index of the point, forwards from 1 or backwards from -1
                    index = int(word.partition("/")[0])
                    if index == 0 or not -len(points) <= index <= len(points):
                        raise ValueError(f"a face with the corner {index} of {len(points)} points in line {number}")
                    corners.append(points[index - 1 if index > 0 else index])
                parts[-1] += [(corners[0], one, two) for one, two in pairwise(corners[1:])]
            case [group, *_] if group in GROUPS:
                parts.append([])
    return parts


def _stl(content: bytes) -> list[Triangle]:
    """Return the triangles in an .stl file; the file is binary if its length matches the count in its header."""
    count = struct.unpack_from("<I", content, HEADER - 4)[0] if len(content) >= HEADER else -1
    if len(content) == HEADER + count * TRIANGLE:
        rows = (struct.unpack_from("<12f", content, HEADER + i * TRIANGLE) for i in range(count))
        return [(row[3:6], row[6:9], row[9:12]) for row in rows]
    words = (line.split() for line in content.decode("utf-8", "replace").splitlines())
    points = [_point(row[1:4]) for row in words if row and row[0] == "vertex"]
    if len(points) % CORNERS:
        raise ValueError(f"{len(points)} corners, which make no triangles")
    return list(zip(points[::3], points[1::3], points[2::3], strict=True))


def _point(words: Sequence[str] | Sequence[float]) -> Point:
    """Convert three words or numbers to a point."""
    x, y, z = map(float, words)
    return (x, y, z)


class FilesBeside(Mapping[str, bytes]):
    """The files in the folder of a mesh, by name; each is read when it is looked up."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder

    def __getitem__(self, name: str) -> bytes:
        try:
            return read_bytes(self._folder / name, within=self._folder, at_most=LARGEST)
        except OSError as error:
            raise KeyError(name) from error

    def __iter__(self) -> Iterator[str]:
        return iter(())

    def __len__(self) -> int:
        return 0


def read_by_trimesh(path: str, content: bytes) -> list[NDArray[np.float64]]:
    """Return the triangles (n, 3, 3) of each part of a mesh file, in the unit of the file.

    Raises:
        SceneError: trimesh is not installed.
        ValueError: the file is not a mesh.
    """
    return [np.asarray(mesh.triangles, dtype=float) for mesh in trimesh_parts(path, content)]


def trimesh_parts(path: str, content: bytes) -> list[Any]:
    """Return the parts of a mesh file as meshes of trimesh, in the unit of the file.

    Raises:
        SceneError: trimesh is not installed.
        ValueError: the file is not a mesh.
    """
    try:
        import trimesh  # noqa: PLC0415 - an extra
    except ImportError:
        remedy = 'install it: pip install "prag_asp[meshes]", or give an .obj or an .stl'
        raise SceneError(f"{path}: meshes of this format need trimesh; {remedy}") from None
    kind = Path(path).suffix.lower().removeprefix(".")
    try:
        scene = trimesh.load_scene(BytesIO(content), file_type=kind, resolver=FilesBeside(Path(path).parent))
        return [each for each in scene.dump() if isinstance(each, trimesh.Trimesh)]
    except Exception as error:  # its readers raise arbitrary errors for broken files
        raise ValueError(" ".join(str(error).split())[:200] or type(error).__name__) from error
