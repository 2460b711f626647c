"""The solids of bodies, and their masses."""

from __future__ import annotations

from collections.abc import Iterable

from prag_asp.scene.boxes import Vector
from prag_asp.scene.forms import FORMS
from prag_asp.scene.furniture import mechanism
from prag_asp.scene.scene import Scene, Shape, Solid


def boxes(places: Iterable[tuple[Vector, Vector]]) -> tuple[Solid, ...]:
    """Return the boxes of a body, each given by its centre and its half-extents in metres."""
    return tuple(Solid("box", (2 * x, 2 * y, 2 * z), at) for at, (x, y, z) in places)


def solids(shape: Shape) -> tuple[Solid, ...]:
    """Return the solids of a body in its own frame, with furniture closed."""
    if shape.model is not None:
        return shape.model.solids
    if shape.traits.furniture:
        parts = mechanism(shape)
        return (*boxes(parts.body), *boxes(parts.part))
    if shape.traits.hollow:
        x, y, z = shape.half
        thin = shape.wall / 2
        return (*boxes([((0.0, 0.0, thin - z), (x, y, thin))]), *walls(shape, thin))
    return (Solid(shape.kind, shape.size),)


def weight(scene: Scene, entity: str) -> float:
    """Return the mass of a body in kilograms: that of its model, or its volume times its density."""
    shape = scene.shapes[entity]
    return scene.material(entity).density * volume(solids(shape)) if shape.model is None else shape.model.mass


def walls(shape: Shape, above: float = 0.0) -> tuple[Solid, ...]:
    """Return the walls of a container; they start 2 * `above` metres above its bottom, to leave room for a floor."""
    x, y, z = shape.half
    thin, inner, tall = shape.wall / 2, y - shape.wall, z - above
    return boxes(
        [
            ((0.0, y - thin, above), (x, thin, tall)),
            ((0.0, thin - y, above), (x, thin, tall)),
            ((x - thin, 0.0, above), (thin, inner, tall)),
            ((thin - x, 0.0, above), (thin, inner, tall)),
        ]
    )


def volume(made_of: Iterable[Solid]) -> float:
    """Return the volume of solids without meshes, in cubic metres."""
    return sum(FORMS[solid.kind].volume((solid.size[0] / 2, solid.size[1] / 2, solid.size[2] / 2)) for solid in made_of)
