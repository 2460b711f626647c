"""Whether bodies rest: some upward forces at their contacts hold all of them in balance.

For bodies that stand on each other this is the rule of the combined centre of mass; it also covers what bridges two
supports, where no single centre of mass decides. A body stands on the flat top of any primitive.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator
from typing import NamedTuple

import numpy as np

from tests.independent.convex import surface
from tests.independent.frames import Array
from tests.independent.tolerances import BALANCED, CONTACT, SAME, UPRIGHT
from tests.independent.world import Layout, Solid

SIDES = 48
TABLE = "the table"


class Contact(NamedTuple):
    """A corner of where a body stands on another, seen from above; on what of it moves, if it is furniture."""

    upper: str
    lower: str
    moving: bool
    corner: Array


def falling(layout: Layout, held: Collection[str]) -> str | None:
    """Return a body that nothing keeps where it is, None where all rest; held bodies stay and bear others."""
    world = layout.world
    loose = [name for name in layout.poses if name not in held and name not in world.places]
    for name in loose:
        if world.kinds[name] != "sphere" and layout.poses[name].turn[2, 2] < 1 - UPRIGHT:
            return name
    touching = [contact for name in loose for contact in _contacts(layout, name)]
    for name in loose:
        if not any(contact.upper == name for contact in touching):
            return name
    return _unbalanced(layout, loose, touching) if loose else None


def _unbalanced(layout: Layout, loose: list[str], touching: list[Contact]) -> str | None:
    """Return the body whose balance is the farthest off where forces balance all bodies best, None where they do."""
    rows = {name: 3 * i for i, name in enumerate(loose)}
    forces = np.zeros((3 * len(loose), len(touching)))
    weights = np.zeros(3 * len(loose))
    for name, row in rows.items():
        x, y, _ = layout.centre(name)
        weights[row : row + 3] = layout.world.masses[name] * np.array([1.0, 10 * x, 10 * y])
    for column, contact in enumerate(touching):
        lever = np.array([1.0, 10 * contact.corner[0], 10 * contact.corner[1]])
        forces[rows[contact.upper] : rows[contact.upper] + 3, column] += lever
        if contact.lower in rows:
            forces[rows[contact.lower] : rows[contact.lower] + 3, column] -= lever
    scale = weights[::3].max()
    left = np.abs(forces @ _least_squares(forces, weights / scale) - weights / scale)
    return loose[int(left.argmax()) // 3] if left.max() > BALANCED else None


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


def _contacts(layout: Layout, name: str) -> Iterator[Contact]:
    """Yield what a body stands on, corner by corner."""
    low, below = layout.span(name)[0][2], None
    if abs(low) <= CONTACT:
        below = _foot(layout, name)
        for corner in _common(below, _rectangle(*layout.world.table, np.eye(2))):
            yield Contact(name, TABLE, False, corner)
    for other in layout.poses:
        if other == name or layout.gap(name, other) > CONTACT:
            continue
        if other in layout.world.models:
            below = _foot(layout, name) if below is None else below
            yield from (Contact(name, other, False, corner) for corner in _on_model(layout, other, low, below))
            continue
        for solid in layout.body(other).solids:
            if solid.part.kind != "sphere" and abs(low - solid.middle[2] - solid.part.half[2]) <= CONTACT:
                below = _foot(layout, name) if below is None else below
                for corner in _common(below, _outline(solid)):
                    yield Contact(name, other, solid.moving, corner)


def _on_model(layout: Layout, name: str, height: float, foot: Array) -> Iterator[Array]:
    """Yield the corners of what a foot at a height shares with the highest points of a body, or with its cavity."""
    points = np.concatenate([corners(solid) for solid in layout.body(name).solids])
    top = points[:, 2].max()
    if abs(height - top) <= CONTACT:
        yield from _common(foot, _around(points[points[:, 2] >= top - SAME][:, :2]))
    if layout.world.models[name].cavity[1].any():
        frame, ((_, x), (_, y), (floor, _)) = layout.room(name)
        if abs(height - frame.at[2] - floor) <= CONTACT:
            yield from _common(foot, _rectangle(frame.at[:2], np.array([x, y]), frame.turn[:2, :2]))


def corners(solid: Solid) -> Array:
    """Return the corners of a body where it is, those of a round one spread over its rims."""
    part, place = solid.part, solid.place
    if part.hull is not None:
        local = part.hull.corners
    elif part.kind == "box":
        local = np.array([(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]) * part.half
    else:
        local = surface(part, 0.002)
    return np.asarray((local + part.at) @ place.turn.T + place.at)


def rests(layout: Layout, name: str) -> bool:
    """Tell whether a body stands on anything, wherever its centre of mass is."""
    return next(_contacts(layout, name), None) is not None


def riders(layout: Layout, carrier: str) -> set[str]:
    """Return the bodies that stand on or in one, on those, and so on; of furniture on or in what moves of it."""
    contacts = {name: list(_contacts(layout, name)) for name in layout.poses}
    furniture = layout.world.furniture
    found, more = set[str](), {carrier}
    while more:
        found |= more
        more = {
            name
            for name in layout.poses
            if name not in found
            and any(each.lower in found and (each.moving or each.lower not in furniture) for each in contacts[name])
        }
    return found - {carrier}


def _foot(layout: Layout, name: str) -> Array:
    """Return the corners of what a body stands on with, counter-clockwise, shape (n, 2)."""
    if name in layout.world.models:
        points = np.concatenate([corners(solid) for solid in layout.body(name).solids])
        return _around(points[points[:, 2] <= points[:, 2].min() + SAME][:, :2])
    lowest = min(layout.body(name).solids, key=lambda solid: solid.middle[2] - solid.part.half[2])
    return _outline(lowest)


def _outline(solid: Solid) -> Array:
    """Return the corners of an upright primitive, counter-clockwise, shape (n, 2); of a ball where it stands."""
    at, half = solid.middle[:2], solid.part.half
    if solid.part.kind == "sphere":
        return at[None]
    if solid.part.kind == "cylinder":
        angles = np.linspace(0, 2 * np.pi, SIDES, endpoint=False)
        return np.asarray(at + half[0] * np.column_stack([np.cos(angles), np.sin(angles)]))
    return _rectangle(at, half[:2], solid.place.turn[:2, :2])


def _around(points: Array) -> Array:
    """Return the corners of the convex outline of points in a plane, counter-clockwise (Andrew 1979)."""
    ordered = [tuple(point) for point in np.unique(points.round(7), axis=0).tolist()]
    if len(ordered) < 3:
        return np.array(ordered)
    chains: list[list[tuple[float, ...]]] = []
    for row in (ordered, ordered[::-1]):
        chain: list[tuple[float, ...]] = []
        for point in row:
            while len(chain) > 1 and _turns_right(*chain[-2:], point):
                chain.pop()
            chain.append(point)
        chains.append(chain[:-1])
    return np.array([*chains[0], *chains[1]])


def _turns_right(one: tuple[float, ...], two: tuple[float, ...], three: tuple[float, ...]) -> bool:
    return (two[0] - one[0]) * (three[1] - one[1]) - (two[1] - one[1]) * (three[0] - one[0]) <= 0.0


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
