"""How much material a body is made of."""

from __future__ import annotations

import math

from prag_asp.domain.scene import FURNITURE, Scene, Shape
from prag_asp.physics.geometry import Vector
from prag_asp.physics.mechanism import mechanism


def container_boxes(shape: Shape) -> list[tuple[Vector, Vector]]:
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


def weight(scene: Scene, entity: str) -> float:
    """Return what a body weighs in kilograms: what its URDF says, or by its volume and its density."""
    shape = scene.shapes[entity]
    return scene.material(entity).density * volume(shape) if shape.model is None else shape.model.mass


def volume(shape: Shape) -> float:
    """Return the volume of a body's material in cubic metres, of one from a URDF that of its box."""
    x, y, z = shape.size
    if shape.kind == "sphere":
        return math.pi * x**3 / 6
    if shape.kind == "cylinder":
        return math.pi * x * x / 4 * z
    if shape.kind == "container":
        return sum(8 * half[0] * half[1] * half[2] for _, half in container_boxes(shape))
    if shape.kind in FURNITURE:
        made = mechanism(shape)
        return sum(8 * half[0] * half[1] * half[2] for _, half in (*made.body, *made.part))
    return x * y * z
