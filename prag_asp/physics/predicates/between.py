"""``between``: seen from above, a body lies between two others, at any height.

The line segment between the centres of the two others passes through the body, and along that line the body is at
least `GAP` metres away from both.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import NamedTuple

from prag_asp.physics.extent import extent_along
from prag_asp.physics.predicates.predicate import Arguments, Predicate, states
from prag_asp.physics.predicates.volume import Volume, over_rectangle
from prag_asp.physics.situation import Situation
from prag_asp.scene.boxes import Vector
from prag_asp.scene.geometry import Quaternion

GAP = 0.005
MARGIN = 0.003


def _ends(situation: Situation, entity: str, direction: Vector) -> tuple[float, float]:
    """Return the extent of a body, in metres, from the centre of its bounding box against and along a direction."""
    body = situation.body(entity)
    if situation.shape(entity).traits.furniture:
        half = abs(direction[0]) * body.half[0] + abs(direction[1]) * body.half[1]
        return half, half
    middle, half = extent_along(situation.shape(entity), body.pose.quaternion, direction)
    offset = zip(body.pose.position, body.centre, direction, strict=True)
    middle += sum((at - centre) * axis for at, centre, axis in offset)
    return half - middle, half + middle


def _line(situation: Situation, arguments: Arguments) -> tuple[float, Vector]:
    """Return the distance between the two other bodies in metres, and the direction from the first to the second."""
    (ax, ay, _), (bx, by, _) = (situation.body(other).centre for other in arguments[1:])
    length = math.hypot(bx - ax, by - ay)
    return length, ((bx - ax) / length, (by - ay) / length, 0.0) if length > 0.0 else (1.0, 0.0, 0.0)


class _Room(NamedTuple):
    """The range of positions along a line for the middle of a body, its maximum distance from the line, and offsets.

    All are in metres.

    Positions in the range are relative to the centre of the first of the two other bodies. The offsets are from the
    origin of the body to its middle, along the line and to the left of the line.
    """

    begin: float
    end: float
    aside: float
    offset: tuple[float, float]


def _room(situation: Situation, arguments: Arguments, quaternion: Quaternion, line: tuple[float, Vector]) -> _Room:
    """Return the room for a rotated body between the two other bodies."""
    subject, one, two = arguments
    length, along = line
    shape = situation.shape(subject)
    middle, half = extent_along(shape, quaternion, along)
    left, aside = extent_along(shape, quaternion, (-along[1], along[0], 0.0))
    begin = half + GAP + _ends(situation, one, along)[1]
    return _Room(begin, length - (half + GAP) - _ends(situation, two, along)[0], aside, (middle, left))


def _violations(situation: Situation, arguments: Arguments) -> Iterator[float]:
    """Yield the distance of the body from the line, and by how much it violates the two gaps, in metres."""
    line = _line(situation, arguments)
    pose, (x, y, _) = situation.pose(arguments[0]), situation.body(arguments[1]).centre
    begin, end, aside, (middle, left) = _room(situation, arguments, pose.quaternion, line)
    dx, dy, (ux, uy, _) = pose.position[0] - x, pose.position[1] - y, line[1]
    yield abs(ux * dy - uy * dx + left) - aside
    yield begin - (ux * dx + uy * dy + middle)
    yield ux * dx + uy * dy + middle - end


def _volume(situation: Situation, arguments: Arguments, quaternion: Quaternion) -> Volume:
    """Return the rectangle around the line between the other bodies."""
    line = _line(situation, arguments)
    begin, end, aside, (middle, left) = _room(situation, arguments, quaternion, line)
    x, y, _ = situation.body(arguments[1]).centre
    along, across = (end - begin) / 2 - MARGIN, aside - min(MARGIN, aside / 2)
    if along < 0.0:
        return Volume((x, y, 0.0), (x, y, -1.0))
    ux, uy, _ = line[1]
    at = (x + ux * (begin + end) / 2, y + uy * (begin + end) / 2, 0.0)
    region = over_rectangle(at, (ux, uy), (along, across), (-math.inf, math.inf))
    return region.moved((uy * left - ux * middle, -ux * left - uy * middle, 0.0))


BETWEEN = Predicate(
    name="between",
    violations=_violations,
    volume=_volume,
    sentence=states("{0} {is} between {1} and {2}"),
    lies_between=True,
    caption_rank=60,
)

PREDICATES = {"between": BETWEEN}
