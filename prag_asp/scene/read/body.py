"""Make the shape of a rigid body from its solids and mass properties."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from prag_asp.errors import SceneError
from prag_asp.scene.forms import FORMS
from prag_asp.scene.geometry import Pose, matrix
from prag_asp.scene.mass import MassProperties, combined, polyhedron_mass, primitive_mass, principal
from prag_asp.scene.read.cavities.flooding import cached_cavity
from prag_asp.scene.read.convex import convex_hull, is_closed, is_convex
from prag_asp.scene.read.decomposition import can_decompose
from prag_asp.scene.read.mesh import file_parts, mesh_points, state_of, thickness
from prag_asp.scene.read.scene_values import SMALLEST
from prag_asp.scene.read.stability import base_of, crown_of, falls, own_points, rotation, settle, surface_points
from prag_asp.scene.scene import BodyModel, Cavity, Look, Shape, Size, Solid

Floats = NDArray[np.float64]


def body_shape(
    kind: str, solids: Sequence[Solid], mass: MassProperties, settled: float = 0.0, looks: Iterable[Look] = ()
) -> Shape:
    """Make the shape of a body from solids; the centre of their bounding box becomes the origin of the body's frame.

    `settled` is the angle in radians by which the body tilted when it came to rest; `looks` are its visual parts.

    Raises:
        SceneError: a mesh cannot be read.
    """
    corners = [end for solid in solids for end in ends(solid)]
    low, high = (_size([end(corner[i] for corner in corners) for i in range(3)]) for end in (min, max))
    middle = _size([(a + b) / 2 for a, b in zip(low, high, strict=True)])
    centred = tuple(solid._replace(at=_minus(solid.at, middle)) for solid in solids)
    moments, axes = principal(mass.inertia)
    centre = _minus(_size(mass.centre.tolist()), middle)
    points = surface_points(centred)
    model = BodyModel(
        centred,
        mass.mass,
        centre,
        moments,
        quaternion_of(axes),
        base_of(points),
        crown_of(points),
        settled,
        _cavity(centred),
        tuple(look._replace(solid=look.solid._replace(at=_minus(look.solid.at, middle))) for look in looks),
    )
    return Shape(kind, _minus(high, low), model=model)


def _cavity(solids: Sequence[Solid]) -> Cavity | None:
    """Return the largest cavity of a body made of solids; a body without a mesh counts as convex."""
    if len(solids) == 1 and not solids[0].mesh:
        return None
    states = tuple(state_of(solid.mesh) for solid in solids if solid.mesh)
    return _cavity_of(tuple(solids), can_decompose(), states)


@lru_cache(maxsize=128)
def _cavity_of(solids: tuple[Solid, ...], decomposes: bool, states: tuple[tuple[int, int], ...]) -> Cavity | None:
    """Return the largest cavity of solids; `decomposes` and the states of the meshes are part of the cache key.

    A command reads a scene several times, but measures each cavity only once. A single convex part has no cavity.
    """
    parts = [part for solid in solids for part in _triangles(solid)]
    return None if len(parts) == 1 and is_convex(parts[0]) else cached_cavity(np.concatenate(parts))


def resting(shape: Shape) -> Shape | None:
    """Return the shape at rest of a body with a model: unchanged if it stands, or None if it does not come to rest.

    Raises:
        SceneError: a mesh cannot be read.
    """
    model = shape.model
    assert model is not None
    points, centre = surface_points(model.solids), np.array(model.centre)
    if not falls(points, centre):
        return shape
    rows = settle(points, centre)
    return None if rows is None else turned_shape(shape, rows, math.acos(max(-1.0, min(1.0, float(rows[2, 2])))))


def stable_rotations(points: Floats, centre: Floats) -> Iterator[tuple[float, Floats]]:
    """Yield each stable pose of a body: the height of the centre of mass in metres, and the rotation (3, 3).

    In each pose, the body rests on a face of the convex hull of `points` (n, 3) on its surface, and its centre of mass,
    `centre` (3,), is above this face.
    """
    hull = convex_hull(points)
    corners = np.unique(hull.reshape(-1, 3), axis=0)
    normals = np.cross(hull[:, 1] - hull[:, 0], hull[:, 2] - hull[:, 0])
    normals /= np.maximum(np.linalg.norm(normals, axis=1), 1e-300)[:, None]
    for normal in np.unique(np.round(normals, 6), axis=0):
        rows = _turned_down(normal / np.linalg.norm(normal))
        turned = corners @ rows.T
        if not falls(turned, rows @ centre):
            yield float((rows @ centre)[2] - turned[:, 2].min()), rows


def _turned_down(normal: Floats) -> Floats:
    """Return the smallest rotation (3, 3) that makes a unit vector point down."""
    down = np.array([0.0, 0.0, -1.0])
    axis, cosine = np.cross(normal, down), float(normal @ down)
    if cosine < -1.0 + 1e-9:
        return np.diag([1.0, -1.0, -1.0])
    skew = np.array([[0.0, -axis[2], axis[1]], [axis[2], 0.0, -axis[0]], [-axis[1], axis[0], 0.0]])
    rotated: Floats = np.eye(3) + skew + skew @ skew / (1.0 + cosine)
    return rotated


def turned_shape(shape: Shape, rows: Floats, settled: float = 0.0) -> Shape:
    """Return the shape of a body with a model after a rotation (3, 3); `settled` is its angle, if any, in radians."""
    model = shape.model
    assert model is not None
    solids = [_turned(solid, rows) for solid in model.solids]
    looks = [look._replace(solid=_turned(look.solid, rows)) for look in model.looks]
    axes = matrix(Pose((0.0, 0.0, 0.0), model.axes))[:3, :3]
    mass = MassProperties(model.mass, np.array(model.centre), axes @ np.diag(model.moments) @ axes.T)
    return body_shape(shape.kind, solids, mass.moved(rows, np.zeros(3)), settled, looks)


def _turned(solid: Solid, rows: Floats) -> Solid:
    """Return a solid after a rotation (3, 3) of its body."""
    x, y, z = (rows @ solid.at).tolist()
    return solid._replace(at=(x, y, z), turn=roll_pitch_yaw(rows @ np.array(rotation(solid.turn))))


def ends(solid: Solid) -> Iterator[Size]:
    """Yield points that have the same bounding box as a solid, in the frame of its body.

    Raises:
        SceneError: a mesh cannot be read, or is too thin.
    """
    rows = rotation(solid.turn)
    if solid.mesh:
        points = mesh_points(solid.mesh, solid.size)
        if thickness(points) < SMALLEST:
            raise SceneError(f"{solid.mesh}: the mesh is {too_thin(thickness(points))}")
        turned = [[sum(a * b for a, b in zip(row, point, strict=True)) for row in rows] for point in points]
    else:
        half = _size([side / 2 for side in solid.size])
        reach = [FORMS[solid.kind].reach(half, row) for row in rows]
        turned = [reach, [-side for side in reach]]
    for point in turned:
        yield _size([a + b for a, b in zip(point, solid.at, strict=True)])


def too_thin(thickness: float) -> str:
    """Return the message about a solid that is too thin, with the remedy."""
    return f"{thickness:.3g} m thin; make it at least {SMALLEST:g} m thick"


def solid_mass(solids: Iterable[Solid]) -> MassProperties:
    """Return the mass properties of solids with density 1, in the frame of their body.

    A closed part of a mesh is treated as the solid that it bounds, and any other part as its convex hull.

    Raises:
        SceneError: a mesh cannot be read.
    """
    masses = []
    for solid in solids:
        parts = [_part_mass(part) for part in _parts(solid)] if solid.mesh else [primitive_mass(solid)]
        masses += [part.moved(np.array(rotation(solid.turn)), np.array(solid.at)) for part in parts]
    return combined(masses)


def _triangles(solid: Solid) -> Iterator[Floats]:
    """Yield the collision triangles of each part of a solid in the frame of its body."""
    parts = _parts(solid) if solid.mesh else [convex_hull(np.array(list(own_points(solid))))]
    for part in parts:
        collides = part if not solid.mesh or can_decompose() or is_convex(part) else convex_hull(part.reshape(-1, 3))
        yield collides @ np.array(rotation(solid.turn)).T + solid.at


def _parts(solid: Solid) -> Iterator[Floats]:
    """Yield the triangles of each part of a mesh."""
    for part in file_parts(solid.mesh, solid.size):
        yield np.array(part, dtype=float)


def _part_mass(triangles: Floats) -> MassProperties:
    """Return the mass properties of a mesh part with density 1."""
    if is_closed(triangles):
        found = polyhedron_mass(triangles)
        if found.mass < 0.0:
            found = polyhedron_mass(triangles[:, ::-1])
        if found.mass > 0.0:
            return found
    return polyhedron_mass(convex_hull(triangles.reshape(-1, 3)))


def quaternion_of(rows: Floats) -> tuple[float, float, float, float]:
    """Return the unit quaternion (x, y, z, w) of a rotation matrix (3, 3), using Bar-Itzhack's eigenvector method."""
    (a, b, c), (d, e, f), (g, h, i) = rows.tolist()
    matrix = np.array(
        [
            [a - e - i, b + d, c + g, h - f],
            [b + d, e - a - i, f + h, c - g],
            [c + g, f + h, i - a - e, d - b],
            [h - f, c - g, d - b, a + e + i],
        ]
    )
    x, y, z, w = np.linalg.eigh(matrix)[1][:, -1].tolist()
    sign = -1.0 if w < 0.0 else 1.0
    return (sign * x, sign * y, sign * z, sign * w)


def roll_pitch_yaw(rows: Floats) -> Size:
    """Return the roll, pitch and yaw of a rotation matrix (3, 3) about the fixed axes, in radians."""
    pitch = math.asin(max(-1.0, min(1.0, -float(rows[2, 0]))))
    if abs(rows[2, 0]) > 1.0 - 1e-12:  # roll and yaw have the same axis, so the whole rotation counts as roll
        return (math.atan2(-float(rows[0, 1]) * math.copysign(1.0, float(rows[2, 0])), float(rows[1, 1])), pitch, 0.0)
    return (math.atan2(rows[2, 1], rows[2, 2]), pitch, math.atan2(rows[1, 0], rows[0, 0]))


def _minus(one: Size, two: Size) -> Size:
    """Return the difference of two vectors."""
    return (one[0] - two[0], one[1] - two[1], one[2] - two[2])


def _size(values: Sequence[float]) -> Size:
    """Return three numbers as a tuple."""
    return (values[0], values[1], values[2])
