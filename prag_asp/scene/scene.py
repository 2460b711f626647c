"""The scene of a domain: its bodies, their places, and the meaning of its fluents.

Lengths are metres, and angles are radians. The origin is on the table top; by default, a single robot has its base
there. The x axis points away from this robot, the y axis to its left, and the z axis up.
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

GREY = "#808080"
"""The colour of an entity to which the scene assigns no colour."""

IGNORED = "none"
"""The value in ``scene.predicates`` for a fluent that physics ignores."""

Size = tuple[float, float, float]
"""The dimensions of a bounding box in metres."""

SAME_SIZE = 1e-6
"""The tolerance within which sizes are equal, in metres, because decimals in files are rounded."""


class Solid(NamedTuple):
    """A solid of a body: a box, cylinder, sphere or mesh.

    `size` holds the dimensions of the bounding box in metres or, for a mesh, its scale along each axis. `at` is the
    position of its centre in the frame of the body, whose origin is the centre of the body's bounding box. `turn` holds
    roll, pitch and yaw in radians; `mesh` is the path of a file.
    """

    kind: str
    size: Size
    at: Size = (0.0, 0.0, 0.0)
    turn: Size = (0.0, 0.0, 0.0)
    mesh: str = ""


class Look(NamedTuple):
    """A visual part of a body: a solid in the frame of the body that does not collide.

    A mesh has the colours and textures of its file; files to which it refers must be inside a `folder`. Surfaces that
    lack both have the `texture`, which is a path, or the `color`. Other solids have the `color`; an empty `color` means
    the colour of the entity.
    """

    solid: Solid
    folder: str = ""
    color: str = ""
    texture: str = ""


class Cavity(NamedTuple):
    """The cavity of a body: the centre of its floor in the frame of the body, and its sides and depth, in metres.

    A box with these sides encloses the cavity, which may be round. `yaw` is the angle in radians by which the box is
    turned in the frame of the body.
    """

    middle: Size
    sides: Size
    yaw: float = 0.0


class BodyModel(NamedTuple):
    """The model of a body from a file, in the frame of the body, whose origin is the centre of its bounding box.

    It consists of the collision solids, the `mass` in kilograms, the `centre` of mass in metres, and the principal
    `moments` of inertia in kg m² about `axes`, a unit quaternion (x, y, z, w).

    `base` and `crown` are the convex outlines, seen from above and counter-clockwise, of its lowest points, on which it
    stands, and of its highest points, on which other bodies stand; empty outlines mean those of its box. `settled` is
    the angle in radians by which it was tilted from its orientation in the file, because it is not stable in that
    orientation. `looks` are its visual parts; without them, its collision solids are shown.
    """

    solids: tuple[Solid, ...]
    mass: float
    centre: Size = (0.0, 0.0, 0.0)
    moments: Size = (0.0, 0.0, 0.0)
    axes: tuple[float, float, float, float] = (0.0, 0.0, 0.0, 1.0)
    base: tuple[tuple[float, float], ...] = ()
    crown: tuple[tuple[float, float], ...] = ()
    settled: float = 0.0
    cavity: Cavity | None = None
    looks: tuple[Look, ...] = ()

    def __hash__(self) -> int:
        # Caches look up models often, and some models have hundreds of numbers; these few suffice to distinguish them.
        return hash((self.mass, self.centre, self.moments, len(self.solids)))

    def with_mass(self, mass: float) -> BodyModel:
        """Return the model with a different mass in kilograms and the same mass distribution."""
        x, y, z = (moment * mass / self.mass for moment in self.moments)
        return self._replace(mass=mass, moments=(x, y, z))


class Shape(NamedTuple):
    """The shape of a body: its kind (one of `KINDS`), the size of its bounding box, and its wall thickness, in metres.

    A shape from a file has a `model`.
    """

    kind: str
    size: Size = (0.0, 0.0, 0.0)
    wall: float = 0.0
    model: BodyModel | None = None

    @property
    def traits(self) -> Kind:
        """The properties of the shape's kind."""
        return KINDS[self.kind]

    @property
    def hollow(self) -> bool:
        """Whether the body can contain others, because of its kind or because its model has a cavity."""
        return self.traits.hollow or (self.model is not None and self.model.cavity is not None)

    @property
    def half(self) -> tuple[float, float, float]:
        """Half of each dimension of the bounding box, in metres."""
        return (self.size[0] / 2, self.size[1] / 2, self.size[2] / 2)

    def breadth(self, widest: bool) -> float:
        """Return the largest or the smallest horizontal width of the upright body, in metres."""
        x, y, _ = self.size
        if self.traits.round:
            return x
        return math.hypot(x, y) if widest else min(x, y)


class Material(NamedTuple):
    """The material of a body; the defaults fit light wood and full cardboard boxes.

    `density` is in kilograms per cubic metre. The friction coefficient of a contact is the product of the `friction` of
    the two bodies. `rolling` is the coefficient of rolling friction of a ball in metres, because fruit is not quite
    round.
    """

    density: float = 400.0
    friction: float = 0.7
    rolling: float = 0.002


STANDARD = Material()


class BoxBounds(NamedTuple):
    """A box, given by its lowest and its highest corner in metres, whose coordinates may be infinite."""

    low: tuple[float, float, float]
    high: tuple[float, float, float]


class Own(NamedTuple):
    """A spatial predicate that a domain adds: the roles of its arguments, and its definition.

    It is defined either by `boxes`, or by the Python file at the path `file`. The boxes are relative to the second
    argument, or to the entity `around`; the predicate holds if one of the boxes contains the centre of the first
    argument or, with `whole`, the entire body. `sentence` is a template of the predicate in plain words.
    """

    name: str
    roles: tuple[str, ...]
    boxes: tuple[BoxBounds, ...] = ()
    whole: bool = False
    around: str | None = None
    sentence: str = ""
    file: str = ""


class Mount(NamedTuple):
    """The kind of a robot, and the pose of its base: x and y in metres, and the yaw in radians."""

    kind: str
    x: float = 0.0
    y: float = 0.0
    yaw: float = 0.0


class Ranges(NamedTuple):
    """The ranges of domain randomization.

    `friction` and `mass` hold the smallest and the largest factor. The other fields are the largest changes: `light` is
    that of the light direction, in degrees; `camera` is that of the positions of a camera and its target, as a share of
    their distance; `colour` is that of a colour, as Delta E in CIELAB.
    """

    friction: tuple[float, float] = (0.8, 1.2)
    mass: tuple[float, float] = (0.8, 1.2)
    light: float = 30.0
    camera: float = 0.05
    colour: float = 10.0


USUAL_RANGES = Ranges()


def only_robot(shapes: Mapping[str, Shape], kind: str = "panda") -> dict[str, Mount]:
    """Return the mount of a single robot at the origin, under the name of its entity or else of its kind."""
    name = next((entity for entity, shape in shapes.items() if shape.kind == "robot"), kind)
    return {name: Mount(kind)}


@dataclass(frozen=True)
class TableTop:
    """The table: its dimensions along x and y in metres, the centre of its top (at z = 0), and its colour."""

    size: tuple[float, float] = (1.3, 1.6)
    centre: tuple[float, float] = (0.4, 0.0)
    color: str = "#c8a27a"


BALANCE = 0.01
"""The default of `Scene.balance`, because robots put objects down with an accuracy of a few millimetres."""


@dataclass(frozen=True)
class Scene:
    """The scene of a domain.

    Most fields map names of entities to values: `shapes`, `colors` (``#rrggbb``) and `materials`; `robots` maps robots
    to their mounts, and `fixed` maps bodies that never move to their places (x and y in metres, and the yaw in
    radians). If the size of an entity is sampled for each task, `ranges` holds all its possible shapes, smallest first,
    and `shapes` holds the largest of them. By default, there is one Panda, at the origin.

    `workspace` is the part of the table top on which the search places objects: low x, high x, low y and high y in
    metres. Objects can also be elsewhere. `predicates` maps the names of fluents to spatial predicates, and `rotations`
    maps names to yaws in radians. `frame` is "robot", where left is +y and in front is -x, or "viewer", the view of a
    person who faces the robot.

    `own` maps names to the spatial predicates that the domain adds; their Python files are run only if `trusted` is
    set. `cameras` maps names to cameras; by default, there is one in front, named `front`, and one at each wrist.
    `vary` holds the ranges of domain randomization. `balance` is the margin in metres by which the centre of mass of a
    placed object stays within its support, if the support is large enough.
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
    balance: float = BALANCE

    def __post_init__(self) -> None:
        if not self.robots:
            object.__setattr__(self, "robots", only_robot(self.shapes))
        if not self.cameras:
            object.__setattr__(self, "cameras", usual_cameras(self.workspace, tuple(self.robots), self.fixed_corners()))

    def fixed_corners(self) -> tuple[Size, ...]:
        """Return the corners, in metres, of boxes that contain the fixed bodies at any yaw."""
        corners = []
        for entity, (x, y, _) in self.fixed.items():
            size = self.shapes[entity].size if entity in self.shapes else (0.0, 0.0, 0.0)
            wide = math.hypot(size[0], size[1]) / 2
            corners += [(x + a * wide, y + b * wide, z) for a in (-1, 1) for b in (-1, 1) for z in (0.0, size[2])]
        return tuple(corners)

    @property
    def shared(self) -> bool:
        """Whether several robots share the table; they then avoid each other, and sentences name them."""
        return len(self.robots) > 1

    def meaning(self, fluent: Atom) -> str | None:
        """Return the name of the spatial predicate for a fluent, or None if physics ignores the fluent."""
        name = self.predicates.get(fluent.name, fluent.name)
        return name if name in PREDICATE_ROLES or name in self.own else None

    def roles(self, predicate: str) -> tuple[str, ...]:
        """Return the role of each argument of one of this scene's spatial predicates."""
        own = self.own.get(predicate)
        return PREDICATE_ROLES[predicate] if own is None else own.roles

    def material(self, entity: str) -> Material:
        """Return the material of an entity."""
        return self.materials.get(entity, STANDARD)

    def color(self, entity: str) -> str:
        """Return the colour of an entity as ``#rrggbb``."""
        return self.colors.get(entity, GREY)

    def with_shapes(self, shapes: Mapping[str, Shape]) -> Scene:
        """Return the scene with the sampled shapes of a task; other bodies keep their largest shape."""
        return replace(self, shapes={**self.shapes, **shapes}, ranges={}) if self.ranges else self

    def with_sizes(self, sizes: Mapping[str, Size]) -> Scene:
        """Return the scene with the sampled sizes of a task, in metres.

        Raises:
            SceneError: a size is not possible for its entity.
        """
        shapes = {}
        for entity, size in sizes.items():
            for shape in self.ranges.get(entity, ()):
                if all(abs(side - other) < SAME_SIZE for side, other in zip(shape.size, size, strict=True)):
                    shapes[entity] = shape
                    break
            else:
                shown = " x ".join(f"{side:.4f}" for side in size)
                raise SceneError(f"{entity} cannot have the size {shown} m; the scene gives it another range")
        return self.with_shapes(shapes)
