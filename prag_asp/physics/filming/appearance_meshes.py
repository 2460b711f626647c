"""Simplified visual meshes of the robots, because TinyRenderer's speed depends on the number of triangles.

The Panda's meshes have 102,000 triangles; an image of 128 x 128 pixels takes 21 ms. Vertex clustering (Rossignac and
Borrel, "Multi-resolution 3D approximations for rendering complex scenes", 1993) leaves 3,000 triangles with the same
appearance. Pictures intended for people use smaller cells.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from functools import cache
from itertools import pairwise
from pathlib import Path
from typing import NamedTuple
from xml.etree import ElementTree

import numpy as np
from numpy.typing import NDArray

from prag_asp.errors import SceneError
from prag_asp.physics.robot.robot_files import robot_file
from prag_asp.scene.robots import ROBOTS


class Fineness(NamedTuple):
    """The fineness with which robots and shadows are rendered.

    `cell` and `finest` are the largest and the smallest side of a cluster of vertices in metres, `cells` is the minimum
    number of clusters along a part, and `shadow_texels` is the width of the light's image in pixels.
    """

    name: str
    cell: float
    finest: float
    cells: int
    shadow_texels: int


COARSE = Fineness("coarse", 0.026, 0.006, 6, 144)
MIDDLE = Fineness("middle", 0.016, 0.005, 10, 256)
FINE = Fineness("fine", 0.011, 0.004, 16, 512)
"""The levels for the camera images of episodes, for animations, and for still pictures."""

SMALLEST = 0.012
"""The size in metres below which parts of a mesh are omitted, such as screws and lamps."""

DARK_BELOW, WHITE_ABOVE = 0.5, 0.9
DARK, WHITE = (0.25, 0.26, 0.28), (0.93, 0.94, 0.95)
"""The colours of the Panda, which are in a texture of its URDF."""

TEXTURE_AND_NORMAL = re.compile(r"/\S*")
"""The text that follows the number of a vertex in a face in an .obj file, such as ``/1/2``."""

Colour = tuple[float, float, float]


class Mesh(NamedTuple):
    """Vertices (V, 3) in metres and triangles (F, 3) of vertex indices."""

    corners: NDArray[np.float64]
    triangles: NDArray[np.int64]


@cache
def low_files(kind: str, fineness: Fineness = COARSE) -> Mapping[str, bytes]:
    """Return the files of a robot that has simplified meshes and no collision shapes: its URDF, then its meshes.

    The meshes are made once per process, which takes half a second.

    Raises:
        SceneError: the robot's files cannot be read.
    """
    root = ElementTree.fromstring(robot_file(ROBOTS[kind]))
    named: dict[str, Colour] = {}
    for material in root.iter("material"):
        color = material.find("color")  # None if the material only refers to a material that is defined elsewhere
        if color is not None:
            red, green, blue = map(float, color.get("rgba", "1 1 1 1").split()[:3])
            named[material.get("name", "")] = (red, green, blue)
    meshes: dict[str, bytes] = {}
    for number, link in enumerate(root.iter("link")):
        for collision in link.findall("collision"):
            link.remove(collision)
        for visual in link.findall("visual"):
            if visual.find("geometry/mesh") is not None:
                meshes |= _simplified(link, visual, f"{kind}_{fineness.name}_{number}", named, fineness)
    return {f"{kind}.urdf": ElementTree.tostring(root), **meshes}


def _simplified(
    link: ElementTree.Element,
    visual: ElementTree.Element,
    stem: str,
    named: Mapping[str, Colour],
    fineness: Fineness,
) -> dict[str, bytes]:
    """Replace the visual mesh of a link by simplified meshes, one for each colour, and return their files.

    File names begin with a stem that is unique to the robot and the fineness, because PyBullet caches meshes by path.
    `named` are the colours of the robot's materials.
    """
    mesh, origin = visual.find("geometry/mesh"), visual.find("origin")
    assert mesh is not None
    link.remove(visual)
    source = Path(mesh.get("filename", ""))
    material = visual.find("material")
    default = WHITE if material is None else named.get(material.get("name", ""), WHITE)
    files = {}
    for number, (colour, parts) in enumerate(_by_colour(source, default, fineness).items()):
        name = f"{stem}_{number}.obj"
        files[name] = ("\n".join(_lines(parts)) + "\n").encode("ascii")
        part = ElementTree.SubElement(link, "visual")
        if origin is not None:
            part.append(origin)
        ElementTree.SubElement(ElementTree.SubElement(part, "geometry"), "mesh", filename=name)
        paint = ElementTree.SubElement(part, "material", name=f"{stem}_{number}_of_few_corners")
        ElementTree.SubElement(paint, "color", rgba=" ".join(f"{each:g}" for each in (*colour, 1.0)))
    return files


def _by_colour(source: Path, default: Colour, fineness: Fineness) -> dict[Colour, list[Mesh]]:
    """Return the simplified parts of a mesh by colour.

    `default` is the colour in the URDF; if it is white, the materials of the mesh determine the colours.
    """
    try:
        parts = read_parts(source.read_text(encoding="utf-8", errors="replace"))
        library = source.with_suffix(".mtl")
        colours = _colours(library.read_text(encoding="utf-8", errors="replace")) if library.is_file() else {}
    except (OSError, ValueError) as error:
        raise SceneError(f"{source}: the robot cannot be read: {error}") from error
    meshes: dict[Colour, list[Mesh]] = {}
    for name, mesh in parts.items():
        longest = float(np.ptp(mesh.corners[mesh.triangles.ravel()], axis=0).max(initial=0.0))
        if longest >= SMALLEST:
            painted = DARK if max(colours.get(name, WHITE)) < DARK_BELOW else WHITE
            colour = painted if min(default) > WHITE_ABOVE else default
            cell = min(fineness.cell, max(longest / fineness.cells, fineness.finest))
            meshes.setdefault(colour, []).append(cluster_corners(mesh, cell))
    return meshes


def read_parts(text: str) -> dict[str, Mesh]:
    """Return the triangles in an .obj file by material; all of them share the vertices of the file.

    Raises:
        ValueError: the text is not in the format of .obj files.
    """
    corners: list[str] = []
    faces: dict[str, list[str]] = {}
    current = faces.setdefault("", [])
    for line in text.splitlines():
        if line.startswith("v "):
            corners.append(line[2:])
        elif line.startswith("f "):
            current.append(line[2:])
        elif line.startswith("usemtl"):
            current = faces.setdefault(line[6:].strip(), [])
    points = np.array(" ".join(corners).split(), dtype=float).reshape(-1, 3)
    return {name: Mesh(points, _triangles(lines)) for name, lines in faces.items() if lines}


def _triangles(lines: Sequence[str]) -> NDArray[np.int64]:
    """Return the triangles (F, 3) of the faces in an .obj file; each face is split as a fan around its first corner."""
    numbers = np.array(TEXTURE_AND_NORMAL.sub("", " ".join(lines)).split(), dtype=np.int64) - 1
    if len(numbers) == 3 * len(lines):
        return numbers.reshape(-1, 3)
    triangles = []
    begin = 0
    for line in lines:
        first, *others = numbers[begin : begin + len(line.split())].tolist()
        begin += 1 + len(others)
        triangles += [(first, one, two) for one, two in pairwise(others)]
    return np.array(triangles, dtype=np.int64).reshape(-1, 3)


def _colours(text: str) -> Mapping[str, Colour]:
    """Return the colours in a material library by name."""
    colours: dict[str, Colour] = {}
    name = ""
    for line in text.splitlines():
        word, _, rest = line.strip().partition(" ")
        if word == "newmtl":
            name = rest.strip()
        elif word == "Kd":
            red, green, blue = map(float, rest.split()[:3])
            colours[name] = (red, green, blue)
    return colours


def cluster_corners(mesh: Mesh, cell: float) -> Mesh:
    """Merge the vertices of a mesh that lie in the same grid cell into their mean; `cell` is a cell's side in metres.

    Degenerate and duplicate triangles are removed.
    """
    used, numbers = np.unique(mesh.triangles, return_inverse=True)
    points = mesh.corners[used]
    cells = np.floor((points - points.min(axis=0)) / cell).astype(np.int64)
    _, groups = np.unique(cells, axis=0, return_inverse=True)
    groups = groups.ravel()
    count = int(groups.max()) + 1
    sums = [np.bincount(groups, points[:, axis], count) for axis in range(3)]
    means = np.stack(sums, axis=1).astype(np.float64) / np.bincount(groups, minlength=count)[:, None]
    triangles = groups[numbers.reshape(mesh.triangles.shape)]
    one, two, three = triangles.T
    triangles = triangles[(one != two) & (two != three) & (three != one)]
    _, first = np.unique(np.sort(triangles, axis=1), axis=0, return_index=True)
    return Mesh(means, triangles[np.sort(first)])


def _lines(meshes: Sequence[Mesh]) -> Iterator[str]:
    """Yield the lines of an .obj file with several meshes; vertex normals are area-weighted means over triangles."""
    before = 1
    for corners, triangles in meshes:
        edges = corners[triangles]
        areas = np.cross(edges[:, 1] - edges[:, 0], edges[:, 2] - edges[:, 0])
        normals = np.zeros_like(corners)
        for side in range(3):
            np.add.at(normals, triangles[:, side], areas)
        normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-12)
        yield from (f"v {x:.5f} {y:.5f} {z:.5f}" for x, y, z in corners.tolist())
        yield from (f"vn {x:.4f} {y:.4f} {z:.4f}" for x, y, z in normals.tolist())
        for one, two, three in (triangles + before).tolist():
            yield f"f {one}//{one} {two}//{two} {three}//{three}"
        before += len(corners)
