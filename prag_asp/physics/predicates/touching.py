"""``touching``: the gap between two bodies is at most `TOLERANCE`, and so is their penetration depth.

The gap is the distance between the bodies or, if they overlap, the negated penetration depth. It is exact for upright
boxes, cylinders and balls with any yaw. A body with a model counts as the upright prism around it. Other bodies, and
bodies tilted by more than `LEAN`, count as their bounding boxes. Thus a body inside a container overlaps the container
and does not touch it. A body touches any body on which it stands or against which it leans. The predicate is symmetric.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import NamedTuple

from prag_asp.physics.extent import extent, silhouette
from prag_asp.physics.predicates.gaps import Demand, Gap, Z, along, between, bottom, centre, top
from prag_asp.physics.predicates.predicate import Arguments, Predicate, words
from prag_asp.physics.predicates.volume import Ring, Side, Volume, turned_box
from prag_asp.physics.situation import Situation
from prag_asp.scene.boxes import Vector
from prag_asp.scene.forms import Outline, Point, rectangle
from prag_asp.scene.geometry import Pose, Quaternion, hull, inside_by, turn_between, wrap, yaw_of, yaw_quaternion
from prag_asp.scene.scene import Scene, Shape

TOLERANCE, MARGIN, HEIGHT_MARGIN = 0.002, 0.0005, 0.0002
LEAN = math.radians(2)
SECTOR, WHOLE_SECTOR = math.pi / 6, math.pi / 2
"""The largest angles, in radians, of the sectors of a ring around a corner and around a whole disc; smaller sectors
reject fewer samples."""

Heights = tuple[float, float]


class Core(NamedTuple):
    """A body as the Minkowski sum of a core (a convex outline or a point in the x-y plane) and a disc or a ball.

    The `corners` of the core are counter-clockwise, and it extends in height from `low` to `high`. `disc` is the radius
    of a cylinder, and `ball` the radius of a ball; otherwise they are 0. All lengths are in metres.
    """

    corners: Outline
    low: float
    high: float
    disc: float = 0.0
    ball: float = 0.0


def _core(shape: Shape, at: Vector, half: Vector, quaternion: Quaternion) -> Core:
    """Return the core of a body, given the centre `at` and the half-extents of its bounding box, in metres."""
    (x, y, z), traits, yaw = at, shape.traits, yaw_of(quaternion)
    if traits.round and not traits.flat:
        return Core(((x, y),), z, z, ball=half[2])
    low, high = z - half[2], z + half[2]
    if shape.model is not None:
        (dx, dy, _), _ = extent(shape, quaternion)
        return Core(silhouette(shape, Pose((x - dx, y - dy, 0.0), quaternion)), low, high)
    if traits.furniture or not traits.body or turn_between(quaternion, yaw_quaternion(yaw)) > LEAN:
        return Core(rectangle(x, y, half[0], half[1], 0.0), low, high)
    if traits.round:
        return Core(((x, y),), low, high, disc=shape.half[0])
    return Core(rectangle(x, y, shape.half[0], shape.half[1], yaw), low, high)


def _placed(situation: Situation, entity: str) -> Core:
    """Return the core of a body at its current pose."""
    body = situation.body(entity)
    return _core(situation.shape(entity), body.centre, body.half, body.pose.quaternion)


def _difference(one: Outline, two: Outline) -> Outline:
    """Return the convex outline of the differences from points of the second outline to points of the first."""
    return hull([(ax - bx, ay - by) for ax, ay in one for bx, by in two])


def _origin_distance(outline: Outline) -> float:
    """Return the signed distance of the origin from a convex outline in metres, negative within it."""
    depth = inside_by(outline, (0.0, 0.0))
    if depth >= 0.0:
        return -depth
    distances = []
    for (ax, ay), (bx, by) in zip(outline, outline[1:] + outline[:1], strict=True):
        dx, dy = bx - ax, by - ay
        square = dx * dx + dy * dy
        share = min(1.0, max(0.0, -(ax * dx + ay * dy) / square)) if square > 0.0 else 0.0
        distances.append(math.hypot(ax + share * dx, ay + share * dy))
    return min(distances)


def gap(situation: Situation, arguments: Arguments) -> float:
    """Return the gap between two bodies in metres, negative if they overlap."""
    one, two = (_placed(situation, entity) for entity in arguments)
    aside = _origin_distance(_difference(one.corners, two.corners)) - one.disc - two.disc
    above = max(one.low - two.high, two.low - one.high)
    apart = math.hypot(max(0.0, aside), max(0.0, above)) + min(0.0, max(aside, above))
    return apart - one.ball - two.ball


def _volume(situation: Situation, arguments: Arguments, quaternion: Quaternion) -> Volume:
    """Return the regions beside the other body, on it and below it.

    They do not include positions of a ball that touches an edge, unless the ball is on the floor on which the other
    body stands.
    """
    subject, other = arguments
    shape, there = situation.shape(subject), _placed(situation, other)
    own = _core(shape, *extent(shape, quaternion), quaternion)
    ways = _difference(there.corners, own.corners)
    disc, ball = there.disc + own.disc, there.ball + own.ball
    low, high = there.low - own.high, there.high - own.low
    near, far = ball + MARGIN, ball + TOLERANCE - MARGIN
    regions = [*_around(ways, disc + near, disc + far, (low + MARGIN, high - MARGIN))]
    floor = there.low - there.ball - own.low + own.ball
    # On the same floor, the cores may have different heights, because two balls of different sizes touch at an angle.
    aslant = max(low - floor, floor - high)
    if ball > 0.0 and aslant > -MARGIN:
        near, far = (math.sqrt(reach**2 - max(0.0, aslant) ** 2) for reach in (near, far))
        regions += _around(ways, disc + near, disc + far, (floor - HEIGHT_MARGIN, floor + HEIGHT_MARGIN))
    edges = zip(ways, ways[1:] + ways[:1], strict=True) if len(ways) > 1 else ()
    normals = ((one, _outward(one, two)) for one, two in edges)
    sides = tuple(Side(a, b, a * x + b * y) for (x, y), (a, b) in normals)
    for level in (high + ball, low - ball):
        heights = (level - MARGIN, level + MARGIN)
        if sides:
            regions.append(Volume((-math.inf, -math.inf, heights[0]), (math.inf, math.inf, heights[1]), sides=sides))
        regions += _around(ways, 0.0, max(disc - MARGIN, MARGIN), heights)
    return Volume(unions=(tuple(regions),))


def _around(outline: Outline, near: float, far: float, heights: Heights) -> Iterator[Volume]:
    """Yield regions that form a ring between two distances from a convex outline, in metres, over a range of heights.

    They omit the sectors at the corners of a rectangle that are smaller than the tolerance.
    """
    if heights[0] > heights[1]:
        return
    low, high = (-math.inf, -math.inf, heights[0]), (math.inf, math.inf, heights[1])
    normals = []
    for one, two in zip(outline, outline[1:] + outline[:1], strict=True):
        x, y = _outward(one, two)
        normals.append(math.atan2(y, x))
        middle = ((one[0] + two[0] + x * (near + far)) / 2, (one[1] + two[1] + y * (near + far)) / 2, 0.0)
        half = (math.dist(one, two) / 2, (far - near) / 2)
        if half[0] > 0.0:
            yield Volume(low, high, sides=turned_box((middle, (-y, x)), half))
    for i, corner in enumerate(outline if far >= TOLERANCE or len(outline) == 1 else ()):
        turn = wrap(normals[i] - normals[i - 1]) if len(outline) > 1 else 2 * math.pi
        count = math.ceil(turn / (SECTOR if near > 0.0 else WHOLE_SECTOR) - MARGIN)
        for k in range(count):
            ends = (normals[i - 1] + turn * k / count, normals[i - 1] + turn * (k + 1) / count)
            yield Volume(low, high, sides=_sector(corner, ends, near, far), rings=(Ring(*corner, near, far),))


def _outward(one: Point, two: Point) -> Point:
    """Return the outward unit normal of an edge of a counter-clockwise outline."""
    length = math.dist(one, two)
    return ((two[1] - one[1]) / length, (one[0] - two[0]) / length) if length > 0.0 else (1.0, 0.0)


def _sector(corner: Point, ends: tuple[float, float], near: float, far: float) -> tuple[Side, ...]:
    """Return the half-planes that bound a ring sector around a corner: between two headings, a chord and a tangent."""
    (x, y), (begin, end) = corner, ends
    middle, chord = (begin + end) / 2, near * math.cos((end - begin) / 2)
    return tuple(
        Side(a, b, a * x + b * y + reach)
        for a, b, reach in (
            (math.sin(begin), -math.cos(begin), 0.0),
            (-math.sin(end), math.cos(end), 0.0),
            (-math.cos(middle), -math.sin(middle), -chord),
            (math.cos(middle), math.sin(middle), far),
        )
    )


def _demands(scene: Scene, arguments: Arguments) -> Iterator[Demand]:
    """Yield constraints that the bodies (almost) overlap along each axis; there are none for the table and zones."""
    one, two = arguments
    if not all(scene.shapes[entity].traits.body for entity in arguments):
        return
    for axis in (0, 1):
        reach = _broadest(one, axis, scene) + _broadest(two, axis, scene) + TOLERANCE
        yield from along(axis, between(centre(one), centre(two), -reach, reach))
    yield Z, Gap(bottom(one), top(two), -TOLERANCE)
    yield Z, Gap(bottom(two), top(one), -TOLERANCE)


def _broadest(entity: str, axis: int, scene: Scene) -> float:
    """Return the maximum extent of a body from its origin along an axis over all its orientations, in metres."""
    shape, place = scene.shapes[entity], scene.fixed.get(entity)
    if place is not None:
        middle, half = extent(shape, yaw_quaternion(place[2]))
        return abs(middle[axis]) + half[axis]
    return math.hypot(shape.breadth(widest=True) / 2, shape.half[2]) if shape.traits.flat else shape.half[2]


TOUCHING = Predicate(
    name="touching",
    violations=lambda situation, arguments: iter([abs(gap(situation, arguments)) - TOLERANCE]),
    volume=_volume,
    sentence=lambda arguments, value=True: (
        f"{words(arguments[0])} {'touches' if value else 'does not touch'} {words(arguments[1])}"
    ),
    inverse="touching",
    caption_rank=75,
    rests_on_other=True,
    apart=(0.0, TOLERANCE),
    demands=_demands,
)

PREDICATES = {"touching": TOUCHING}
