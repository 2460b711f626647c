"""What the check knows of a scene, and the bodies placed in it; metres and radians, z up."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from prag_asp.scene.predicate_names import PREDICATE_ROLES
from prag_asp.scene.scene import Scene
from tests.independent.convex import Part, volume
from tests.independent.frames import Array, Frame, moved, standing
from tests.independent.furniture import MADE, Corners, Furniture
from tests.independent.robots import ROBOTS, Mounted

FLAT = ("robot", "table", "zone")
KINDS = ("box", "cylinder", "sphere", "container", *MADE)


@dataclass(frozen=True)
class World:
    """The bodies, the robots and the words of a scene.

    `parts` are those of each body that stand still on it, of furniture those without its door; `places` is where
    zones and fixed bodies are.
    """

    kinds: Mapping[str, str]
    halves: Mapping[str, Array]
    walls: Mapping[str, float]
    parts: Mapping[str, tuple[Part, ...]]
    furniture: Mapping[str, Furniture]
    masses: Mapping[str, float]
    places: Mapping[str, Frame]
    table: tuple[Array, Array]
    robots: Mapping[str, Mounted]
    meanings: Mapping[str, str]
    rotations: Mapping[str, float]
    viewer: bool

    def meaning(self, name: str) -> str | None:
        """Return the spatial predicate that a fluent's name means, None where it means none."""
        meaning = self.meanings.get(name, name)
        return meaning if meaning in PREDICATE_ROLES else None


class Solid(NamedTuple):
    """A primitive where it is; whose it is, whether it moves on a joint and is part of a handle."""

    name: str
    part: Part
    place: Frame
    middle: Array
    moving: bool
    handle: bool


class Body(NamedTuple):
    """A body where it is: its primitives, the lowest and highest corners of the boxes around each and around all."""

    pose: Frame
    opening: float
    solids: tuple[Solid, ...]
    lows: Array
    highs: Array
    low: Array
    high: Array


@dataclass(frozen=True, eq=False)
class Layout:
    """Where all bodies are, and how far furniture is open; `known` are bodies, kept as long as they do not move."""

    world: World
    poses: Mapping[str, Frame]
    openings: Mapping[str, float]
    known: dict[str, Body] = field(default_factory=dict)

    def body(self, name: str) -> Body:
        """Return a body where it is."""
        pose, opening, known = self.poses[name], self.openings.get(name, 0.0), self.known.get(name)
        if known is not None and known.pose is pose and known.opening == opening:
            return known
        solids = tuple(self._solids(name))
        halves = np.array([_box(solid.part, solid.place.turn) for solid in solids])
        middles = np.array([solid.middle for solid in solids])
        lows, highs = middles - halves, middles + halves
        body = self.known[name] = Body(pose, opening, solids, lows, highs, lows.min(axis=0), highs.max(axis=0))
        return body

    def _solids(self, name: str) -> Iterator[Solid]:
        pose, furniture = self.poses[name], self.world.furniture.get(name)
        for part in self.world.parts[name]:
            yield Solid(name, part, pose, pose.turn @ part.at + pose.at, False, False)
        if furniture is not None:
            place, last = self.joint(name), len(furniture.moving) - furniture.handles
            for k, box in enumerate(furniture.moving):
                part = _boxed(box)
                yield Solid(name, part, place, place.turn @ part.at + place.at, True, k >= last)

    def joint(self, name: str) -> Frame:
        """Return the frame of the joint of furniture."""
        return self.poses[name] @ self.world.furniture[name].shift(self.openings[name])

    def span(self, name: str) -> tuple[Array, Array]:
        """Return the lowest and the highest corner of a body, of a zone or of the table, of these on the table's top.

        What is turned has a larger box, along the axes of the scene.
        """
        if name in self.poses:
            return self.body(name).low, self.body(name).high
        pose = self.pose(name)
        half = np.append(np.abs(pose.turn[:2, :2]) @ self.flat(name), 0.0)
        return pose.at - half, pose.at + half

    def flat(self, name: str) -> Array:
        """Return half the sides along x and y of a body, a zone or the table, in its own axes."""
        return self.world.table[1] if self.world.kinds[name] == "table" else self.world.halves[name][:2]

    def pose(self, name: str) -> Frame:
        """Return where a body, a zone or the table is."""
        if self.world.kinds[name] == "table":
            x, y = self.world.table[0]
            return moved(x, y, 0.0)
        return self.poses[name] if name in self.poses else self.world.places[name]

    def room(self, name: str) -> tuple[Frame, Corners]:
        """Return where things lie in something hollow: a frame, and the ends of the room in it."""
        furniture = self.world.furniture.get(name)
        if furniture is not None:
            return (self.joint(name) if furniture.slides else self.poses[name]), furniture.room
        (x, y, z), wall = self.world.halves[name], self.world.walls[name]
        return self.poses[name], ((wall - x, x - wall), (wall - y, y - wall), (wall - z, z))

    def carried(self, places: Mapping[str, Frame], frame: Frame) -> Layout:
        """Return the layout with some bodies at places in a frame."""
        poses = {name: frame @ places[name] if name in places else pose for name, pose in self.poses.items()}
        return Layout(self.world, poses, self.openings, self.known)

    def opened(self, name: str, opening: float, contents: Mapping[str, Frame]) -> Layout:
        """Return the layout with furniture open otherwise; what lies in its moving part has places in that."""
        changed = Layout(self.world, self.poses, {**self.openings, name: opening}, self.known)
        return changed.carried(contents, changed.joint(name))

    def gap(self, one: str, two: str) -> float:
        """Return by how many metres the boxes around two bodies are apart along some axis, negative where they meet."""
        (low, high), (other_low, other_high) = self.span(one), self.span(two)
        return float(np.maximum(low - other_high, other_low - high).max())


def _box(part: Part, turn: Array) -> Array:
    """Return half the sides of the box around a turned primitive, along the axes in which its turn is given."""
    if part.kind == "sphere":
        return part.half
    if part.kind == "cylinder":
        axis = turn[:, 2]
        return np.asarray(np.abs(axis) * part.half[2] + part.half[0] * np.sqrt(np.maximum(0.0, 1 - axis**2)))
    return np.asarray(np.abs(turn) @ part.half)


def _boxed(corners: Corners) -> Part:
    low, high = np.array(corners).T
    return Part("box", (high - low) / 2, (high + low) / 2)


def world_of(scene: Scene) -> World:
    """Return the numbers of a scene.

    Raises:
        ValueError: it has shapes that the check cannot measure.
    """
    kinds = {name: shape.kind for name, shape in scene.shapes.items()}
    unknown = sorted({kind for kind in kinds.values() if kind not in (*KINDS, *FLAT)})
    if unknown or scene.ranges:
        raise ValueError(f"the independent check knows no {', '.join(unknown) or 'ranges of sizes'}")
    halves = {name: np.array(shape.size) / 2 for name, shape in scene.shapes.items()}
    walls = {name: shape.wall for name, shape in scene.shapes.items()}
    furniture = {name: MADE[kind](2 * halves[name], walls[name]) for name, kind in kinds.items() if kind in MADE}
    parts = {
        name: tuple(_boxed(box) for box in furniture[name].still)
        if name in furniture
        else _parts(kind, halves[name], walls[name])
        for name, kind in kinds.items()
        if kind not in FLAT
    }
    heights = {name: 0.0 if kinds[name] == "zone" else halves[name][2] for name in scene.fixed}
    return World(
        kinds=kinds,
        halves=halves,
        walls=walls,
        parts=parts,
        furniture=furniture,
        masses={name: scene.material(name).density * sum(map(volume, pieces)) for name, pieces in parts.items()},
        places={name: standing(x, y, heights[name], yaw) for name, (x, y, yaw) in scene.fixed.items()},
        table=(np.array(scene.table.centre), np.array(scene.table.size) / 2),
        robots={
            name: Mounted(ROBOTS[mount.kind], standing(mount.x, mount.y, 0.0, mount.yaw))
            for name, mount in scene.robots.items()
        },
        meanings=dict(scene.predicates),
        rotations=dict(scene.rotations),
        viewer=scene.frame == "viewer",
    )


def _parts(kind: str, half: Array, wall: float) -> tuple[Part, ...]:
    if kind != "container":
        return (Part(kind, half, np.zeros(3)),)
    x, y, z = half
    t = wall / 2
    pieces = [((0, 0, t - z), (x, y, t))]
    for side in (1, -1):
        pieces.append(((side * (x - t), 0, 0), (t, y, z)))
        pieces.append(((0, side * (y - t), 0), (x, t, z)))
    return tuple(Part("box", np.array(sides, dtype=float), np.array(at, dtype=float)) for at, sides in pieces)
