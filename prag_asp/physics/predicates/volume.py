"""Volumes: regions of possible positions of a predicate's subject, from which positions are sampled uniformly."""

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
"""The maximum number of positions that are sampled to find one that is in the rings and not in the holes."""

EVERYWHERE = (-math.inf, -math.inf, -math.inf), (math.inf, math.inf, math.inf)


class Side(NamedTuple):
    """A half-plane in the x-y plane, ``a x + b y <= c`` in metres, with ``(a, b)`` of unit length."""

    a: float
    b: float
    c: float


class Ring(NamedTuple):
    """The region between two distances from a point or an axis-aligned rectangle in the x-y plane, in metres.

    The half-extents of the rectangle are both positive; those of a point are 0.
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
    """A region for the centre of a predicate's subject with ranges of its yaw, or a range for a gripper or furniture.

    The region is the intersection of an axis-aligned box from `low` to `high`, half-planes, rings, and, for each of the
    `unions`, the union of its volumes, minus the `holes`, whose outlines are convex and counter-clockwise seen from
    above. By default, the region is infinite; if `yaws` is None, yaws are unrestricted. `width` is the range of a
    gripper's width, and `opening` is the range of the joint of furniture. Units are metres and radians.
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
        """Whether the box or a range is empty; a region may also be empty for other reasons."""
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

    def moved(self, offset: Vector) -> Volume:
        """Return the region moved by an offset in metres."""
        dx, dy, dz = offset
        if dx == dy == dz == 0.0:
            return self
        (ax, ay, az), (bx, by, bz) = self.low, self.high
        return self._replace(
            low=(ax + dx, ay + dy, az + dz),
            high=(bx + dx, by + dy, bz + dz),
            sides=tuple(side._replace(c=side.c + side.a * dx + side.b * dy) for side in self.sides),
            rings=tuple(ring._replace(x=ring.x + dx, y=ring.y + dy) for ring in self.rings),
            holes=tuple(tuple((x + dx, y + dy) for x, y in hole) for hole in self.holes),
            unions=tuple(tuple(option.moved(offset) for option in union) for union in self.unions),
        )

    def parts(self) -> tuple[Volume, ...]:
        """Return volumes without unions whose union is this volume; volumes known to be empty are omitted."""
        if not self.unions:
            return (self,)
        volumes = [self._replace(unions=())]
        for union in self.unions:
            met = (part.meet(each) for part in volumes for option in union for each in option.parts())
            volumes = [part for part in met if not part.empty]
        return tuple(volumes)

    def miss_distance(self, point: Vector) -> float:
        """Return the largest violation, in metres, of the region's constraints at a point, or 0 within the region."""
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
        """Return the region seen from above, ignoring its rings and holes, or None if it is empty.

        The result keeps a margin of `room` metres from the borders, or of a third of the box if that is less. The box
        has to be finite along x and y.
        """
        patches = [patch for part in self.parts() if (patch := part.patch(room)) is not None]
        return tuple(patches) if patches else None

    def patch(self, room: float) -> FloorPatch | None:
        """Return the polygon of a region without unions, seen from above, or None if it is empty."""
        if self.empty:
            return None
        (ax, ay, _), (bx, by, _) = self.low, self.high
        dx, dy = min(room, (bx - ax) / 3), min(room, (by - ay) / 3)
        polygon: Outline = ((ax + dx, ay + dy), (bx - dx, ay + dy), (bx - dx, by - dy), (ax + dx, by - dy))
        for a, b, c in self.sides:
            polygon = cut(polygon, a, b, c - min(room, dx, dy))
        if not polygon:
            return None
        polygon += (polygon[-1],) * (3 - len(polygon))  # the triangles of a point or a segment have no area
        (ax, ay), rest = polygon[0], polygon[1:]
        areas = (max(0.0, (bx - ax) * (cy - ay) - (by - ay) * (cx - ax)) / 2 for (bx, by), (cx, cy) in pairwise(rest))
        return FloorPatch(polygon, tuple(accumulate(areas)), self)

    @staticmethod
    def sample(floor: Floor, uniform: Callable[[float, float], float]) -> Vector | None:
        """Return a position sampled uniformly over a `floor`, or None if the rings and holes reject all tries."""
        sums = list(accumulate(patch.areas[-1] for patch in floor))
        for _ in range(RING_TRIES):
            patch = floor[0]
            if len(floor) > 1:
                patch = floor[bisect_left(sums, uniform(0.0, sums[-1]), 0, len(floor) - 1)]
            x, y = patch.sample(uniform)
            if not patch.volume.admits(x, y):
                continue
            if len(floor) > 1:
                # A position that lies in n patches is sampled n times too often.
                count = sum(inside_by(each.polygon, (x, y)) >= 0.0 and each.volume.admits(x, y) for each in floor)
                if count > 1 and uniform(0.0, count) > 1.0:
                    continue
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
    """A convex polygon, in metres, to sample from, with the cumulative areas of its triangle fan, and its volume."""

    polygon: Outline
    areas: tuple[float, ...]
    volume: Volume

    def sample(self, uniform: Callable[[float, float], float]) -> tuple[float, float]:
        """Sample a point of the polygon uniformly: first a triangle of the fan by area, then a point inside it."""
        # The last triangle absorbs rounding errors.
        i = bisect_left(self.areas, uniform(0.0, self.areas[-1]), 0, len(self.areas) - 1)
        (ax, ay), (bx, by), (cx, cy) = self.polygon[0], self.polygon[i + 1], self.polygon[i + 2]
        s, t = uniform(0.0, 1.0), uniform(0.0, 1.0)
        if s + t > 1.0:
            s, t = 1.0 - s, 1.0 - t
        return ax + s * (bx - ax) + t * (cx - ax), ay + s * (by - ay) + t * (cy - ay)


Floor = tuple[FloorPatch, ...]
"""A region seen from above, ignoring its rings and holes, as patches that may overlap."""


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


def over_rectangle(
    centre: Vector, heading: tuple[float, float], half: tuple[float, float], heights: tuple[float, float]
) -> Volume:
    """Return the region between two heights over a rectangle; `heading` is the cosine and sine of its yaw."""
    (x, y, _), (cosine, sine), (dx, dy), (low, high) = centre, heading, half, heights
    reach_x, reach_y = abs(cosine) * dx + abs(sine) * dy, abs(sine) * dx + abs(cosine) * dy
    sides = turned_box((centre, heading), half)
    return Volume((x - reach_x, y - reach_y, low), (x + reach_x, y + reach_y, high), sides=sides)


def over_polygon(polygon: Outline, margin: float, heights: tuple[float, float]) -> Volume:
    """Return the region between two heights over a convex counter-clockwise polygon, with a margin to its border.

    The margin, in metres, is at most half the distance from the mean of the corners to the border.
    """
    xs, ys = zip(*polygon, strict=True)
    margin = max(0.0, min(margin, inside_by(polygon, (sum(xs) / len(xs), sum(ys) / len(ys))) / 2))
    sides = []
    for (ax, ay), (bx, by) in zip(polygon, polygon[1:] + polygon[:1], strict=True):
        length = math.dist((ax, ay), (bx, by))
        if length > 0.0:
            a, b = (by - ay) / length, (ax - bx) / length
            sides.append(Side(a, b, a * ax + b * ay - margin))
    return Volume((min(xs), min(ys), heights[0]), (max(xs), max(ys), heights[1]), sides=tuple(sides))


def opposite(vector: Vector) -> Vector:
    """Return a vector with the opposite direction and the same length."""
    return (-vector[0], -vector[1], -vector[2])


def turned_box(pose: tuple[Vector, tuple[float, float]], half: tuple[float, float]) -> tuple[Side, ...]:
    """Return the half-planes that bound a rectangle; `pose` is its centre, and the cosine and sine of its yaw."""
    (x, y, _), (cosine, sine) = pose
    along, across = cosine * x + sine * y, cosine * y - sine * x
    return (
        Side(cosine, sine, along + half[0]),
        Side(-cosine, -sine, half[0] - along),
        Side(-sine, cosine, across + half[1]),
        Side(sine, -cosine, half[1] - across),
    )
