"""The visible triangles of bodies and robots, as arrays: what PyBullet draws, without PyBullet."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from functools import cache
from pathlib import Path
from typing import NamedTuple
from xml.etree import ElementTree

import numpy as np
from numpy.typing import NDArray

from prag_asp.physics.filming.appearance_meshes import Fineness, low_files
from prag_asp.physics.world.primitives import visible_pieces
from prag_asp.physics.world.visible_pieces import Rgba, paint
from prag_asp.scene.read.looks.obj_surfaces import read_obj
from prag_asp.scene.read.looks.surfaces import look_surfaces
from prag_asp.scene.read.mesh import mesh_parts
from prag_asp.scene.read.stability import rotation
from prag_asp.scene.scene import Look, Solid
from prag_asp.scene.surfaces import Floats, solid_parts

CREASE = math.radians(40)
"""The largest angle between two faces that are shaded as one curved surface; sides of our cylinders differ by 11°."""

SAME_POINT = 6
"""The number of decimals, in metres, to which the corners of triangles are rounded to find those that coincide."""

CLOSE = Fineness("close", 0.006, 0.002, 30, 512)
"""The fineness of robots that users may look at from close by: 36,000 triangles of the Panda, 0.7 MB."""

WHITE = (1.0, 1.0, 1.0, 1.0)


class MeshPiece(NamedTuple):
    """Triangles of one material in the frame of a body: corners and unit normals (n, 3, 3), in metres.

    `rgba` has components from 0 to 1. `places` (n, 3, 2) are the texture coordinates of the corners, from the lower
    left at 0 to the upper right at 1, and `texture` is the content of an image file; without a texture they are None
    and empty.
    """

    corners: Floats
    normals: Floats
    rgba: Rgba
    places: Floats | None = None
    texture: bytes = b""

    def indexed(self) -> tuple[NDArray[np.float32], NDArray[np.int64]]:
        """Return the distinct corners as rows, and the triangles (n, 3) as indices of rows.

        A row has the corner, its normal, and its texture coordinates if the piece has a texture.
        """
        columns = [self.corners.reshape(-1, 3), self.normals.reshape(-1, 3)]
        if self.places is not None:
            columns.append(self.places.reshape(-1, 2))
        rows, indices = np.unique(np.hstack(columns).astype(np.float32), axis=0, return_inverse=True)
        return rows, indices.reshape(-1, 3)


def body_pieces(solids: Sequence[Solid], looks: Sequence[Look], color: str) -> list[MeshPiece]:
    """Return the visible pieces of a body: its looks, or else its solids.

    Raises:
        SceneError: a mesh cannot be read.
    """
    if looks:
        return [piece for look in looks for piece in _look_pieces(look, paint(color))]
    return [_solid_piece(piece.solid, piece.rgba) for piece in visible_pieces(solids, (), color)]


def _solid_piece(solid: Solid, rgba: Rgba) -> MeshPiece:
    """Return a solid in one colour."""
    if solid.mesh:
        parts = [np.array(part, dtype=float).reshape(-1, 3, 3) for part in mesh_parts(solid.mesh, solid.size)]
        corners = np.concatenate(parts) @ np.array(rotation(solid.turn)).T + solid.at
    else:
        corners = np.concatenate(solid_parts(solid))
    return MeshPiece(corners, creased_normals(corners), rgba)


def _look_pieces(look: Look, tint: Rgba) -> Iterable[MeshPiece]:
    """Yield the pieces of a look, with their colours multiplied by another colour.

    Raises:
        SceneError: a mesh cannot be read.
    """
    solid = look.solid
    if not solid.mesh:
        yield _solid_piece(solid, _product(look.color, tint))
        return
    rows = np.array(rotation(solid.turn))
    for surface in look_surfaces(look):
        corners = (surface.corners * solid.size) @ rows.T + solid.at
        normals = (
            creased_normals(corners) if surface.normals is None else _unit((surface.normals / solid.size) @ rows.T)
        )
        if surface.texture and surface.places is not None:
            yield MeshPiece(corners, normals, tint, surface.places, surface.texture)
        else:
            yield MeshPiece(corners, normals, _product(surface.color, tint))


def _product(color: str, tint: Rgba) -> Rgba:
    """Return the product of two colours; an empty colour counts as white."""
    return tuple(a * b for a, b in zip(paint(color), tint, strict=True)) if color else tint


@cache
def robot_pieces(kind: str, fineness: Fineness = CLOSE) -> Mapping[str, tuple[MeshPiece, ...]]:
    """Return the visible pieces of each link of a robot, by the name of the link, in the frame of the link.

    Raises:
        SceneError: the robot's files cannot be read.
    """
    files = low_files(kind, fineness)
    root = ElementTree.fromstring(next(iter(files.values())))
    return {
        link.get("name", ""): tuple(piece for visual in link.findall("visual") for piece in _link_pieces(visual, files))
        for link in root.iter("link")
    }


def _link_pieces(visual: ElementTree.Element, files: Mapping[str, bytes]) -> Iterable[MeshPiece]:
    """Yield the pieces of a visual element of a URDF, whose meshes are among the files."""
    origin, color = visual.find("origin"), visual.find("material/color")
    at, turn = (_three(origin, name) for name in ("xyz", "rpy"))
    rgba = WHITE if color is None else tuple(map(float, color.get("rgba", "1 1 1 1").split()))
    mesh, box = visual.find("geometry/mesh"), visual.find("geometry/box")
    if box is not None:
        yield _solid_piece(Solid("box", _three(box, "size"), at, turn), rgba)
    elif mesh is not None:
        name, rows = mesh.get("filename", ""), np.array(rotation(turn))
        for surface in read_obj(files[name], Path(name), Path()):
            corners = surface.corners @ rows.T + at
            yield MeshPiece(corners, creased_normals(corners), rgba)


def _three(element: ElementTree.Element | None, name: str) -> tuple[float, float, float]:
    """Return three numbers in an attribute of an element, zeros if there is none."""
    x, y, z = map(float, ("0 0 0" if element is None else element.get(name, "0 0 0")).split())
    return x, y, z


def creased_normals(triangles: Floats) -> Floats:
    """Return unit normals (n, 3, 3) at the corners of triangles (n, 3, 3).

    A normal is the mean over those faces at the corner whose angle to the corner's own face is at most `CREASE`, so
    curved surfaces are smooth and edges sharp. A face weighs as much as its angle at the corner (Thürmer and Wüthrich,
    "Computing vertex normals from polygonal facets", 1998), so it does not matter how quadrilaterals are divided.
    """
    facing = _unit(np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0]))
    ahead = _unit(np.roll(triangles, -1, axis=1) - triangles)
    angles = np.arccos(np.clip(-np.einsum("nij,nij->ni", ahead, np.roll(ahead, 1, axis=1)), -1.0, 1.0))
    weighted = (angles[..., None] * facing[:, None]).reshape(-1, 3)
    _, points = np.unique(triangles.reshape(-1, 3).round(SAME_POINT), axis=0, return_inverse=True)
    order = np.argsort(points.ravel(), kind="stable")
    counts = np.bincount(points.ravel())
    begins, sizes = np.repeat(np.cumsum(counts) - counts, counts), np.repeat(counts, counts)
    # All pairs of corners at the same point: each corner in sorted order with each of its group.
    one = np.repeat(np.arange(len(order)), sizes)
    within = np.arange(len(one)) - np.repeat(np.cumsum(sizes) - sizes, sizes)
    own, other = order[one], order[begins[one] + within]
    near = np.einsum("ij,ij->i", facing[own // 3], facing[other // 3]) > math.cos(CREASE)
    sums = np.zeros((len(order), 3))
    np.add.at(sums, own[near], weighted[other[near]])
    return _unit(sums.reshape(-1, 3, 3))


def _unit(vectors: Floats) -> Floats:
    """Return vectors scaled to length 1; zero vectors point upwards."""
    lengths: NDArray[np.float64] = np.linalg.norm(vectors, axis=-1, keepdims=True)
    upwards = np.broadcast_to((0.0, 0.0, 1.0), vectors.shape)
    result: Floats = np.where(lengths > 1e-15, vectors / np.maximum(lengths, 1e-15), upwards)
    return result
