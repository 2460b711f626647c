"""Predicates that a domain defines in its domain.toml as a union of boxes around an entity.

A box is given in the frame of the entity, rotated with its yaw: x and y from the centre of the entity, z from its
lowest point; around the table, in the scene's axes from the centre of its top. The centre of the subject is in one of
the boxes or, if the predicate says `whole`, the whole subject is, within `TOLERANCE`.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from functools import partial

from prag_asp.physics.predicates.predicate import Arguments, Predicate, states
from prag_asp.physics.predicates.volume import Side, Volume
from prag_asp.physics.situation import Situation
from prag_asp.scene.boxes import Vector
from prag_asp.scene.geometry import Quaternion, extents, heading, multiply, to_local
from prag_asp.scene.scene import BoxBounds, Own

TOLERANCE, SLIVER = 0.002, 1e-6
CENTRE: Vector = (0.0, 0.0, 0.0)


def box_predicate(own: Own) -> Predicate:
    """Return a predicate made of boxes around its second argument."""
    return Predicate(
        name=own.name,
        violations=partial(_violations, own),
        volume=partial(_volume, own),
        sentence=states(own.sentence),
        rests_on_other=True,
    )


def _half(own: Own, situation: Situation, arguments: Arguments, quaternion: Quaternion) -> Vector:
    """Return the half-sides of what has to be in a box, in the axes of the box: the subject or its centre; metres."""
    if not own.whole:
        return CENTRE
    x, y, z, w = situation.pose(arguments[1]).quaternion
    return extents(situation.shape(arguments[0]), multiply((-x, -y, -z, w), quaternion))


def _violations(own: Own, situation: Situation, arguments: Arguments) -> Iterator[float]:
    """Yield by how many metres the subject misses the nearest box, beyond the tolerance."""
    subject, other = arguments
    pose = situation.pose(subject)
    x, y = to_local(situation.pose(other), pose.position[0], pose.position[1])
    at = (x, y, pose.position[2] - situation.bottom(other))
    half = _half(own, situation, arguments, pose.quaternion)
    yield min(_missed(box, at, half) for box in own.boxes) - TOLERANCE


def _missed(box: BoxBounds, at: Vector, half: Vector) -> float:
    """Return by how many metres a body misses a box along the worst axis; negative within it."""
    below = (low - value + reach for low, value, reach in zip(box.low, at, half, strict=True))
    above = (value + reach - high for high, value, reach in zip(box.high, at, half, strict=True))
    return max(*below, *above)


def _volume(own: Own, situation: Situation, arguments: Arguments, quaternion: Quaternion) -> Volume:
    """Return the boxes."""
    half = _half(own, situation, arguments, quaternion)
    return Volume(unions=(tuple(_room(box, situation, arguments[1], half) for box in own.boxes),))


def _room(box: BoxBounds, situation: Situation, other: str, half: Vector) -> Volume:
    """Return the region for the centre of a body of half-sides `half` that has to be in a box; metres."""
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
    """Return the range for the centre of a body along an axis of a box in metres, low > high if it is empty.

    A body as large as the box, or larger within the tolerance, is put into its centre.
    """
    low, high = low + reach, high - reach
    if -2 * SLIVER <= low - high <= 2 * (TOLERANCE - SLIVER):
        middle = (low + high) / 2
        return middle - SLIVER, middle + SLIVER
    return low, high
