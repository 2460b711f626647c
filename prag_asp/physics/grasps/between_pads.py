"""Compute the width of a primitive between two pads, in closed form.

The pads sweep a prism along the tool's y axis, whose cross-section is a rectangle in x and z. A primitive is convex, so
the part of it in the prism begins and ends at extreme points along y: corners, stationary points of its edges and
sides, and their intersections with the sides and edges of the prism. All of these are enumerated.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from functools import cache
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
    @cache
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
    (x, y, z), (qx, qy, qz, qw) = place
    back = (-qx, -qy, -qz, qw)
    nearest = (min(max(x, window.x[0]), window.x[1]), min(max(z, window.z[0]), window.z[1]))
    if shape.kind == "sphere":
        aside = math.dist(nearest, (x, z))
        return whole if aside <= ON_SIDE else 2 * math.sqrt(max(0.0, shape.half[0] ** 2 - aside * aside))
    half, is_round = shape.half, shape.kind == "cylinder"
    most = whole if is_round else min(whole, _between_faces(half, pose, window, opening))
    on_line = _on_line_in_cylinder if is_round else _on_line_in_box
    way = rotate(back, AXES[1])
    low, high = on_line(half, way, rotate(back, (nearest[0] - x, 0.0, nearest[1] - z)))
    if high - low >= most - AGREEMENT:
        return most
    ends = (_ends_of_cylinder if is_round else _ends_of_box)(half, place, window)
    for side, height in product(window.x, window.z):
        low, high = on_line(half, way, rotate(back, (side - x, 0.0, height - z)))
        if low <= high:
            ends += (y + low, y + high)
    return max(ends) - min(ends) if ends else 0.0


def _between_faces(own_half: Vector, pose: Pose, window: PadWindow, opening: Vector) -> float:
    """Return the width, along an axis, of the strip between the two faces of a box that are nearest to the pads.

    The box may be turned about the direction of the fingers, or about the pads' other axis, along which the pads are
    about as long.
    """
    x, y, z, w = pose.quaternion
    slopes = [max(abs(slope), PARALLEL) for slope in rotate((-x, -y, -z, w), opening)]
    half, cosine = min(zip(own_half, slopes, strict=True), key=lambda side: side[0] / side[1])
    return (2 * half + (window.x[1] - window.x[0]) * math.sqrt(max(0.0, 1.0 - cosine**2))) / cosine


def _on_line_in_box(half: Vector, way: Vector, start: Vector) -> Interval:
    """Return the interval in which a line is in a box, as distances from a point of the line; empty if low > high.

    `way` is the direction of the line and `start` is the point, both in the frame of the box.
    """
    (half_x, half_y, half_z), (way_x, way_y, way_z), (start_x, start_y, start_z) = half, way, start
    low, high = _within(start_x, way_x, -half_x, half_x, -math.inf, math.inf)
    low, high = _within(start_y, way_y, -half_y, half_y, low, high)
    return _within(start_z, way_z, -half_z, half_z, low, high)


def _on_line_in_cylinder(half: Vector, way: Vector, start: Vector) -> Interval:
    """Return the interval in which a line is in a cylinder, as `_on_line_in_box` does for a box."""
    start_x, start_y, start_z = start
    low, high = _within(start_z, way[2], -half[2], half[2], -math.inf, math.inf)
    # |start + t way| = radius across the axis: a t² + 2 b t + c = 0.
    a, b = way[0] ** 2 + way[1] ** 2, way[0] * start_x + way[1] * start_y
    c = start_x**2 + start_y**2 - half[0] ** 2
    if a <= PARALLEL**2:
        return (low, high) if c <= 0.0 else NOTHING
    if b * b < a * c:
        return NOTHING
    root = math.sqrt(b * b - a * c)
    return max(low, (-b - root) / a), min(high, (root - b) / a)


def _ends_of_box(half: Vector, place: Pose, window: PadWindow) -> list[float]:
    """Return the y values at the ends of those sections of a box's edges that lie between the pads."""
    (x, y, z), (low_x, high_x), (low_z, high_z) = place.position, *window
    sides, ends = [rotate(place.quaternion, axis) for axis in AXES], list[float]()
    for axis, one, two in ((0, 1, 2), (1, 0, 2), (2, 0, 1)):
        (ax, ay, az), (bx, by, bz), (cx, cy, cz), long = sides[axis], sides[one], sides[two], half[axis]
        for i in (half[one], -half[one]):
            for k in (half[two], -half[two]):
                low, high = _within(x + i * bx + k * cx, ax, low_x, high_x, -long, long)
                if low <= high:
                    low, high = _within(z + i * bz + k * cz, az, low_z, high_z, low, high)
                    if low <= high:
                        begin = y + i * by + k * cy
                        ends += (begin + low * ay, begin + high * ay)
    return ends


def _within(begin: float, slope: float, least: float, most: float, low: float, high: float) -> Interval:
    """Return the part of an interval of t where ``begin + slope * t`` is between two ends; empty if low > high."""
    if -PARALLEL <= slope <= PARALLEL:
        return (low, high) if least - ON_SIDE <= begin <= most + ON_SIDE else NOTHING
    if slope < 0.0:
        first, last = (most - begin) / slope, (least - begin) / slope
    else:
        first, last = (least - begin) / slope, (most - begin) / slope
    # An environment calls this about 30 times per step; max() and min() would be slower.
    return first if first > low else low, last if last < high else high


def _ends_of_cylinder(half: Vector, place: Pose, window: PadWindow) -> list[float]:
    """Return y at stationary points on a cylinder's rims and side, and where these intersect the prism's sides."""
    (radius, _, long), axis, centre = half, rotate(place.quaternion, AXES[2]), place.position
    (low_x, high_x), (low_z, high_z) = ((low - ON_SIDE, high + ON_SIDE) for low, high in window)
    # The rims of a standing cylinder are far above and below the pads.
    rise = radius * math.sqrt(max(0.0, 1.0 - axis[2] * axis[2])) + AGREEMENT
    rims = [along for along in (-long, long) if low_z - rise <= centre[2] + along * axis[2] <= high_z + rise]
    points = chain(
        _extremes(radius, rims, axis, centre) if rims else (),
        _on_planes(radius, long, rims, axis, centre, window),
    )
    return [y for x, y, z in points if low_x <= x <= high_x and low_z <= z <= high_z]


def _extremes(radius: float, rims: Sequence[float], axis: Vector, centre: Vector) -> Iterator[Vector]:
    """Yield the first and last point of each rim along y, or the rim's centre if the axis is parallel to y."""
    outward = _unit_across(axis, 1)
    for end in [_point(centre, along, axis) for along in rims]:
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


def _on_planes(
    radius: float, long: float, rims: Sequence[float], axis: Vector, centre: Vector, window: PadWindow
) -> Iterator[Vector]:
    """Yield the points of a cylinder's rims in the prism's sides, and the ends, along y, of its curve in each side."""
    for k in (0, 2):
        to = _unit_across(axis, k) if rims else None
        if to is not None and to[k] > 0.0:  # 0 because of rounding where rims are almost parallel to the plane
            (a, b, c), (d, e, f) = axis, to
            side = (b * f - c * e, c * d - a * f, a * e - b * d)
            for plane, along in product(window[k // 2], rims):
                cosine = (plane - centre[k] - along * axis[k]) / (radius * to[k])
                if abs(cosine) <= 1.0:
                    out = _point(_point(centre, along, axis), radius * cosine, to)
                    sine = math.sqrt(1.0 - cosine * cosine)
                    yield _point(out, -radius * sine, side)
                    yield _point(out, radius * sine, side)
        if abs(axis[k]) > PARALLEL:
            # There, the normal of the side is a combination of y and the normal of the plane.
            length, normal = math.hypot(axis[k], axis[1]), [0.0, axis[k], 0.0]
            normal[k] = -axis[1]
            for plane, share in product(window[k // 2], (-radius / length, radius / length)):
                along = (plane - centre[k] - share * normal[k]) / axis[k]
                if abs(along) <= long:
                    yield _point(_point(centre, along, axis), share, (normal[0], normal[1], normal[2]))
