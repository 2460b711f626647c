"""The scene of a domain: its bodies, where they stand, and the meaning of its fluents.

Lengths are metres, angles radians. The world's origin is the base of the robot on the table top: x points away
from the robot, y to the robot's left, z up.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import NamedTuple

from prag_asp.atom import Atom
from prag_asp.errors import SceneError
from prag_asp.scene.cameras import Camera, usual_cameras
from prag_asp.scene.predicate_names import PREDICATE_ROLES
from prag_asp.scene.shape_kinds import KINDS, Kind

IGNORED = "none"
"""The value in ``scene.predicates`` of a fluent that physics ignores."""

Size = tuple[float, float, float]
"""The sides of a bounding box in metres."""

SAME_SIZE = 1e-6
"""The largest difference between equal sides, in metres: files have rounded decimals."""


class Solid(NamedTuple):
    """A solid of a body: box, cylinder, sphere or mesh, its middle relative to that of the body's box.

    `size` is the sides of a box, the diameter twice and the height of a cylinder, the diameter of a ball in metres, or
    the scale of a mesh; `turn` is roll, pitch and yaw in radians; `mesh` is a file.
    """

    kind: str
    size: Size
    at: Size = (0.0, 0.0, 0.0)
    turn: Size = (0.0, 0.0, 0.0)
    mesh: str = ""


class BodyModel(NamedTuple):
    """The model of a body from a URDF: its collision solids, and its mass in kilograms."""

    solids: tuple[Solid, ...]
    mass: float


class Shape(NamedTuple):
    """A body: its kind (of `KINDS`), the size of its bounding box and a container's wall in metres.

    One from a URDF has a `model`.
    """

    kind: str
    size: Size = (0.0, 0.0, 0.0)
    wall: float = 0.0
    model: BodyModel | None = None

    @property
    def traits(self) -> Kind:
        """The properties of its kind."""
        return KINDS[self.kind]

    @property
    def half(self) -> tuple[float, float, float]:
        """Half of each side of the bounding box, in metres."""
        return (self.size[0] / 2, self.size[1] / 2, self.size[2] / 2)

    def breadth(self, widest: bool) -> float:
        """Return its largest or smallest width upright, in metres."""
        x, y, _ = self.size
        if self.traits.round:
            return x
        return math.hypot(x, y) if widest else min(x, y)


class Material(NamedTuple):
    """The material of a body; the defaults are those of light wood, and of filled packages of cardboard.

    `density` in kilograms a cubic metre; what touches has the product of both coefficients of `friction`; `rolling` is
    how far ahead of its centre a ball is supported when it rolls, in metres: fruit is not quite round.
    """

    density: float = 400.0
    friction: float = 0.7
    rolling: float = 0.002


STANDARD = Material()


class BoxBounds(NamedTuple):
    """A box by its lowest and its highest corner, in metres; infinite where nothing bounds it."""

    low: tuple[float, float, float]
    high: tuple[float, float, float]


class Own(NamedTuple):
    """A spatial predicate that a domain adds: the roles of its arguments, and its definition.

    Either `boxes` around the second argument, or around the entity `around`, say where the first one has to be: its
    centre in one of them, or all of it where `whole` is set; `sentence` is a template of it in plain words. Or `file`
    is the path of a Python file that defines it.
    """

    name: str
    roles: tuple[str, ...]
    boxes: tuple[BoxBounds, ...] = ()
    whole: bool = False
    around: str | None = None
    sentence: str = ""
    file: str = ""


class Mount(NamedTuple):
    """Which robot an entity is, and where its base stands: x and y in metres, yaw in radians."""

    kind: str
    x: float = 0.0
    y: float = 0.0
    yaw: float = 0.0


class Ranges(NamedTuple):
    """The ranges of domain randomization.

    `friction` and `mass` are factors; `light` the degrees by which the light is turned at most, `camera` how far a
    camera and what it looks at are moved, as a share of what is between them, `colour` the Delta E in CIELAB by which a
    colour is moved.
    """

    friction: tuple[float, float] = (0.8, 1.2)
    mass: tuple[float, float] = (0.8, 1.2)
    light: float = 30.0
    camera: float = 0.05
    colour: float = 10.0


USUAL_RANGES = Ranges()


def only_robot(shapes: Mapping[str, Shape], kind: str = "panda") -> dict[str, Mount]:
    """Return the only robot of a scene, at the origin; without an entity it is named after its kind."""
    name = next((entity for entity, shape in shapes.items() if shape.kind == "robot"), kind)
    return {name: Mount(kind)}


@dataclass(frozen=True)
class TableTop:
    """The table: sides along x and y in metres, centre of its top (at z = 0), colour."""

    size: tuple[float, float] = (1.3, 1.6)
    centre: tuple[float, float] = (0.4, 0.0)
    color: str = "#c8a27a"


@dataclass(frozen=True)
class Scene:
    """The scene of a domain.

    `shapes` and `colors` (``#rrggbb``) belong to entities, `workspace` is the part of the table top where the search
    puts objects (low x, high x, low y, high y), not a limit of where they can be, `fixed` holds x, y in metres and
    yaw in radians of what never moves, `predicates` maps fluent names to spatial predicates, `rotations` names to
    yaws in radians.
    `materials` belong to entities; `ranges` hold all shapes, the smallest first, of those whose size is drawn for each
    task, and `shapes` the largest of them.
    `robots` says where each robot stands, by the names of their entities; where it is left out there is one panda, at
    the origin.
    With `frame` "robot" left is the left of the robot (+y) and in front is nearer to it; "viewer" is someone
    who faces the robot. `own` are the spatial predicates that the domain adds, by their names; the Python files
    among them are run only where `trusted` is set. `cameras` have names too; where they are left out there is one,
    `front`. `vary` has the ranges of domain randomization.
    """

    shapes: Mapping[str, Shape]
    frame: str = "robot"
    workspace: tuple[float, float, float, float] = (0.3, 0.7, -0.4, 0.4)
    table: TableTop = field(default_factory=TableTop)
    colors: Mapping[str, str] = field(default_factory=dict)
    fixed: Mapping[str, tuple[float, float, float]] = field(default_factory=dict)
    predicates: Mapping[str, str] = field(default_factory=dict)
    rotations: Mapping[str, float] = field(default_factory=dict)
    materials: Mapping[str, Material] = field(default_factory=dict)
    ranges: Mapping[str, tuple[Shape, ...]] = field(default_factory=dict)
    own: Mapping[str, Own] = field(default_factory=dict)
    trusted: bool = False
    robots: Mapping[str, Mount] = field(default_factory=dict)
    cameras: Mapping[str, Camera] = field(default_factory=dict)
    vary: Ranges = USUAL_RANGES

    def __post_init__(self) -> None:
        if not self.robots:
            object.__setattr__(self, "robots", only_robot(self.shapes))
        if not self.cameras:
            object.__setattr__(self, "cameras", usual_cameras(self.workspace, self.robots, self.fixed_corners()))

    def fixed_corners(self) -> tuple[Size, ...]:
        """Return points on the table around what is fixed, and as high as that is, in metres."""
        corners = []
        for entity, (x, y, _) in self.fixed.items():
            size = self.shapes[entity].size if entity in self.shapes else (0.0, 0.0, 0.0)
            wide = math.hypot(size[0], size[1]) / 2
            corners += [(x + a * wide, y + b * wide, z) for a in (-1, 1) for b in (-1, 1) for z in (0.0, size[2])]
        return tuple(corners)

    @property
    def shared(self) -> bool:
        """Whether several robots work at the table: they keep out of each other's way, and instructions name them."""
        return len(self.robots) > 1

    def meaning(self, fluent: Atom) -> str | None:
        """Return the name of the spatial predicate that `fluent` means, None where physics ignores it."""
        name = self.predicates.get(fluent.name, fluent.name)
        return name if name in PREDICATE_ROLES or name in self.own else None

    def roles(self, predicate: str) -> tuple[str, ...]:
        """Return what each argument of a spatial predicate of this scene has to be."""
        own = self.own.get(predicate)
        return PREDICATE_ROLES[predicate] if own is None else own.roles

    def material(self, entity: str) -> Material:
        """Return what an entity is made of."""
        return self.materials.get(entity, STANDARD)

    def with_shapes(self, shapes: Mapping[str, Shape]) -> Scene:
        """Return the scene with the sampled shapes of a task; bodies without one have their largest shape."""
        return replace(self, shapes={**self.shapes, **shapes}, ranges={}) if self.ranges else self

    def with_sizes(self, sizes: Mapping[str, Size]) -> Scene:
        """Return the scene with the sampled sizes of a task, in metres.

        Raises:
            SceneError: an entity cannot have its size.
        """
        return self.with_shapes({entity: self._shape(entity, size) for entity, size in sizes.items()})

    def _shape(self, entity: str, size: Size) -> Shape:
        """Return the shape of a size in the range of an entity."""
        for shape in self.ranges.get(entity, ()):
            if all(abs(side - other) < SAME_SIZE for side, other in zip(shape.size, size, strict=True)):
                return shape
        shown = " x ".join(f"{side:.4f}" for side in size)
        raise SceneError(f"{entity} cannot have the size {shown} m; the scene gives it another range")
