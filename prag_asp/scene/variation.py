"""Domain randomization: the properties that vary between episodes.

Each kind is sampled independently of the others.
"""

from __future__ import annotations

import json
import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import msgspec
import numpy as np

from prag_asp.errors import QueryError
from prag_asp.scene.boxes import Vector
from prag_asp.scene.colours import from_lab, to_lab
from prag_asp.scene.scene import Scene
from prag_asp.scene.solids import weight
from prag_asp.tables.json_fields import Number, decoded, read

KINDS = ("friction", "mass", "light", "camera", "colour")
"""The kinds of variation."""

USUAL_LIGHT: Vector = (-0.3, 0.8, 1.8)
"""The direction to the light if it does not vary."""


@dataclass(frozen=True)
class Variation:
    """The variation in an episode; missing properties are as in the scene.

    `friction` holds the coefficients of entities, `mass` their masses in kilograms, `light` the direction to the light,
    `cameras` the positions of cameras and of their targets in metres, and `colours` the colours of entities as
    ``#rrggbb``.
    """

    friction: Mapping[str, float] = field(default_factory=dict)
    mass: Mapping[str, float] = field(default_factory=dict)
    light: Vector | None = None
    cameras: Mapping[str, tuple[Vector, Vector]] = field(default_factory=dict)
    colours: Mapping[str, str] = field(default_factory=dict)

    def applied(self, scene: Scene) -> Scene:
        """Return a scene with this variation; entities and cameras that the scene does not have are ignored."""
        materials, shapes = dict(scene.materials), dict(scene.shapes)
        for entity, coefficient in self.friction.items():
            materials[entity] = scene.material(entity)._replace(friction=coefficient)
        for entity, kilograms in self.mass.items():
            shape = shapes.get(entity)
            if shape is not None and shape.model is not None:
                shapes[entity] = shape._replace(model=shape.model.with_mass(kilograms))
            elif shape is not None:
                material = materials.get(entity, scene.material(entity))
                density = material.density * kilograms / weight(scene, entity)
                materials[entity] = material._replace(density=density)
        cameras = dict(scene.cameras)
        for name in self.cameras.keys() & cameras.keys():
            at, look_at = self.cameras[name]
            cameras[name] = cameras[name]._replace(at=at, look_at=look_at)
        colors, table = {**scene.colors, **self.colours}, scene.table
        if (entity := table_of(scene)) in self.colours:
            table = replace(table, color=self.colours[entity])
        return replace(scene, materials=materials, shapes=shapes, cameras=cameras, colors=colors, table=table)

    def to_text(self) -> str:
        """Return the variation as JSON, without the properties that do not vary."""
        data: dict[str, Any] = {
            "friction": dict(self.friction),
            "mass": dict(self.mass),
            "light": self.light,
            "cameras": {name: {"at": at, "look_at": look_at} for name, (at, look_at) in self.cameras.items()},
            "colours": dict(self.colours),
        }
        return json.dumps({name: value for name, value in data.items() if value})


class _CameraJson(msgspec.Struct):
    """A camera in a file."""

    at: tuple[Number, Number, Number]
    look_at: tuple[Number, Number, Number]


class _VariationJson(msgspec.Struct):
    """A variation in a file."""

    friction: dict[str, Number] = {}
    mass: dict[str, Number] = {}
    light: tuple[Number, Number, Number] | None = None
    cameras: dict[str, _CameraJson] = {}
    colours: dict[str, str] = {}


def variation_of(text: str) -> Variation:
    """Return the variation that `Variation.to_text` wrote.

    Raises:
        QueryError: the text has a wrong form; the message gives the path of the field.
    """
    form = read(decoded(text), _VariationJson, "varied")
    for name, values in (("friction", form.friction), ("mass", form.mass)):
        for entity, value in values.items():
            if value < 0.0 or (name == "mass" and value == 0.0):
                raise QueryError(f"varied.{name}.{entity}: needs a positive number; got {value!r}")
    for entity, color in form.colours.items():
        if len(color) != 7 or color[0] != "#" or not set(color[1:]) <= set("0123456789abcdef"):
            raise QueryError(f'varied.colours.{entity}: needs a colour like "#e4572e"; got {color!r}')
    for name, camera in form.cameras.items():
        if math.dist(camera.at, camera.look_at) == 0.0:
            raise QueryError(f"varied.cameras.{name}: its target equals its position")
    if form.light is not None and not any(form.light):
        raise QueryError("varied.light: has no direction")
    cameras = {name: (camera.at, camera.look_at) for name, camera in form.cameras.items()}
    return Variation(form.friction, form.mass, form.light, cameras, form.colours)


def draw_variation(scene: Scene, kinds: Iterable[str], objects: Sequence[str], seed: Sequence[int]) -> Variation:
    """Return a random variation of some `KINDS` for the objects of a task, within the ranges of the scene.

    Friction and colour also vary for the table, whereas mass varies only for movable objects. Cameras and their targets
    are moved within balls, and colours within balls in CIELAB. Entities are sampled in the order of their names.
    """
    rngs = {kind: np.random.default_rng([*seed, KINDS.index(kind)]) for kind in kinds}
    ranges, table = scene.vary, table_of(scene)
    friction, mass, cameras, colours = {}, {}, {}, {}
    if rng := rngs.get("friction"):
        for entity in (*sorted(objects), *([table] if table in scene.shapes else [])):
            friction[entity] = scene.material(entity).friction * float(rng.uniform(*ranges.friction))
    if rng := rngs.get("mass"):
        for entity in sorted(objects):
            if entity not in scene.fixed and not scene.shapes[entity].traits.furniture:
                mass[entity] = weight(scene, entity) * float(rng.uniform(*ranges.mass))
    if rng := rngs.get("camera"):
        for name in sorted(scene.cameras):
            camera = scene.cameras[name]
            most = ranges.camera * math.dist(camera.at, camera.look_at)
            cameras[name] = (_moved(rng, camera.at, most), _moved(rng, camera.look_at, most))
    if rng := rngs.get("colour"):
        colors = {entity: scene.colors[entity] for entity in sorted(objects) if entity in scene.colors}
        for entity, color in {**colors, table: scene.table.color}.items():
            lightness, a, b = to_lab(color).tolist()
            colours[entity] = from_lab(np.array(_moved(rng, (lightness, a, b), ranges.colour)))
    light = _light(rngs["light"], ranges.light) if "light" in rngs else None
    return Variation(friction, mass, light, cameras, colours)


def table_of(scene: Scene) -> str:
    """Return the entity that is the table, or ``table`` if there is none."""
    return next((entity for entity, shape in scene.shapes.items() if shape.kind == "table"), "table")


def _light(rng: np.random.Generator, degrees: float) -> Vector:
    """Return a direction to the light, sampled uniformly within a number of degrees of the default direction."""
    usual = np.array(USUAL_LIGHT) / np.linalg.norm(USUAL_LIGHT)
    aside = np.cross(usual, (1.0, 0.0, 0.0))
    aside /= np.linalg.norm(aside)
    cosine = float(rng.uniform(math.cos(math.radians(degrees)), 1.0))
    turn = float(rng.uniform(0.0, 2 * math.pi))
    around = math.cos(turn) * aside + math.sin(turn) * np.cross(usual, aside)
    x, y, z = (cosine * usual + math.sqrt(1 - cosine**2) * around).tolist()
    return (x, y, z)


def _moved(rng: np.random.Generator, point: Vector, most: float) -> Vector:
    """Return a point moved to a uniformly random point within a ball of radius `most`."""
    way = rng.normal(size=3)
    way *= most * float(rng.uniform()) ** (1 / 3) / np.linalg.norm(way)
    x, y, z = (np.array(point) + way).tolist()
    return (x, y, z)
