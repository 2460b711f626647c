"""Read a shape of the kind ``mesh``: a body defined only by a mesh file."""

from __future__ import annotations

import math
from collections.abc import Mapping
from functools import lru_cache
from pathlib import Path

import numpy as np

from prag_asp.errors import SceneError
from prag_asp.scene.read.asset_paths import require_inside
from prag_asp.scene.read.body import body_shape, ends, roll_pitch_yaw, solid_mass, stable_rotations, turned_shape
from prag_asp.scene.read.decomposition import can_decompose
from prag_asp.scene.read.looks.surfaces import mesh_surfaces
from prag_asp.scene.read.mesh import is_concave, state_of
from prag_asp.scene.read.stability import rotation, surface_points
from prag_asp.scene.scene import Look, Shape, Solid
from prag_asp.tables.report import TableEntry, is_number

UPWARD: Mapping[str, tuple[float, float, float]] = {
    "z": (0.0, 0.0, 0.0),
    "-z": (180.0, 0.0, 0.0),
    "y": (90.0, 0.0, 0.0),
    "-y": (-90.0, 0.0, 0.0),
    "x": (0.0, -90.0, 0.0),
    "-x": (0.0, 90.0, 0.0),
}
"""The rotation about x, y and z, in degrees, that turns an axis of the file upwards."""

RESTS = ("upright", "lying", "any")
"""The resting pose of a body: as in its file, on its side, or the pose in which its centre of mass is lowest."""

SIDEWAYS = math.cos(math.radians(45.0))
"""The cosine of the smallest angle between the vertical and the file's upward axis for a body that lies on its side."""

SCALES = (1e-6, 1e6)
"""The smallest and the largest scale, which no model needs to exceed."""

MASSES, DENSITIES = (1e-4, 100.0), (1.0, 25000.0)
"""The smallest and the largest mass of a body in kilograms, and those of its density in kilograms per cubic metre."""


def read_mesh_body(entry: TableEntry, folder: Path) -> Shape | None:
    """Return the shape that a table of the kind ``mesh`` defines, and report problems in the table.

    If `mass` and `density` are missing, the model has a density of 1 kg/m³.

    Raises:
        SceneError: the file is missing, outside the folder, or not a valid mesh for a body.
    """
    path = folder / str(entry.value.get("path"))
    scale = entry.at("scale", 1.0)
    low, high = SCALES
    sides = (scale.value,) * 3 if is_number(scale.value) else scale.value
    if is_number(scale.value):
        scale.number(low, high, "a factor")
    else:
        sides = scale.numbers(3, "a positive factor, or one along each axis", low, high)
    usual = "y" if path.suffix.lower() in (".glb", ".gltf") else "z"
    up = entry.at("up", usual).choice(tuple(UPWARD))
    angles = entry.at("rotation", [0.0, 0.0, 0.0]).numbers(3, "degrees about x, y and z")
    mass = entry.at("mass").number(*MASSES, "kilograms") if "mass" in entry.value else None
    density = entry.at("density").number(*DENSITIES, "kilograms per cubic metre") if "density" in entry.value else 1.0
    if "mass" in entry.value and "density" in entry.value:
        entry.at("density").add("a body has a mass or a density; leave one of them out")
    rests = entry.at("rests", RESTS[0]).choice(RESTS)
    visual = folder / str(entry.value.get("visual", entry.value.get("path")))
    if not isinstance(entry.value.get("visual", ""), str):
        entry.at("visual").needs("the path of the mesh that is seen, in the folder of the domain")
    if not entry.is_sound or sides is None or up is None or angles is None or density is None:
        return None
    for each in (path, visual):
        require_inside(each, folder)
    x, y, z = map(float, sides)
    solid = Solid("mesh", (x, y, z), mesh=str(path))
    list(ends(solid))
    if not can_decompose() and is_concave(solid.mesh, solid.size):
        remedy = 'pip install "prag_asp[meshes]" to divide it, or give an .obj with a convex object for each part'
        raise SceneError(f"{path}: the mesh is not convex; {remedy}")
    first, second = (
        np.array(rotation((math.radians(x), math.radians(y), math.radians(z)))) for x, y, z in (UPWARD[up], angles)
    )
    look = Look(solid._replace(turn=roll_pitch_yaw(second @ first), mesh=str(visual)), str(folder))
    mesh_surfaces(look.solid.mesh, look.folder)
    rows = tuple(map(tuple, (second @ first).tolist()))
    return _body(solid, rows, mass, density, look, rests, can_decompose(), state_of(solid.mesh))


@lru_cache(maxsize=128)
def _body(
    solid: Solid,
    rows: tuple[tuple[float, ...], ...],
    mass: float | None,
    density: float,
    look: Look,
    rests: str | None,
    decomposes: bool,
    state: tuple[int, int],
) -> Shape:
    """Return the shape of a mesh after a rotation (3, 3); `decomposes` and the file's state are part of the cache key.

    Raises:
        SceneError: a mesh cannot be read, or the body does not rest as requested.
    """
    turn, uniform = np.array(rows), solid_mass([solid])
    properties = uniform.scaled(uniform.mass * density if mass is None else mass).moved(turn, np.zeros(3))
    shape = body_shape("mesh", [solid._replace(turn=look.solid.turn)], properties, looks=[look])
    return shape if rests == RESTS[0] else _lying(shape, anyhow=rests == "any")


def _lying(shape: Shape, anyhow: bool) -> Shape:
    """Return the shape of a body in its stable pose with the lowest centre of mass, on its side unless `anyhow` is set.

    Raises:
        SceneError: the body rests stably in no pose.
    """
    assert shape.model is not None
    poses = list(stable_rotations(surface_points(shape.model.solids), np.array(shape.model.centre)))
    sideways = [(height, rows) for height, rows in poses if anyhow or abs(rows[2, 2]) < SIDEWAYS]
    if not sideways:
        raise SceneError('the body does not rest like that; give another rests, such as "upright"')
    height = min(height for height, _ in sideways)
    # Among poses of equal height, the one nearest to that in the file is taken.
    return turned_shape(
        shape, max((rows for low, rows in sideways if low <= height + 1e-6), key=lambda rows: rows[2, 2])
    )
