"""Volumes: the regions in which the subject of a predicate may be, from which positions are sampled uniformly."""

from __future__ import annotations

import math
from bisect import bisect_left
from collections.abc import Callable
from itertools import accumulate, pairwise
from typing import NamedTuple

from prag_asp.scene.boxes import Vector
from prag_asp.scene.forms import Outline
from prag_asp.scene.geometry import cut, inside_by, wrap

RING_TRIES = 20
EVERYWHERE = (-math.inf, -math.inf, -math.inf), (math.inf, math.inf, math.inf)


class Side(NamedTuple):
    """A half-plane in the x-y plane, ``a x + b y <= c`` with ``(a, b)`` of unit length; metres."""

    a: float
    b: float
    c: float


class Ring(NamedTuple):
    """The region between two distances from a point, or from an axis-aligned rectangle, in the x-y plane; metres.

    Both half-sides of the rectangle are positive, or both are 0.
    """

    x: float
    y: float
    inner: float
    outer: float
    half_x: float = 0.0
    half_y: float = 0.0

    def distance(self, x: float, y: float) -> float:
        """Return the distance of a position from the point or the rectangle in metres."""
        if self.half_x == 0.0:
            return math.hypot(x - self.x, y - self.y)
        return math.hypot(max(0.0, abs(x - self.x) - self.half_x), max(0.0, abs(y - self.y) - self.half_y))


class Yaws(NamedTuple):
    """A range of yaw angles: its centre and half its width, in radians."""

    centre: float
    half: float


class Volume(NamedTuple):
    """Where the subject of a predicate may be: a region for its centre, ranges of yaws, of widths, of openings.

    The region is what a box aligned with the world's axes, half planes, rings and, of each of the `unions`, at least
    one volume have in common, except for the `holes`, which are convex and counter-clockwise from above; the box is
    infinite if the predicate does not care, `yaws` is None then. Metres and radians; `width` belongs to the gripper,
    `opening` to the joint of furniture.
    """

    low: Vector = EVERYWHERE[0]
    high: Vector = EVERYWHERE[1]
    sides: tuple[Side, ...] = ()
    rings: tuple[Ring, ...] = ()
    yaws: tuple[Yaws, ...] | None = None
    width: tuple[float, float] = (0.0, math.inf)
    opening: tuple[float, float] = (0.0, math.inf)
    holes: tuple[Outline, ...] = ()
    unions: tuple[tuple[Volume, ...], ...] = ()

    @property
    def empty(self) -> bool:
        """Whether a range of numbers is empty; otherwise the region may still be empty for other reasons."""
        (ax, ay, az), (bx, by, bz) = self.low, self.high
        ranges = (self.width, self.opening)
        return ax > bx or ay > by or az > bz or any(low > high for low, high in ranges) or self.yaws == ()

    def meet(self, other: Volume) -> Volume:
        """Return the intersection with another volume."""
        (ax, ay, az), (bx, by, bz) = self.low, other.low
        (cx, cy, cz), (dx, dy, dz) = self.high, other.high
        return Volume(
            (max(ax, bx), max(ay, by), max(az, bz)),
            (min(cx, dx), min(cy, dy), min(cz, dz)),
            self.sides + other.sides,
            self.rings + other.rings,
            _meet_yaws(self.yaws, other.yaws),
            (max(self.width[0], other.width[0]), min(self.width[1], other.width[1])),
            (max(self.opening[0], other.opening[0]), min(self.opening[1], other.opening[1])),
            self.holes + other.holes,
            self.unions + other.unions,
        )

    def parts(self) -> tuple[Volume, ...]:
        """Return volumes without unions whose union is the region, without those known to be empty."""
        if not self.unions:
            return (self,)
        volumes = [self._replace(unions=())]
        for union in self.unions:
            met = (part.meet(each) for part in volumes for option in union for each in option.parts())
            volumes = [part for part in met if not part.empty]
        return tuple(volumes)

    def miss_distance(self, point: Vector) -> float:
        """Return the distance in metres by which a point misses the region, 0 within it."""
        x, y, _ = point
        missed = [low - value for low, value in zip(self.low, point, strict=True)]
        missed += [value - high for high, value in zip(self.high, point, strict=True)]
        missed += [side.a * x + side.b * y - side.c for side in self.sides]
        for ring in self.rings:
            distance = ring.distance(x, y)
            missed += [ring.inner - distance, distance - ring.outer]
        missed += [inside_by(hole, (x, y)) for hole in self.holes]
        missed += [min((option.miss_distance(point) for option in union), default=math.inf) for union in self.unions]
        return max(0.0, *missed)

    def floor(self, room: float = 0.0) -> Floor | None:
        """Return the region seen from above, without regard to its rings and holes; None if it is empty.

        A margin of `room` metres is kept from its borders, or a third of the box if that is less. The box has to be
        finite along x and y.
        """
        patches = [patch for part in self.parts() if (patch := part.patch(room)) is not None]
        return tuple(patches) if patches else None

    def patch(self, room: float) -> FloorPatch | None:
        """Return the polygon of a region without unions, seen from above; None if it is empty."""
        if self.empty:
            return None
        (ax, ay, _), (bx, by, _) = self.low, self.high
        dx, dy = min(room, (bx - ax) / 3), min(room, (by - ay) / 3)
        polygon: Outline = ((ax + dx, ay + dy), (bx - dx, ay + dy), (bx - dx, by - dy), (ax + dx, by - dy))
        for a, b, c in self.sides:
            polygon = cut(polygon, a, b, c - min(room, dx, dy))
        return _fan(self, polygon) if polygon else None

    @staticmethod
    def sample(floor: Floor, uniform: Callable[[float, float], float]) -> Vector | None:
        """Sample a point of a region uniformly over its `floor`; None if the rings and holes rejected all tries.

        The height is uniform over that of the region.
        """
        for _ in range(RING_TRIES):
            patch = floor[0] if len(floor) == 1 else _choose(floor, uniform)
            x, y = _inside(patch, uniform)
            if patch.volume.admits(x, y) and (len(floor) == 1 or _keeps(floor, x, y, uniform)):
                low, high = patch.volume.low[2], patch.volume.high[2]
                return (x, y, low if low == high else uniform(low, high))
        return None

    def admits(self, x: float, y: float) -> bool:
        """Return whether a position lies in all rings and in no hole."""
        for ring in self.rings:
            if not ring.inner <= ring.distance(x, y) <= ring.outer:
                return False
        for hole in self.holes:  # noqa: SIM110 (all() is slower here)
            if inside_by(hole, (x, y)) > 0.0:
                return False
        return True


class FloorPatch(NamedTuple):
    """A convex polygon to sample from, the cumulative areas of its triangle fan, and its volume; metres."""

    polygon: Outline
    areas: tuple[float, ...]
    volume: Volume


Floor = tuple[FloorPatch, ...]
"""A region seen from above, without regard to its rings and holes; its patches may overlap."""


def _fan(volume: Volume, polygon: Outline) -> FloorPatch:
    """Return a polygon with the areas of its triangle fan; below three corners, the last one is repeated."""
    polygon += (polygon[-1],) * (3 - len(polygon))
    (ax, ay), rest = polygon[0], polygon[1:]
    total, areas = 0.0, []
    for (bx, by), (cx, cy) in pairwise(rest):
        total += max(0.0, (bx - ax) * (cy - ay) - (by - ay) * (cx - ax)) / 2
        areas.append(total)
    return FloorPatch(polygon, tuple(areas), volume)


def _choose(floor: Floor, uniform: Callable[[float, float], float]) -> FloorPatch:
    """Sample one of several patches by area."""
    sums = list(accumulate(patch.areas[-1] for patch in floor))
    return floor[bisect_left(sums, uniform(0.0, sums[-1]), 0, len(floor) - 1)]


def _keeps(floor: Floor, x: float, y: float, uniform: Callable[[float, float], float]) -> bool:
    """Return whether to accept a position: one that lies in n patches is sampled n times too often."""
    patch_count = sum(inside_by(patch.polygon, (x, y)) >= 0.0 and patch.volume.admits(x, y) for patch in floor)
    return patch_count <= 1 or uniform(0.0, patch_count) <= 1.0


def _inside(patch: FloorPatch, uniform: Callable[[float, float], float]) -> tuple[float, float]:
    """Sample a point of a convex polygon uniformly: a triangle of its fan by area, then a point in it."""
    polygon, areas, _ = patch
    # Rounding errors fall to the last triangle.
    i = bisect_left(areas, uniform(0.0, areas[-1]), 0, len(areas) - 1)
    (ax, ay), (bx, by), (cx, cy) = polygon[0], polygon[i + 1], polygon[i + 2]
    s, t = uniform(0.0, 1.0), uniform(0.0, 1.0)
    if s + t > 1.0:
        s, t = 1.0 - s, 1.0 - t
    return ax + s * (bx - ax) + t * (cx - ax), ay + s * (by - ay) + t * (cy - ay)


def _meet_yaws(first: tuple[Yaws, ...] | None, second: tuple[Yaws, ...] | None) -> tuple[Yaws, ...] | None:
    """Return the pairwise intersections of ranges of yaws; None means unrestricted."""
    if first is None or second is None:
        return second if first is None else first
    ranges = []
    for one in first:
        for two in second:
            offset = wrap(two.centre - one.centre)
            low, high = max(-one.half, offset - two.half), min(one.half, offset + two.half)
            if low <= high:
                ranges.append(Yaws(one.centre + (low + high) / 2, (high - low) / 2))
    return tuple(ranges)


def turned_box(pose: tuple[Vector, tuple[float, float]], half: tuple[float, float]) -> tuple[Side, ...]:
    """Return the half-planes of a rectangle: `pose` is its centre, and the cosine and sine of its yaw."""
    (x, y, _), (cosine, sine) = pose
    along, across = cosine * x + sine * y, cosine * y - sine * x
    return (
        Side(cosine, sine, along + half[0]),
        Side(-cosine, -sine, half[0] - along),
        Side(-sine, cosine, across + half[1]),
        Side(sine, -cosine, half[1] - across),
    )
