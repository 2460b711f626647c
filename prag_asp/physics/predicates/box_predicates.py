"""Predicates that a domain defines in its domain.toml as unions of boxes around an entity.

The frame of a box is the frame of the entity, rotated by the entity's yaw: x and y start at its centre, z at its lowest
point. The frame of the table has the axes of the scene, and its origin is the centre of the table top. The predicate
holds if the centre of the subject or, for a `whole` predicate, the whole subject is in one of the boxes, within
`TOLERANCE` metres.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from functools import partial

from prag_asp.physics.extent import ORIGIN, BodyExtent, extent
from prag_asp.physics.predicates.predicate import Arguments, Predicate, states
from prag_asp.physics.predicates.volume import Side, Volume, opposite
from prag_asp.physics.situation import Situation
from prag_asp.scene.boxes import Vector
from prag_asp.scene.geometry import Quaternion, heading, multiply, rotate, to_local
from prag_asp.scene.scene import BoxBounds, Own

TOLERANCE, SLIVER = 0.002, 1e-6
CENTRE = BodyExtent(ORIGIN, (0.0, 0.0, 0.0))


def box_predicate(own: Own) -> Predicate:
    """Return a predicate that is defined by boxes around its second argument."""
    return Predicate(
        name=own.name,
        violations=partial(_violations, own),
        volume=partial(_volume, own),
        sentence=states(own.sentence),
        rests_on_other=True,
    )


def _extent(own: Own, situation: Situation, arguments: Arguments, quaternion: Quaternion) -> BodyExtent:
    """Return the bounding box of the subject, or of its centre, in the axes of the boxes."""
    if not own.whole:
        return CENTRE
    x, y, z, w = situation.pose(arguments[1]).quaternion
    return extent(situation.shape(arguments[0]), multiply((-x, -y, -z, w), quaternion))


def _violations(own: Own, situation: Situation, arguments: Arguments) -> Iterator[float]:
    """Yield the distance in metres from the subject to the nearest box, less the tolerance."""
    subject, other = arguments
    pose = situation.pose(subject)
    x, y = to_local(situation.pose(other), pose.position[0], pose.position[1])
    (dx, dy, dz), half = _extent(own, situation, arguments, pose.quaternion)
    at = (x + dx, y + dy, pose.position[2] + dz - situation.bottom(other))
    boxes = (zip(box.low, box.high, at, half, strict=True) for box in own.boxes)
    missed = (max(max(a - x + reach, x + reach - b) for a, b, x, reach in box) for box in boxes)
    yield min(missed) - TOLERANCE


def _volume(own: Own, situation: Situation, arguments: Arguments, quaternion: Quaternion) -> Volume:
    """Return the union of the boxes."""
    middle, half = _extent(own, situation, arguments, quaternion)
    rooms = tuple(_room(box, situation, arguments[1], half) for box in own.boxes)
    return Volume(unions=(rooms,)).moved(opposite(rotate(situation.pose(arguments[1]).quaternion, middle)))


def _room(box: BoxBounds, situation: Situation, other: str, half: Vector) -> Volume:
    """Return the region for the centre of a body with half-extents `half`, in metres, that has to be in a box."""
    (ax, bx), (ay, by), (az, bz) = (_ends(*ends) for ends in zip(box.low, box.high, half, strict=True))
    x, y, _ = situation.pose(other).position
    bottom = situation.bottom(other)
    if ax > bx or ay > by or az > bz:
        return Volume((x, y, 0.0), (x, y, -1.0))
    cosine, sine = heading(situation.pose(other).quaternion)
    along, across = cosine * x + sine * y, cosine * y - sine * x
    sides = (
        Side(cosine, sine, along + bx),
        Side(-cosine, -sine, -along - ax),
        Side(-sine, cosine, across + by),
        Side(sine, -cosine, -across - ay),
    )
    return Volume(
        (-math.inf, -math.inf, bottom + az),
        (math.inf, math.inf, bottom + bz),
        sides=tuple(side for side in sides if math.isfinite(side.c)),
    )


def _ends(low: float, high: float, reach: float) -> tuple[float, float]:
    """Return the range of positions in metres of a body's centre along an axis of a box; it is empty if low > high.

    A body that is as large as the box, to within the tolerance, has to be at the centre of the box.
    """
    low, high = low + reach, high - reach
    if -2 * SLIVER <= low - high <= 2 * (TOLERANCE - SLIVER):
        middle = (low + high) / 2
        return middle - SLIVER, middle + SLIVER
    return low, high
