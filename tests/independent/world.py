"""What the check knows of a scene, and the bodies placed in it; metres and radians, z up."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from itertools import chain
from typing import Any, NamedTuple

import numpy as np

from prag_asp.scene.predicate_names import PREDICATE_ROLES
from prag_asp.scene.read.mesh import mesh_parts
from prag_asp.scene.scene import Scene
from tests.independent.convex import Part, reach, volume
from tests.independent.frames import Array, Frame, moved, standing, turned
from tests.independent.furniture import MADE, Corners, Furniture
from tests.independent.hulls import hull_of
from tests.independent.robots import ROBOTS, Mounted
from tests.independent.tolerances import SPACING

FLAT = ("robot", "table", "zone")
KINDS = ("box", "cylinder", "sphere", "container", *MADE)


@dataclass(frozen=True)
class World:
    """The bodies, the robots and the words of a scene.

    `parts` are those of each body that stand still on it, of furniture those without its door; `places` is where
    zones and fixed bodies are. `models` are the bodies from files, with their convex parts as the scene has them.
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
    models: Mapping[str, Model] = field(default_factory=dict)
    frictions: Mapping[str, float] = field(default_factory=dict)

    def meaning(self, name: str) -> str | None:
        """Return the spatial predicate that a fluent's name means, None where it means none."""
        meaning = self.meanings.get(name, name)
        return meaning if meaning in PREDICATE_ROLES else None


@dataclass(frozen=True)
class Model:
    """What a scene says of a body from a file, in its own frame: the centre of mass, and the cavity.

    The cavity is the middle of its floor, its sides and its depth; there is none where these are 0. It is turned by an
    angle.
    """

    centre: Array
    cavity: tuple[Array, Array]
    turn: float = 0.0


class Solid(NamedTuple):
    """A convex body where it is; whose it is, whether it moves on a joint and is part of a handle."""

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
        middles = np.array([solid.middle for solid in solids])
        ends = np.array([_box(solid.part, solid.place.turn) for solid in solids])
        lows, highs = middles + ends[:, 0], middles + ends[:, 1]
        low, high = lows.min(axis=0), highs.max(axis=0)
        body = self.known[name] = Body(pose, opening, solids, lows, highs, low, high)
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

    def centre(self, name: str) -> Array:
        """Return the centre of mass of a body."""
        pose, model = self.poses[name], self.world.models.get(name)
        return pose.at if model is None else np.asarray(pose.turn @ model.centre + pose.at)

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
        if name in self.world.models:
            middle, (wide, long, deep) = self.world.models[name].cavity
            frame = self.poses[name] @ Frame(turned(self.world.models[name].turn, "z"), middle)
            return frame, ((-wide / 2, wide / 2), (-long / 2, long / 2), (0.0, deep))
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


def _box(part: Part, turn: Array) -> tuple[Array, Array]:
    """Return the ends of the box around a turned body from its middle, along the axes in which its turn is given."""
    return -reach(part, turn, -np.eye(3)), reach(part, turn, np.eye(3))


def _boxed(corners: Corners) -> Part:
    low, high = np.array(corners).T
    return Part("box", (high - low) / 2, (high + low) / 2)


def world_of(scene: Scene) -> World:
    """Return the numbers of a scene.

    Raises:
        ValueError: it has shapes that the check cannot measure.
    """
    kinds = {name: shape.kind for name, shape in scene.shapes.items()}
    models = {name: shape.model for name, shape in scene.shapes.items() if shape.model is not None}
    unknown = sorted({kind for name, kind in kinds.items() if kind not in (*KINDS, *FLAT) and name not in models})
    if unknown or scene.ranges:
        raise ValueError(f"the independent check knows no {', '.join(unknown) or 'ranges of sizes'}")
    halves = {name: np.array(shape.size) / 2 for name, shape in scene.shapes.items()}
    walls = {name: shape.wall for name, shape in scene.shapes.items()}
    furniture = {name: MADE[kind](2 * halves[name], walls[name]) for name, kind in kinds.items() if kind in MADE}
    parts = {
        name: tuple(_boxed(box) for box in furniture[name].still)
        if name in furniture
        else tuple(chain.from_iterable(map(_of_solid, models[name].solids)))
        if name in models
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
        masses={
            name: models[name].mass if name in models else scene.material(name).density * sum(map(volume, pieces))
            for name, pieces in parts.items()
        },
        places={name: standing(x, y, heights[name], yaw) for name, (x, y, yaw) in scene.fixed.items()},
        table=(np.array(scene.table.centre), np.array(scene.table.size) / 2),
        robots={
            name: Mounted(ROBOTS[mount.kind], standing(mount.x, mount.y, 0.0, mount.yaw))
            for name, mount in scene.robots.items()
        },
        meanings=dict(scene.predicates),
        rotations=dict(scene.rotations),
        viewer=scene.frame == "viewer",
        models={
            name: Model(
                np.array(model.centre),
                (np.zeros(3), np.zeros(3))
                if model.cavity is None
                else (np.array(model.cavity.middle), np.array(model.cavity.sides)),
                0.0 if model.cavity is None else model.cavity.yaw,
            )
            for name, model in models.items()
        },
        frictions={name: scene.material(name).friction for name in parts},
    )


def _of_solid(solid: Any) -> Iterator[Part]:
    """Yield the convex parts of a solid of a model; what is turned in its body becomes a hull."""
    turn = turned(solid.turn[2], "z") @ _about_y(solid.turn[1]) @ turned(solid.turn[0], "x")
    if not solid.mesh and (solid.kind == "sphere" or np.allclose(turn, np.eye(3))):
        yield Part(solid.kind, np.array(solid.size) / 2, np.array(solid.at))
        return
    pieces = mesh_parts(solid.mesh, solid.size) if solid.mesh else [_round(solid.kind, np.array(solid.size) / 2)]
    for piece in pieces:
        corners = np.array(piece).reshape(-1, 3) @ turn.T + solid.at
        low, high = corners.min(axis=0), corners.max(axis=0)
        middle = (low + high) / 2
        yield Part("hull", (high - low) / 2, middle, hull_of(corners - middle, SPACING / 3))


def _about_y(angle: float) -> Array:
    cosine, sine = np.cos(angle), np.sin(angle)
    return np.array([[cosine, 0, sine], [0, 1, 0], [-sine, 0, cosine]])


def _round(kind: str, half: Array) -> Array:
    """Return the corners of a box, or of a cylinder as a prism."""
    if kind == "box":
        return np.array([(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]) * half
    angles = np.linspace(0, 2 * np.pi, 64, endpoint=False)
    ring = np.column_stack([np.cos(angles), np.sin(angles), np.ones(64)])
    return np.concatenate([ring * half, ring * half * [1, 1, -1]])


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
