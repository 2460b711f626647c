"""How deep convex bodies, primitives or hulls, are in each other, by directions that separate them.

Two convex bodies overlap by no more than d if along some direction their shadows do (the theorem of separating
axes). Whatever direction is tried gives an upper bound, so a few too many are tried.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import lru_cache
from typing import NamedTuple

import numpy as np

from tests.independent.frames import Array, Frame
from tests.independent.hulls import Hull

RING = np.linspace(0, 2 * np.pi, 180, endpoint=False)
HALVINGS = 12


class Part(NamedTuple):
    """A primitive: box, cylinder or sphere, half the sides of its bounding box, its place in its body.

    A `hull` in place of these is about the middle of that box.
    """

    kind: str
    half: Array
    at: Array
    hull: Hull | None = None


def volume(part: Part) -> float:
    """Return the volume of a primitive in cubic metres."""
    return 8 * float(np.prod(part.half)) * {"box": 1.0, "cylinder": np.pi / 4, "sphere": np.pi / 6}[part.kind]


def depth(one: Part, at: Frame, two: Part, there: Frame, enough: float) -> float:
    """Return by how many metres two primitives overlap, negative where apart; a bound of `enough` ends the search."""
    centre, other = at.turn @ one.at + at.at, there.turn @ two.at + there.at
    gap = other - centre
    if np.linalg.norm(gap) > np.linalg.norm(one.half) + np.linalg.norm(two.half):
        return -float("inf")

    def shadows(tried: Array) -> Array:
        return np.asarray(reach(one, at.turn, tried) + reach(two, there.turn, -tried) - tried @ gap)

    faces = np.concatenate([_normals(one, at.turn), _normals(two, there.turn)])
    best = float(np.minimum(shadows(faces), shadows(-faces)).min())
    if best <= enough:
        return best
    directions = np.concatenate([faces, -faces, *_directions(one, at.turn, two, there.turn, gap)])
    directions /= np.linalg.norm(directions, axis=1)[:, None]
    depths = shadows(directions)
    best, direction = float(depths.min()), directions[depths.argmin()]
    step = 0.05
    for _ in range(HALVINGS):
        if best <= enough:
            break
        around = direction + step * np.concatenate([np.eye(3), -np.eye(3)])
        around /= np.linalg.norm(around, axis=1)[:, None]
        depths = shadows(around)
        if depths.min() < best:
            best, direction = float(depths.min()), around[depths.argmin()]
        else:
            step /= 2
    return best


def _normals(part: Part, turn: Array) -> Array:
    """Return the normals of the faces of a turned body, of a primitive its axes."""
    return turn.T if part.hull is None else np.asarray(part.hull.normals @ turn.T)


def reach(part: Part, turn: Array, directions: Array) -> Array:
    """Return how far a turned body reaches from its centre along unit directions, shape (n,)."""
    local = directions @ turn
    if part.hull is not None:
        return np.asarray((local @ part.hull.corners.T).max(axis=1))
    if part.kind == "sphere":
        return np.full(len(directions), part.half[0])
    if part.kind == "cylinder":
        return np.asarray(np.abs(local[:, 2]) * part.half[2] + part.half[0] * np.hypot(local[:, 0], local[:, 1]))
    return np.asarray(np.abs(local) @ part.half)


def _directions(one: Part, turn: Array, two: Part, other: Array, gap: Array) -> Iterator[Array]:
    """Yield directions from the first to the second body, shape (n, 3), not yet of length one."""
    crossed = np.cross(turn.T[:, None], other.T[None]).reshape(-1, 3)
    crossed = crossed[(crossed**2).sum(axis=1) > 1e-12]
    yield crossed
    yield -crossed
    if np.linalg.norm(gap) > 0.0:
        yield gap[None]
    for body, frame in ((one, turn), (two, other)):
        if body.kind == "cylinder":
            yield np.cos(RING)[:, None] * frame[:, 0] + np.sin(RING)[:, None] * frame[:, 1]
    for ball, solid, frame, sign in ((one, two, other, -1), (two, one, turn, 1)):
        if ball.kind == "sphere":
            # From the nearest point of the other body to the centre of the ball.
            local = frame.T @ (sign * gap)
            outward = frame @ (local - _nearest(solid, local))
            if np.linalg.norm(outward) > 0.0:
                yield sign * outward[None]


def _nearest(part: Part, point: Array) -> Array:
    """Return the point of a body that is nearest to one in its own axes, of a hull of those spread over it."""
    if part.hull is not None:
        inside = part.hull.within(point[None])[0] > 0.0
        return point if inside else part.hull.points[np.linalg.norm(part.hull.points - point, axis=1).argmin()]
    if part.kind == "box":
        return np.clip(point, -part.half, part.half)
    if part.kind == "sphere":
        return np.asarray(point * min(1.0, part.half[0] / max(np.linalg.norm(point), 1e-12)))
    radius = min(1.0, part.half[0] / max(np.hypot(point[0], point[1]), 1e-12))
    return np.array([point[0] * radius, point[1] * radius, np.clip(point[2], -part.half[2], part.half[2])])


def clearance(part: Part, at: Frame, points: Array) -> Array:
    """Return the distances of points, shape (n, 3), to the surface of a body: negative within it.

    Outside of a hull it is that to the plane of the face that is farthest, which is no more.
    """
    local = (points - at.at) @ at.turn - part.at
    if part.hull is not None:
        return -part.hull.within(local)
    if part.kind == "sphere":
        return np.asarray(np.linalg.norm(local, axis=1) - part.half[0])
    if part.kind == "cylinder":
        beyond = np.column_stack([np.hypot(local[:, 0], local[:, 1]), np.abs(local[:, 2])]) - part.half[[0, 2]]
    else:
        beyond = np.abs(local) - part.half
    outside = np.linalg.norm(np.maximum(beyond, 0.0), axis=1)
    return np.asarray(outside + np.minimum(beyond.max(axis=1), 0.0))


def outlines_apart(one: Array, two: Array) -> float:
    """Return how far two convex outlines are apart: by separating axes where they meet, else from corners to edges."""
    edges = [np.roll(outline, -1, axis=0) - outline for outline in (one, two) if len(outline) > 1]
    if edges:
        ways = np.concatenate([*edges, *(-edge for edge in edges)])
        normals = ways[:, ::-1] * [1.0, -1.0] / np.linalg.norm(ways, axis=1)[:, None]
        apart = float((np.min(two @ normals.T, axis=0) - np.max(one @ normals.T, axis=0)).max())
        if apart <= 0.0:
            return apart
    gaps = [_to_edges(corner, two) for corner in one] + [_to_edges(corner, one) for corner in two]
    return min(gaps)


def outline_of(points: Array) -> Array:
    """Return the corners of the hull of points in the plane, counter-clockwise: the next has all others to its left."""
    points = np.unique(points.round(8), axis=0)
    outline = [points[0]]
    while True:
        ways = points - outline[-1]
        lengths = np.linalg.norm(ways, axis=1)
        best = int(lengths.argmax())
        for i in np.nonzero(lengths > 0.0)[0]:
            side = ways[best][0] * ways[i][1] - ways[best][1] * ways[i][0]
            if side < -1e-12 or (abs(side) <= 1e-12 and lengths[i] > lengths[best]):
                best = int(i)
        if not lengths.any() or np.array_equal(points[best], outline[0]):
            return np.array(outline)
        outline.append(points[best])


def _to_edges(point: Array, outline: Array) -> float:
    """Return the distance of a point from the nearest edge of an outline."""
    ways = np.roll(outline, -1, axis=0) - outline
    lengths = np.maximum((ways**2).sum(axis=1), 1e-300)
    shares = np.clip(((point - outline) * ways).sum(axis=1) / lengths, 0.0, 1.0)
    return float(np.linalg.norm(point - outline - shares[:, None] * ways, axis=1).min())


def surface(part: Part, spacing: float) -> Array:
    """Return points on a body from its own middle, shape (n, 3): edges of a box, rims and sides of a cylinder."""
    if part.hull is not None:
        return part.hull.points
    return _surface(part.kind, tuple(part.half.tolist()), spacing)


@lru_cache(maxsize=1 << 8)
def _surface(kind: str, half: tuple[float, float, float], spacing: float) -> Array:
    x, _, z = half
    if kind == "sphere":
        # A spiral of equal areas.
        rings = np.arange(int(16 * x * x / spacing**2) + 20) + 0.5
        height, angle = 1 - 2 * rings / len(rings), np.pi * (1 + np.sqrt(5)) * rings
        flat = np.sqrt(1 - height**2)
        return np.asarray(x * np.column_stack([flat * np.cos(angle), flat * np.sin(angle), height]))
    if kind == "cylinder":
        angles = np.linspace(0, 2 * np.pi, int(2 * np.pi * x / spacing) + 8, endpoint=False)
        heights = np.linspace(-z, z, int(2 * z / spacing) + 2)
        rim = x * np.column_stack([np.cos(angles), np.sin(angles)])
        return np.column_stack([np.tile(rim, (len(heights), 1)), np.repeat(heights, len(rim))])
    found = []
    for axis in range(3):
        along = np.linspace(-1, 1, int(2 * half[axis] / spacing) + 2)
        for one in (-1.0, 1.0):
            for two in (-1.0, 1.0):
                rows = np.empty((len(along), 3))
                rows[:, axis], rows[:, axis - 1], rows[:, axis - 2] = along, one, two
                found.append(rows * half)
    return np.concatenate(found)
