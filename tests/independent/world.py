"""What the check knows of a scene, and rigid bodies placed in it; metres and radians, z up."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from prag_asp.domain.scene import PREDICATE_ROLES, Scene

Array = NDArray[np.float64]


class Frame(NamedTuple):
    """A rotation, shape (3, 3), and a position, shape (3,)."""

    turn: Array
    at: Array

    def __matmul__(self, inner: Frame) -> Frame:
        return Frame(self.turn @ inner.turn, self.turn @ inner.at + self.at)

    def inverse(self) -> Frame:
        return Frame(self.turn.T, -self.turn.T @ self.at)

    def offset(self, other: Frame) -> tuple[float, float]:
        """Return how far and by what angle another frame is off this one."""
        # The norm of the difference of two rotations by an angle a is 2 sqrt(2) sin(a / 2).
        chord = float(np.linalg.norm(self.turn - other.turn)) / (2 * np.sqrt(2))
        return float(np.linalg.norm(self.at - other.at)), 2 * float(np.arcsin(min(1.0, chord)))


class Part(NamedTuple):
    """A primitive: box, cylinder or sphere, half the sides of its bounding box, its place in its body."""

    kind: str
    half: Array
    at: Array


@dataclass(frozen=True)
class World:
    """The bodies and the words of a scene."""

    kinds: Mapping[str, str]
    halves: Mapping[str, Array]
    walls: Mapping[str, float]
    parts: Mapping[str, tuple[Part, ...]]
    masses: Mapping[str, float]
    fixed: frozenset[str]
    table: tuple[Array, Array]
    meanings: Mapping[str, str]
    rotations: Mapping[str, float]
    viewer: bool

    def meaning(self, name: str) -> str | None:
        """Return the spatial predicate that a fluent's name means, None where it means none."""
        meaning = self.meanings.get(name, name)
        return meaning if meaning in PREDICATE_ROLES else None


def world_of(scene: Scene) -> World:
    """Return the numbers of a scene."""
    kinds = {name: shape.kind for name, shape in scene.shapes.items()}
    halves = {name: np.array(shape.size) / 2 for name, shape in scene.shapes.items()}
    walls = {name: shape.wall for name, shape in scene.shapes.items()}
    bodies = [name for name, kind in kinds.items() if kind not in ("robot", "table")]
    parts = {name: _parts(kinds[name], halves[name], walls[name]) for name in bodies}
    return World(
        kinds=kinds,
        halves=halves,
        walls=walls,
        parts=parts,
        masses={name: sum(_volume(part) for part in pieces) for name, pieces in parts.items()},
        fixed=frozenset(scene.fixed),
        table=(np.array(scene.table.centre), np.array(scene.table.size) / 2),
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


def _volume(part: Part) -> float:
    full = 8 * float(np.prod(part.half))
    return full * {"box": 1.0, "cylinder": np.pi / 4, "sphere": np.pi / 6}[part.kind]


def frame(pose: Sequence[Sequence[float]]) -> Frame:
    """Return the frame of a pose as a file has it: position, then quaternion x, y, z, w."""
    at, (x, y, z, w) = pose
    skew = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    return Frame(np.eye(3) + 2 * w * skew + 2 * skew @ skew, np.array(at, dtype=float))


def sound(pose: Sequence[Sequence[float]]) -> bool:
    """Tell whether a pose is of finite numbers, with a quaternion of length one."""
    at, quaternion = (np.array(part, dtype=float) for part in pose)
    finite = at.shape == (3,) and quaternion.shape == (4,) and np.isfinite([*at, *quaternion]).all()
    return bool(finite and abs(np.linalg.norm(quaternion) - 1) < 1e-6)


def top(world: World, name: str, poses: Mapping[str, Frame]) -> float:
    """Return the height of the highest point of a body, or of the table."""
    return 0.0 if world.kinds[name] == "table" else float(poses[name].at[2] + box(world, name, poses[name].turn)[2])


def bottom(world: World, name: str, poses: Mapping[str, Frame]) -> float:
    """Return the height of the lowest point of a body."""
    return float(poses[name].at[2] - box(world, name, poses[name].turn)[2])


def box(world: World, name: str, turn: Array) -> Array:
    """Return half the sides of the bounding box of a turned body, along the axes in which its turn is given."""
    kind, half = world.kinds[name], world.halves[name]
    if kind == "sphere":
        return half
    if kind == "cylinder":
        axis = turn[:, 2]
        rim = half[0] * np.sqrt(np.maximum(0.0, 1 - axis**2))
        return np.asarray(np.abs(axis) * half[2] + rim)
    return np.asarray(np.abs(turn) @ half)
