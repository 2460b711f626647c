"""Poses, bounding boxes and convex outlines as plain tuples, which are faster than arrays at this size.

Lengths are metres; quaternions are x, y, z, w as in PyBullet; z points up.
"""

from __future__ import annotations

import math
from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from prag_asp.scene.boxes import Vector
from prag_asp.scene.forms import Outline, Point
from prag_asp.scene.scene import Shape

Quaternion = tuple[float, float, float, float]

IDENTITY: Quaternion = (0.0, 0.0, 0.0, 1.0)
AXES: tuple[Vector, Vector, Vector] = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))


class Pose(NamedTuple):
    """A position in metres and an orientation as a unit quaternion."""

    position: Vector
    quaternion: Quaternion = IDENTITY


def yaw_quaternion(yaw: float) -> Quaternion:
    """Return the rotation by `yaw` radians about z."""
    return (0.0, 0.0, math.sin(yaw / 2), math.cos(yaw / 2))


def yaw_of(quaternion: Quaternion) -> float:
    """Return the heading of the body's x axis in radians, in (-pi, pi]."""
    x, y, z, w = quaternion
    return math.atan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z))


def wrap(angle: float) -> float:
    """Return an angle in radians wrapped to [-pi, pi)."""
    return (angle + math.pi) % (2 * math.pi) - math.pi


def multiply(first: Quaternion, second: Quaternion) -> Quaternion:
    """Return the rotation that applies `second` and then `first`."""
    ax, ay, az, aw = first
    bx, by, bz, bw = second
    return (
        aw * bx + ax * bw + ay * bz - az * by,
        aw * by - ax * bz + ay * bw + az * bx,
        aw * bz + ax * by - ay * bx + az * bw,
        aw * bw - ax * bx - ay * by - az * bz,
    )


def turn_between(first: Quaternion, second: Quaternion) -> float:
    """Return the angle between two rotations in radians."""
    x, y, z, w = first
    return 2 * math.acos(min(1.0, abs(multiply((-x, -y, -z, w), second)[3])))


def rotate(quaternion: Quaternion, vector: Vector) -> Vector:
    """Return a vector turned by a rotation."""
    x, y, z, w = quaternion
    vx, vy, vz = vector
    tx, ty, tz = 2 * (y * vz - z * vy), 2 * (z * vx - x * vz), 2 * (x * vy - y * vx)
    return (
        vx + w * tx + y * tz - z * ty,
        vy + w * ty + z * tx - x * tz,
        vz + w * tz + x * ty - y * tx,
    )


def compose(outer: Pose, inner: Pose) -> Pose:
    """Return the world pose of a frame with the pose `inner` in the frame `outer`."""
    x, y, z = rotate(outer.quaternion, inner.position)
    ox, oy, oz = outer.position
    return Pose((ox + x, oy + y, oz + z), multiply(outer.quaternion, inner.quaternion))


def invert(pose: Pose) -> Pose:
    """Return the inverse of a pose: the pose of the world in the frame `pose`."""
    x, y, z, w = pose.quaternion
    back = (-x, -y, -z, w)
    px, py, pz = rotate(back, pose.position)
    return Pose((-px, -py, -pz), back)


def raised(pose: Pose, height: float) -> Pose:
    """Return a pose moved straight up by `height` metres."""
    x, y, z = pose.position
    return Pose((x, y, z + height), pose.quaternion)


def rows(pose: Pose) -> list[list[float]]:
    """Return the rows of a pose as a homogeneous matrix."""
    (px, py, pz), (x, y, z, w) = pose
    return [
        [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y), px],
        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x), py],
        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y), pz],
        [0.0, 0.0, 0.0, 1.0],
    ]


def matrix(pose: Pose) -> NDArray[np.float64]:
    """Return a pose as a homogeneous matrix, shape (4, 4)."""
    return np.array(rows(pose))


def finite(pose: Pose) -> bool:
    """Return whether a pose is finite and its quaternion has unit length; PyBullet checks neither."""
    numbers = (*pose.position, *pose.quaternion)
    return all(map(math.isfinite, numbers)) and abs(sum(q * q for q in pose.quaternion) - 1.0) < 1e-6


@lru_cache(maxsize=1 << 11)
def extents(shape: Shape, quaternion: Quaternion) -> Vector:
    """Return the half-extents of the axis-aligned bounding box of a rotated shape, in metres.

    A shape with a model is treated as its bounding box in the file; `prag_asp.physics.extent` measures its solids.
    """
    half, reach = shape.half, shape.traits.form.reach
    x, y, z, w = quaternion
    along = [reach(half, rotate((-x, -y, -z, w), axis)) for axis in AXES]
    return (along[0], along[1], along[2])


def width_along(shape: Shape, quaternion: Quaternion, direction: Vector) -> float:
    """Return the width of a rotated shape along a unit vector, in metres."""
    x, y, z, w = quaternion
    return 2 * shape.traits.form.reach(shape.half, rotate((-x, -y, -z, w), direction))


def heading(quaternion: Quaternion) -> tuple[float, float]:
    """Return the cosine and sine of the yaw of an upright body."""
    x, y, z, w = quaternion
    cosine, sine = 1 - 2 * (y * y + z * z), 2 * (w * z + x * y)
    length = math.hypot(cosine, sine) or 1.0
    return cosine / length, sine / length


def to_local(pose: Pose, x: float, y: float) -> Point:
    """Transform a point of the x-y plane to the frame of an upright body."""
    cosine, sine = heading(pose.quaternion)
    dx, dy = x - pose.position[0], y - pose.position[1]
    return (cosine * dx + sine * dy, cosine * dy - sine * dx)


@lru_cache(maxsize=1 << 11)
def outline(shape: Shape, pose: Pose) -> Outline:
    """Return the corners of an upright body seen from above, counter-clockwise; for a ball, its contact point."""
    x, y, _ = pose.position
    return shape.traits.form.outline(shape.half, x, y, yaw_of(pose.quaternion))


@lru_cache(maxsize=1 << 11)
def base(shape: Shape, pose: Pose) -> Outline:
    """Return the outline, seen from above, of the base of an upright body."""
    return outline(shape, pose) if shape.model is None or not shape.model.base else _placed(shape.model.base, pose)


@lru_cache(maxsize=1 << 11)
def crown(shape: Shape, pose: Pose) -> Outline:
    """Return the outline, seen from above, of the top of an upright body, on which other bodies can stand."""
    return outline(shape, pose) if shape.model is None or not shape.model.crown else _placed(shape.model.crown, pose)


def _placed(polygon: Outline, pose: Pose) -> Outline:
    """Transform an outline from the frame of an upright body to world coordinates."""
    (x, y, _), (cosine, sine) = pose.position, heading(pose.quaternion)
    return tuple((x + cosine * a - sine * b, y + sine * a + cosine * b) for a, b in polygon)


def centre_of_mass(shape: Shape, pose: Pose) -> Vector:
    """Return the centre of mass of a body in metres."""
    return pose.position if shape.model is None else compose(pose, Pose(shape.model.centre)).position


def inside_by(polygon: Outline, point: Point) -> float:
    """Return the depth in metres of a point within a convex counter-clockwise polygon; it is negative outside."""
    depth = math.inf
    for (ax, ay), (bx, by) in zip(polygon, polygon[1:] + polygon[:1], strict=True):
        length = math.hypot(bx - ax, by - ay)
        if length > 0.0:
            depth = min(depth, ((bx - ax) * (point[1] - ay) - (by - ay) * (point[0] - ax)) / length)
    if math.isinf(depth):
        return -math.dist(polygon[0], point) if polygon else -math.inf
    return depth


@lru_cache(maxsize=1 << 11)
def intersection(subject: Outline, clip: Outline) -> Outline:
    """Return the intersection of two convex counter-clockwise polygons (Sutherland and Hodgman's clipping)."""
    if len(subject) == 1:
        return subject if inside_by(clip, subject[0]) >= 0.0 else ()
    for (ax, ay), (bx, by) in zip(clip, clip[1:] + clip[:1], strict=True):
        subject = cut(subject, by - ay, ax - bx, (by - ay) * ax + (ax - bx) * ay)
    return subject


def cut(polygon: Outline, a: float, b: float, c: float) -> Outline:
    """Return the part of a convex polygon where ``a x + b y <= c``."""
    depths = [c - a * x - b * y for x, y in polygon]
    if not depths or min(depths) >= 0.0:
        return polygon
    clipped: list[Point] = []
    previous, before = polygon[-1], depths[-1]
    for point, depth in zip(polygon, depths, strict=True):
        if (depth >= 0.0) != (before >= 0.0):
            share = before / (before - depth)
            x, y = previous
            clipped.append((x + share * (point[0] - x), y + share * (point[1] - y)))
        if depth >= 0.0:
            clipped.append(point)
        previous, before = point, depth
    return tuple(clipped)


def hull(points: list[Point]) -> Outline:
    """Return the convex hull of points, counter-clockwise, using Andrew's monotone chain algorithm."""
    ordered = sorted(set(points))
    if len(ordered) <= 2:
        return tuple(ordered)
    lower, upper = _chain(ordered), _chain(ordered[::-1])
    return tuple(lower[:-1] + upper[:-1])


def _chain(points: list[Point]) -> list[Point]:
    """Return one half of a convex hull."""
    chain: list[Point] = []
    for x, y in points:
        while len(chain) >= 2:
            (ax, ay), (bx, by) = chain[-2], chain[-1]
            if (bx - ax) * (y - ay) - (by - ay) * (x - ax) > 0.0:
                break
            chain.pop()
        chain.append((x, y))
    return chain
