"""Whether bodies rest: some upward forces at their contacts hold all of them in balance.

For bodies that stand on each other this is the rule of the combined centre of mass; it also covers what bridges two
supports, where no single centre of mass decides.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import numpy as np

from tests.independent.world import Array, Frame, World, bottom, top

CONTACT = 0.002
"""Metres between surfaces that touch."""

UPRIGHT = 1e-3
SIDES = 48
TABLE = "the table"


def falling(world: World, poses: Mapping[str, Frame], held: str | None) -> str | None:
    """Return a body that nothing keeps where it is, None where all rest; a held body stays and bears others."""
    loose = [name for name in poses if name != held and name not in world.fixed]
    for name in loose:
        if world.kinds[name] != "sphere" and poses[name].turn[2, 2] < 1 - UPRIGHT:
            return name
    levels = _levels(world, poses)
    touching = [(name, support, at) for name in loose for support, at in _contacts(world, poses, levels, name)]
    for name in loose:
        if not any(upper == name for upper, _, _ in touching):
            return name
    if not loose:
        return None
    return _unbalanced(world, poses, loose, touching)


def _unbalanced(
    world: World, poses: Mapping[str, Frame], loose: list[str], touching: list[tuple[str, str, Array]]
) -> str | None:
    """Return the body whose balance is the farthest off where forces balance all bodies best, None where they do."""
    rows = {name: 3 * i for i, name in enumerate(loose)}
    forces = np.zeros((3 * len(loose), len(touching)))
    weights = np.zeros(3 * len(loose))
    for name, row in rows.items():
        x, y, _ = poses[name].at
        weights[row : row + 3] = world.masses[name] * np.array([1.0, 10 * x, 10 * y])
    for column, (upper, lower, (x, y)) in enumerate(touching):
        lever = np.array([1.0, 10 * x, 10 * y])
        forces[rows[upper] : rows[upper] + 3, column] += lever
        if lower in rows:
            forces[rows[lower] : rows[lower] + 3, column] -= lever
    scale = weights[::3].max()
    left = np.abs(forces @ _least_squares(forces, weights / scale) - weights / scale)
    return loose[int(left.argmax()) // 3] if left.max() > 1e-5 else None


def _least_squares(matrix: Array, target: Array) -> Array:
    """Return the x of no negative number that brings ``matrix @ x`` nearest to a target (Lawson and Hanson 1974)."""
    x = np.zeros(matrix.shape[1])
    used = np.zeros(matrix.shape[1], dtype=bool)
    for _ in range(10 * matrix.shape[1] + 10):
        pull = matrix.T @ (target - matrix @ x)
        pull[used] = -np.inf
        if pull.max() <= 1e-10:
            break
        used[pull.argmax()] = True
        while True:
            wanted = np.zeros_like(x)
            wanted[used] = np.linalg.lstsq(matrix[:, used], target, rcond=None)[0]
            low = used & (wanted <= 0.0)
            if not low.any():
                break
            share = (x[low] / np.maximum(x[low] - wanted[low], 1e-300)).min()
            x += share * (wanted - x)
            used &= x > 1e-12
            x[~used] = 0.0
        x = wanted
    return x


Levels = Mapping[str, tuple[float, float]]
"""The height of a body's foot, and that of the surface on which others can stand; metres."""


def _levels(world: World, poses: Mapping[str, Frame]) -> Levels:
    levels = {}
    for name in poses:
        low, kind = bottom(world, name, poses), world.kinds[name]
        high = low + world.walls[name] if kind == "container" else top(world, name, poses)
        levels[name] = (low, np.inf if kind == "sphere" else high)
    return levels


def _contacts(world: World, poses: Mapping[str, Frame], levels: Levels, name: str) -> Iterator[tuple[str, Array]]:
    """Yield what a body stands on, and the corners of where it does, seen from above."""
    low, below = levels[name][0], None
    if abs(low) <= CONTACT:
        below = _outline(world, name, poses[name])
        yield from ((TABLE, corner) for corner in _common(below, _rectangle(*world.table, np.eye(2))))
    for other, pose in poses.items():
        if other != name and abs(low - levels[other][1]) <= CONTACT:
            below = _outline(world, name, poses[name]) if below is None else below
            surface = (_floor if world.kinds[other] == "container" else _outline)(world, other, pose)
            yield from ((other, corner) for corner in _common(below, surface))


def riders(world: World, poses: Mapping[str, Frame], carrier: str) -> set[str]:
    """Return the bodies that stand on or in one, on those, and so on."""
    levels, found = _levels(world, poses), set[str]()
    more = {carrier}
    while more:
        found |= more
        more = {
            name
            for name in poses
            if name not in found and any(support in found for support, _ in _contacts(world, poses, levels, name))
        }
    return found - {carrier}


def _outline(world: World, name: str, pose: Frame) -> Array:
    """Return the corners of the foot of an upright body, counter-clockwise, shape (n, 2)."""
    half = world.halves[name]
    if world.kinds[name] == "sphere":
        return pose.at[None, :2]
    if world.kinds[name] == "cylinder":
        angles = np.linspace(0, 2 * np.pi, SIDES, endpoint=False)
        return np.asarray(pose.at[:2] + half[0] * np.column_stack([np.cos(angles), np.sin(angles)]))
    return _rectangle(pose.at[:2], half[:2], pose.turn[:2, :2])


def _floor(world: World, container: str, pose: Frame) -> Array:
    """Return the corners of the floor between the walls of a container."""
    return _rectangle(pose.at[:2], world.halves[container][:2] - world.walls[container], pose.turn[:2, :2])


def _rectangle(centre: Array, half: Array, turn: Array) -> Array:
    corners = np.array([[1, 1], [-1, 1], [-1, -1], [1, -1]]) * half
    return np.asarray(centre + corners @ turn.T)


def _common(one: Array, two: Array) -> Array:
    """Return the corners of what two convex polygons share: corners within the other, and where edges cross."""
    found = [*one[_within(two, one)]]
    if len(one) >= 3:
        found += [*two[_within(one, two)], *_crossings(one, two)]
    return np.array(found).reshape(-1, 2)


def _within(polygon: Array, points: Array) -> Array:
    """Tell which points lie within a convex counter-clockwise polygon."""
    edges = np.roll(polygon, -1, axis=0) - polygon
    to = points[:, None, :] - polygon[None]
    return np.asarray((edges[:, 0] * to[..., 1] - edges[:, 1] * to[..., 0] >= -1e-12).all(axis=1))


def _crossings(one: Array, two: Array) -> Array:
    """Return the points where the edges of two polygons cross."""
    a, c = one[:, None], two[None]
    ab, cd = np.roll(one, -1, axis=0)[:, None] - a, np.roll(two, -1, axis=0)[None] - c
    across = ab[..., 0] * cd[..., 1] - ab[..., 1] * cd[..., 0]
    parallel = np.abs(across) < 1e-15
    safe, ac = np.where(parallel, 1.0, across), c - a
    s = (ac[..., 0] * cd[..., 1] - ac[..., 1] * cd[..., 0]) / safe
    t = (ac[..., 0] * ab[..., 1] - ac[..., 1] * ab[..., 0]) / safe
    cross = ~parallel & (s >= 0) & (s <= 1) & (t >= 0) & (t <= 1)
    return np.asarray((a + s[..., None] * ab)[cross])
