"""The solids of bodies, and their masses."""

from __future__ import annotations

from collections.abc import Iterable

from prag_asp.scene.boxes import Vector
from prag_asp.scene.forms import FORMS
from prag_asp.scene.furniture import mechanism
from prag_asp.scene.scene import Scene, Shape, Solid


def boxes(places: Iterable[tuple[Vector, Vector]]) -> tuple[Solid, ...]:
    """Return boxes, each given by its centre and half its sides in metres."""
    return tuple(Solid("box", (2 * x, 2 * y, 2 * z), at) for at, (x, y, z) in places)


def solids(shape: Shape) -> tuple[Solid, ...]:
    """Return the solids of a body in its own frame, furniture closed."""
    if shape.model is not None:
        return shape.model.solids
    if shape.traits.furniture:
        parts = mechanism(shape)
        return (*boxes(parts.body), *boxes(parts.part))
    if shape.traits.hollow:
        return boxes(_container(shape))
    return (Solid(shape.kind, shape.size),)


def weight(scene: Scene, entity: str) -> float:
    """Return the mass of a body in kilograms: that of its URDF, or volume times density."""
    shape = scene.shapes[entity]
    return scene.material(entity).density * volume(solids(shape)) if shape.model is None else shape.model.mass


def walls(shape: Shape) -> tuple[Solid, ...]:
    """Return the walls of a container, down to the ground: its visible part without a floor."""
    x, y, z = shape.half
    thin, inner = shape.wall / 2, y - shape.wall
    return boxes(
        [
            ((0.0, y - thin, 0.0), (x, thin, z)),
            ((0.0, thin - y, 0.0), (x, thin, z)),
            ((x - thin, 0.0, 0.0), (thin, inner, z)),
            ((thin - x, 0.0, 0.0), (thin, inner, z)),
        ]
    )


def volume(made_of: Iterable[Solid]) -> float:
    """Return the volume of solids in cubic metres, none of them a mesh."""
    return sum(FORMS[solid.kind].volume((solid.size[0] / 2, solid.size[1] / 2, solid.size[2] / 2)) for solid in made_of)


def _container(shape: Shape) -> list[tuple[Vector, Vector]]:
    """Return centre and half sides of a container's floor and four walls, in its own frame."""
    x, y, z = shape.half
    thin = shape.wall / 2
    inner = y - shape.wall
    return [
        ((0.0, 0.0, thin - z), (x, y, thin)),
        ((0.0, y - thin, thin), (x, thin, z - thin)),
        ((0.0, thin - y, thin), (x, thin, z - thin)),
        ((x - thin, 0.0, thin), (thin, inner, z - thin)),
        ((thin - x, 0.0, thin), (thin, inner, z - thin)),
    ]
