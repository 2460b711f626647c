"""Compute the width of a primitive between two pads, in closed form.

The pads sweep a prism along the tool's y axis, whose cross-section is a rectangle in x and z. A primitive is convex, so
the part of it in the prism begins and ends at extreme points along y: corners, stationary points of its edges and
sides, and their intersections with the sides and edges of the prism. All of these are enumerated.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from itertools import chain, product
from typing import NamedTuple

from prag_asp.scene.boxes import Vector
from prag_asp.scene.geometry import Pose, compose, invert, rotate, width_along
from prag_asp.scene.robots import Robot
from prag_asp.scene.scene import Shape

PARALLEL = 1e-12
"""The sine of an angle below which two directions are parallel."""

ON_SIDE = 1e-12
"""The distance in metres from the prism below which a point counts as inside it, because of rounding."""

AGREEMENT = 1e-9
"""The difference in metres between a lower and an upper bound on the width below which the upper bound is returned."""

AXES: tuple[Vector, Vector, Vector] = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))

Interval = tuple[float, float]

NOTHING: Interval = (math.inf, -math.inf)


class PadWindow(NamedTuple):
    """The rectangle that a pad covers, in the frame of the tool: the intervals of x and z, in metres."""

    x: Interval
    z: Interval

    @staticmethod
    def of(robot: Robot) -> PadWindow:
        """Return the window of the pads of a robot."""
        width, _, height = robot.finger_boxes[0].size
        return PadWindow((-width / 2, width / 2), (robot.fingertip - height, robot.fingertip))


def width_between(shape: Shape, pose: Pose, window: PadWindow, tool: Pose) -> float:
    """Return the width in metres, along the tool's y axis, of the part of a primitive between the pads; or 0.

    A shape that is neither a cylinder nor a ball is treated as the box around it.
    """
    opening = rotate(tool.quaternion, AXES[1])
    whole = width_along(shape, pose.quaternion, opening)
    place = compose(invert(tool), pose)
    x, _, z = place.position
    nearest = (min(max(x, window.x[0]), window.x[1]), min(max(z, window.z[0]), window.z[1]))
    if shape.kind == "sphere":
        aside = math.dist(nearest, (x, z))
        return whole if aside <= ON_SIDE else 2 * math.sqrt(max(0.0, shape.half[0] ** 2 - aside * aside))
    most = whole if shape.kind == "cylinder" else min(whole, _between_faces(shape, pose, window, opening))
    way = _direction_across(place)
    low, high = _on_line(shape, place, way, nearest)
    if high - low >= most - AGREEMENT:
        return most
    ends = list(
        _ends_of_cylinder(shape, place, window) if shape.kind == "cylinder" else _ends_of_box(shape, place, window)
    )
    for line in product(window.x, window.z):
        low, high = _on_line(shape, place, way, line)
        if low <= high:
            ends += (place.position[1] + low, place.position[1] + high)
    return max(ends) - min(ends) if ends else 0.0


def _between_faces(shape: Shape, pose: Pose, window: PadWindow, opening: Vector) -> float:
    """Return the width, along an axis, of the strip between the two faces of a box that are nearest to the pads.

    The box may be turned about the direction of the fingers, or about the pads' other axis, along which the pads are
    about as long.
    """
    x, y, z, w = pose.quaternion
    slopes = [max(abs(slope), PARALLEL) for slope in rotate((-x, -y, -z, w), opening)]
    half, cosine = min(zip(shape.half, slopes, strict=True), key=lambda side: side[0] / side[1])
    return (2 * half + (window.x[1] - window.x[0]) * math.sqrt(max(0.0, 1.0 - cosine**2))) / cosine


def _direction_across(place: Pose) -> Vector:
    """Return the y axis of the tool in the frame of a body."""
    x, y, z, w = place.quaternion
    return rotate((-x, -y, -z, w), AXES[1])


def _on_line(shape: Shape, place: Pose, way: Vector, line: tuple[float, float]) -> Interval:
    """Return the interval in which a line along y, at a given x and z, is in a body; it is empty if low > high.

    `line` holds the x and z, in the frame of the tool, and `way` is the direction of the line in the frame of the body.
    The interval is relative to the y of the body's centre.
    """
    half, (x, y, z, w) = shape.half, place.quaternion
    start = rotate((-x, -y, -z, w), (line[0] - place.position[0], 0.0, line[1] - place.position[2]))
    low, high = -math.inf, math.inf
    straight = (2,) if shape.kind == "cylinder" else (0, 1, 2)
    for k in straight:
        low, high = _within(start[k], way[k], (-half[k], half[k]), low, high)
    if shape.kind == "cylinder":
        # |start + t way| = radius across the axis: a t² + 2 b t + c = 0.
        a, b = way[0] ** 2 + way[1] ** 2, way[0] * start[0] + way[1] * start[1]
        c = start[0] ** 2 + start[1] ** 2 - half[0] ** 2
        if a <= PARALLEL**2:
            return (low, high) if c <= 0.0 else NOTHING
        if b * b < a * c:
            return NOTHING
        root = math.sqrt(b * b - a * c)
        low, high = max(low, (-b - root) / a), min(high, (root - b) / a)
    return low, high


def _ends_of_box(shape: Shape, place: Pose, window: PadWindow) -> Iterator[float]:
    """Yield the y values at the ends of those sections of a box's edges that lie between the pads."""
    half = shape.half
    sides = [rotate(place.quaternion, axis) for axis in AXES]
    x, y, z = place.position
    for axis, (one, two) in enumerate(((1, 2), (0, 2), (0, 1))):
        (ax, ay, az), (bx, by, bz), (cx, cy, cz) = sides[axis], sides[one], sides[two]
        for i, k in product((half[one], -half[one]), (half[two], -half[two])):
            begin_x, begin_z = x + i * bx + k * cx, z + i * bz + k * cz
            low, high = _within(begin_x, ax, window.x, -half[axis], half[axis])
            if low <= high:
                low, high = _within(begin_z, az, window.z, low, high)
            if low <= high:
                begin = y + i * by + k * cy
                yield begin + low * ay
                yield begin + high * ay


def _within(begin: float, slope: float, ends: Interval, low: float, high: float) -> Interval:
    """Return the part of an interval of t where ``begin + slope * t`` is between two ends; empty if low > high."""
    if abs(slope) <= PARALLEL:
        return (low, high) if ends[0] - ON_SIDE <= begin <= ends[1] + ON_SIDE else NOTHING
    first, last = (ends[0] - begin) / slope, (ends[1] - begin) / slope
    if slope < 0.0:
        first, last = last, first
    # An environment calls this about 30 times per step; max() and min() would be slower.
    return first if first > low else low, last if last < high else high


def _ends_of_cylinder(shape: Shape, place: Pose, window: PadWindow) -> Iterator[float]:
    """Yield y at stationary points on a cylinder's rims and side, and where these intersect the prism's sides."""
    radius, _, long = shape.half
    axis = rotate(place.quaternion, AXES[2])
    points = chain(
        _extremes(radius, long, axis, place.position), _on_planes(radius, long, axis, place.position, window)
    )
    (low_x, high_x), (low_z, high_z) = ((low - ON_SIDE, high + ON_SIDE) for low, high in window)
    yield from (y for x, y, z in points if low_x <= x <= high_x and low_z <= z <= high_z)


def _extremes(radius: float, long: float, axis: Vector, centre: Vector) -> Iterator[Vector]:
    """Yield the first and last point of each rim along y, or the rim's centre if the axis is parallel to y."""
    outward = _unit_across(axis, 1)
    for end in (_point(centre, -long, axis), _point(centre, long, axis)):
        yield from (end,) if outward is None else (_point(end, -radius, outward), _point(end, radius, outward))


def _unit_across(axis: Vector, k: int) -> Vector | None:
    """Return the unit vector of the component of axis k perpendicular to an axis, or None if they are parallel."""
    (ax, ay, az), (bx, by, bz), along = axis, AXES[k], axis[k]
    x, y, z = bx - along * ax, by - along * ay, bz - along * az
    length = math.hypot(x, y, z)
    return (x / length, y / length, z / length) if length > PARALLEL else None


def _point(start: Vector, far: float, way: Vector) -> Vector:
    """Return the point at a distance from a given point along a vector."""
    return start[0] + far * way[0], start[1] + far * way[1], start[2] + far * way[2]


def _on_planes(radius: float, long: float, axis: Vector, centre: Vector, window: PadWindow) -> Iterator[Vector]:
    """Yield the points of a cylinder's rims in the prism's sides, and the ends, along y, of its curve in each side."""
    for k, plane in ((0, window.x[0]), (0, window.x[1]), (2, window.z[0]), (2, window.z[1])):
        left = plane - centre[k]
        to = _unit_across(axis, k)
        if to is not None and to[k] > 0.0:  # 0 because of rounding where rims are almost parallel to the plane
            (a, b, c), (d, e, f) = axis, to
            side = (b * f - c * e, c * d - a * f, a * e - b * d)
            for along in (-long, long):
                cosine = (left - along * axis[k]) / (radius * to[k])
                if abs(cosine) <= 1.0:
                    out = _point(_point(centre, along, axis), radius * cosine, to)
                    sine = math.sqrt(1.0 - cosine * cosine)
                    yield _point(out, -radius * sine, side)
                    yield _point(out, radius * sine, side)
        if abs(axis[k]) > PARALLEL:
            # There, the normal of the side is a combination of y and the normal of the plane.
            length, normal = math.hypot(axis[k], axis[1]), [0.0, axis[k], 0.0]
            normal[k] = -axis[1]
            for share in (-radius / length, radius / length):
                along = (left - share * normal[k]) / axis[k]
                if abs(along) <= long:
                    yield _point(_point(centre, along, axis), share, (normal[0], normal[1], normal[2]))
