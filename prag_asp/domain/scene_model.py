"""What physics knows of a domain: the bodies, where they stand, what the fluents mean.

Lengths are metres, angles radians. The world's origin is the base of the robot on the table top: x points away
from the robot, y to the robot's left, z up.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import NamedTuple

from prag_asp.domain.atom import Atom
from prag_asp.errors import SceneError

PREDICATE_ROLES: Mapping[str, tuple[str, ...]] = {
    "on_top": ("object", "object"),
    "inside": ("object", "object"),
    "left_of": ("object", "object"),
    "right_of": ("object", "object"),
    "in_front_of": ("object", "object"),
    "behind": ("object", "object"),
    "reachable": ("robot", "object"),
    "holding": ("robot", "object"),
    "at": ("robot", "object"),
    "gripper_open": ("robot",),
    "located": ("object", "object"),
    "rotated": ("object", "rotation"),
    "is_open": ("furniture",),
    "is_closed": ("furniture",),
}
"""The spatial predicates and what each of their arguments has to be."""

IGNORED = "none"
"""What ``scene.predicates`` maps a fluent to that means nothing to physics."""


FURNITURE = ("drawer", "cupboard")
"""The kinds of bodies that have a part on a joint."""

HOLLOW = ("container", *FURNITURE)
"""The kinds of bodies that things can be in."""

Size = tuple[float, float, float]
"""The sides of a bounding box in metres."""

SAME_SIZE = 1e-6


class Solid(NamedTuple):
    """A solid of a body from a URDF: box, cylinder, sphere or mesh, its middle relative to that of the body's box.

    `size` is the sides of a box, the diameter twice and the height of a cylinder, the diameter of a ball in metres, or
    the scale of a mesh; `turn` is roll, pitch and yaw in radians; `mesh` is a file.
    """

    kind: str
    size: Size
    at: Size
    turn: Size
    mesh: str = ""


class Model(NamedTuple):
    """What a URDF says of a body: what it collides with, and its mass in kilograms."""

    solids: tuple[Solid, ...]
    mass: float


class Shape(NamedTuple):
    """A body: its kind (of `SHAPE_KEYS`), the size of its bounding box and a container's wall in metres.

    One from a URDF has a `model`.
    """

    kind: str
    size: Size = (0.0, 0.0, 0.0)
    wall: float = 0.0
    model: Model | None = None

    @property
    def half(self) -> tuple[float, float, float]:
        """Half of each side of the bounding box, in metres."""
        return (self.size[0] / 2, self.size[1] / 2, self.size[2] / 2)


class Material(NamedTuple):
    """What a body is made of; the defaults are light wood, and filled packages of cardboard.

    `density` in kilograms a cubic metre; what touches has the product of both coefficients of `friction`; `rolling` is
    how far ahead of its centre a ball is supported when it rolls, in metres: fruit is not quite round.
    """

    density: float = 400.0
    friction: float = 0.7
    rolling: float = 0.002


STANDARD = Material()


@dataclass(frozen=True)
class Table:
    """The table: sides along x and y in metres, centre of its top (at z = 0), colour."""

    size: tuple[float, float] = (1.3, 1.6)
    centre: tuple[float, float] = (0.4, 0.0)
    color: str = "#c8a27a"


@dataclass(frozen=True)
class Scene:
    """Everything that physics knows of a domain.

    `shapes` and `colors` (``#rrggbb``) belong to entities, `workspace` is the part of the table top where
    objects are put (low x, high x, low y, high y), `fixed` holds x, y in metres and yaw in radians of what
    never moves, `predicates` maps fluent names to spatial predicates, `rotations` names to yaws in radians.
    `materials` belong to entities; `ranges` hold all shapes, the smallest first, of those whose size is drawn for each
    task, and `shapes` the largest of them.
    With `frame` "robot" left is the left of the robot (+y) and in front is nearer to it; "viewer" is someone
    who faces the robot.
    """

    shapes: Mapping[str, Shape]
    robot: str = "panda"
    frame: str = "robot"
    workspace: tuple[float, float, float, float] = (0.3, 0.7, -0.4, 0.4)
    table: Table = field(default_factory=Table)
    colors: Mapping[str, str] = field(default_factory=dict)
    fixed: Mapping[str, tuple[float, float, float]] = field(default_factory=dict)
    predicates: Mapping[str, str] = field(default_factory=dict)
    rotations: Mapping[str, float] = field(default_factory=dict)
    materials: Mapping[str, Material] = field(default_factory=dict)
    ranges: Mapping[str, tuple[Shape, ...]] = field(default_factory=dict)

    def meaning(self, fluent: Atom) -> str | None:
        """Return the name of the spatial predicate that `fluent` means, None where physics ignores it."""
        name = self.predicates.get(fluent.name, fluent.name)
        return name if name in PREDICATE_ROLES else None

    def material(self, entity: str) -> Material:
        """Return what an entity is made of."""
        return self.materials.get(entity, STANDARD)

    def smallest(self) -> Scene:
        """Return the scene with every body as small as it can be."""
        return self.with_shapes({entity: shapes[0] for entity, shapes in self.ranges.items()})

    def with_shapes(self, shapes: Mapping[str, Shape]) -> Scene:
        """Return the scene with the shapes that a task has drawn, those not drawn the largest."""
        return replace(self, shapes={**self.shapes, **shapes}, ranges={}) if self.ranges else self

    def with_sizes(self, sizes: Mapping[str, Size]) -> Scene:
        """Return the scene with the sizes that a task has drawn, in metres.

        Raises:
            SceneError: an entity cannot have its size.
        """
        return self.with_shapes({entity: self._shape(entity, size) for entity, size in sizes.items()})

    def _shape(self, entity: str, size: Size) -> Shape:
        """Return the shape of a size in the range of an entity."""
        for shape in self.ranges.get(entity, ()):
            if all(abs(side - asked) < SAME_SIZE for side, asked in zip(shape.size, size, strict=True)):
                return shape
        shown = " x ".join(f"{side:.4f}" for side in size)
        raise SceneError(f"{entity} cannot have the size {shown} m; the scene gives it another range")
