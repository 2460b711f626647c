"""What physics knows of a domain: the bodies, where they stand, what the fluents mean.

Lengths are metres, angles radians. The world's origin is the base of the robot on the table top: x points away
from the robot, y to the robot's left, z up.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import NamedTuple

from prag_asp.domain.atom import Atom

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
    "over": ("robot", "object"),
    "located": ("object", "object"),
    "rotated": ("object", "rotation"),
}
"""The spatial predicates and what each of their arguments has to be."""

BODILESS = ("robot", "table", "zone")
"""The kinds of shapes that are no objects: a robot, the table, and a flat part of the table's top."""

IGNORED = "none"
"""What ``scene.predicates`` maps a fluent to that means nothing to physics."""


class Shape(NamedTuple):
    """A body: its kind (of `SHAPE_KEYS`), the size of its bounding box and a container's wall in metres."""

    kind: str
    size: tuple[float, float, float] = (0.0, 0.0, 0.0)
    wall: float = 0.0

    @property
    def half(self) -> tuple[float, float, float]:
        """Half of each side of the bounding box, in metres."""
        return (self.size[0] / 2, self.size[1] / 2, self.size[2] / 2)


class Mount(NamedTuple):
    """Which robot an entity is, and where its base stands: x and y in metres, yaw in radians."""

    kind: str
    x: float = 0.0
    y: float = 0.0
    yaw: float = 0.0


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
    `robots` says where each robot stands; where it is empty there is one `robot`, at the origin.
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
    robots: Mapping[str, Mount] = field(default_factory=dict)

    @property
    def mounts(self) -> Mapping[str, Mount]:
        """All robots by the names of their entities; a single one at the origin has no name."""
        return self.robots or {"": Mount(self.robot)}

    def meaning(self, fluent: Atom) -> str | None:
        """Return the name of the spatial predicate that `fluent` means, None where physics ignores it."""
        name = self.predicates.get(fluent.name, fluent.name)
        return name if name in PREDICATE_ROLES else None
