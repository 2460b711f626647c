"""Volumes: where the subject of a predicate may be, as a region to draw places from exactly."""

from __future__ import annotations

import math
from bisect import bisect_left
from collections.abc import Callable
from itertools import pairwise
from typing import NamedTuple

from prag_asp.physics.geometry import Outline, Vector, cut, inside_by, wrap

RING_TRIES = 20
EVERYWHERE = (-math.inf, -math.inf, -math.inf), (math.inf, math.inf, math.inf)


class Side(NamedTuple):
    """A half plane of the plane seen from above, ``a x + b y <= c`` with ``(a, b)`` of unit length; metres."""

    a: float
    b: float
    c: float


class Floor(NamedTuple):
    """A convex polygon, and the areas of the triangles of its fan summed up; metres."""

    polygon: Outline
    areas: tuple[float, ...]


class Ring(NamedTuple):
    """What lies between two circles around a point, seen from above; metres."""

    x: float
    y: float
    inner: float
    outer: float


class Volume(NamedTuple):
    """Where the subject of a predicate may be: a region for its centre, a range of yaws, of widths, of openings.

    The region is what a box aligned with the world's axes, half planes and rings have in common; the box is
    infinite where the predicate does not care, and the centre is in none of the `holes`, which are convex and
    counter-clockwise from above. Metres and radians; `yaw` is a centre and a half width, `width` belongs to the
    gripper, `opening` to the joint of furniture.
    """

    low: Vector = EVERYWHERE[0]
    high: Vector = EVERYWHERE[1]
    sides: tuple[Side, ...] = ()
    rings: tuple[Ring, ...] = ()
    yaw: tuple[float, float] | None = None
    width: tuple[float, float] = (0.0, math.inf)
    opening: tuple[float, float] = (0.0, math.inf)
    holes: tuple[Outline, ...] = ()

    @property
    def empty(self) -> bool:
        """Tell whether a range of numbers is empty; where none is, half planes and rings may still leave nothing."""
        (ax, ay, az), (bx, by, bz) = self.low, self.high
        return (
            ax > bx
            or ay > by
            or az > bz
            or self.width[0] > self.width[1]
            or self.opening[0] > self.opening[1]
            or (self.yaw is not None and self.yaw[1] < 0.0)
        )

    def meet(self, other: Volume) -> Volume:
        """Return what both volumes allow; of two ranges of yaws the part of the first within the second."""
        (ax, ay, az), (bx, by, bz) = self.low, other.low
        (cx, cy, cz), (dx, dy, dz) = self.high, other.high
        return Volume(
            (max(ax, bx), max(ay, by), max(az, bz)),
            (min(cx, dx), min(cy, dy), min(cz, dz)),
            self.sides + other.sides,
            self.rings + other.rings,
            _meet_yaws(self.yaw, other.yaw),
            (max(self.width[0], other.width[0]), min(self.width[1], other.width[1])),
            (max(self.opening[0], other.opening[0]), min(self.opening[1], other.opening[1])),
            self.holes + other.holes,
        )

    def outside(self, point: Vector) -> float:
        """Return by how many metres a point misses the region, 0 within it."""
        x, y, _ = point
        missed = [low - value for low, value in zip(self.low, point, strict=True)]
        missed += [value - high for high, value in zip(self.high, point, strict=True)]
        missed += [side.a * x + side.b * y - side.c for side in self.sides]
        for ring in self.rings:
            radius = math.hypot(x - ring.x, y - ring.y)
            missed += [ring.inner - radius, radius - ring.outer]
        missed += [inside_by(hole, (x, y)) for hole in self.holes]
        return max(0.0, *missed)

    def floor(self, room: float = 0.0) -> Floor | None:
        """Return the region from above, but for its rings and holes, None where nothing is left.

        `room` metres are kept off its borders, or a third of the box where it is narrow. The box has to be
        finite along x and y.
        """
        if self.empty:
            return None
        (ax, ay, _), (bx, by, _) = self.low, self.high
        dx, dy = min(room, (bx - ax) / 3), min(room, (by - ay) / 3)
        polygon: Outline = ((ax + dx, ay + dy), (bx - dx, ay + dy), (bx - dx, by - dy), (ax + dx, by - dy))
        for a, b, c in self.sides:
            polygon = cut(polygon, a, b, c - min(room, dx, dy))
        return _fan(polygon) if polygon else None

    def draw(self, floor: Floor, uniform: Callable[[float, float], float]) -> Vector | None:
        """Draw a point of the region over its `floor` uniformly; None where the rings and holes leave none.

        Where the region has a height the point is drawn from all of it.
        """
        for _ in range(RING_TRIES):
            x, y = _inside(floor, uniform)
            if self._in_rings(x, y):
                low, high = self.low[2], self.high[2]
                return (x, y, low if low == high else uniform(low, high))
        return None

    def _in_rings(self, x: float, y: float) -> bool:
        """Tell whether a point lies in all rings and in no hole."""
        for ring in self.rings:
            if not ring.inner <= math.hypot(x - ring.x, y - ring.y) <= ring.outer:
                return False
        for hole in self.holes:  # noqa: SIM110 (all() is slower here)
            if inside_by(hole, (x, y)) > 0.0:
                return False
        return True


def _fan(polygon: Outline) -> Floor:
    """Return a polygon of at least three corners (the last one repeated where there are fewer) with its areas."""
    polygon += (polygon[-1],) * (3 - len(polygon))
    (ax, ay), rest = polygon[0], polygon[1:]
    total, areas = 0.0, []
    for (bx, by), (cx, cy) in pairwise(rest):
        total += max(0.0, (bx - ax) * (cy - ay) - (by - ay) * (cx - ax)) / 2
        areas.append(total)
    return Floor(polygon, tuple(areas))


def _inside(floor: Floor, uniform: Callable[[float, float], float]) -> tuple[float, float]:
    """Draw a point of a convex polygon uniformly: a triangle of its fan by area, then a point in that."""
    polygon, areas = floor
    # The last triangle takes what rounding leaves over.
    i = bisect_left(areas, uniform(0.0, areas[-1]), 0, len(areas) - 1)
    (ax, ay), (bx, by), (cx, cy) = polygon[0], polygon[i + 1], polygon[i + 2]
    s, t = uniform(0.0, 1.0), uniform(0.0, 1.0)
    if s + t > 1.0:
        s, t = 1.0 - s, 1.0 - t
    return ax + s * (bx - ax) + t * (cx - ax), ay + s * (by - ay) + t * (cy - ay)


def _meet_yaws(first: tuple[float, float] | None, second: tuple[float, float] | None) -> tuple[float, float] | None:
    """Return the common part of two ranges of yaws, each a centre and a half width in radians."""
    if first is None or second is None:
        return first or second
    offset = wrap(second[0] - first[0])
    low, high = max(-first[1], offset - second[1]), min(first[1], offset + second[1])
    return (first[0] + (low + high) / 2, (high - low) / 2)


def turned_box(pose: tuple[Vector, tuple[float, float]], half: tuple[float, float]) -> tuple[Side, ...]:
    """Return the half planes of a rectangle seen from above: its centre, the cosine and sine of its yaw, its halves."""
    (x, y, _), (cosine, sine) = pose
    along, across = cosine * x + sine * y, cosine * y - sine * x
    return (
        Side(cosine, sine, along + half[0]),
        Side(-cosine, -sine, half[0] - along),
        Side(-sine, cosine, across + half[1]),
        Side(sine, -cosine, half[1] - across),
    )
