"""``between``: a body lies between two others seen from above, at any heights.

The line segment between the centres of the two others passes through the body, and along that line the body is at
least `GAP` metres away from both.
"""

from __future__ import annotations

import math
from collections.abc import Iterator

from prag_asp.physics.predicates.predicate import Arguments, Predicate, states
from prag_asp.physics.predicates.volume import Volume, over_rectangle
from prag_asp.physics.situation import Situation
from prag_asp.scene.boxes import Vector
from prag_asp.scene.geometry import Quaternion, width_along

GAP = 0.005
MARGIN = 0.003


def _half_along(situation: Situation, entity: str, quaternion: Quaternion, direction: Vector) -> float:
    """Return half the width of a body along a direction in metres; for furniture, that of its bounding box."""
    if situation.shape(entity).traits.furniture:
        half_x, half_y, _ = situation.half(entity)
        return abs(direction[0]) * half_x + abs(direction[1]) * half_y
    return width_along(situation.shape(entity), quaternion, direction) / 2


def _line(situation: Situation, arguments: Arguments) -> tuple[float, Vector]:
    """Return the distance between the two others in metres, and the direction from the first to the second."""
    (ax, ay, _), (bx, by, _) = (situation.body(other).centre for other in arguments[1:])
    length = math.hypot(bx - ax, by - ay)
    return length, ((bx - ax) / length, (by - ay) / length, 0.0) if length > 0.0 else (1.0, 0.0, 0.0)


def _room(
    situation: Situation, arguments: Arguments, quaternion: Quaternion, line: tuple[float, Vector]
) -> tuple[float, float, float]:
    """Return the range of the body's centre along the line, and its maximum distance from the line.

    The range is in metres from the centre of the first of the two others.
    """
    subject, one, two = arguments
    length, along = line
    own = _half_along(situation, subject, quaternion, along) + GAP
    begin = own + _half_along(situation, one, situation.pose(one).quaternion, along)
    end = length - own - _half_along(situation, two, situation.pose(two).quaternion, along)
    return begin, end, _half_along(situation, subject, quaternion, (-along[1], along[0], 0.0))


def _violations(situation: Situation, arguments: Arguments) -> Iterator[float]:
    """Yield by how many metres the body misses the line, and each of the two gaps."""
    line = _line(situation, arguments)
    pose, (x, y, _) = situation.pose(arguments[0]), situation.body(arguments[1]).centre
    begin, end, aside = _room(situation, arguments, pose.quaternion, line)
    dx, dy, (ux, uy, _) = pose.position[0] - x, pose.position[1] - y, line[1]
    yield abs(ux * dy - uy * dx) - aside
    yield begin - (ux * dx + uy * dy)
    yield ux * dx + uy * dy - end


def _volume(situation: Situation, arguments: Arguments, quaternion: Quaternion) -> Volume:
    """Return the rectangle around the line between the others."""
    line = _line(situation, arguments)
    begin, end, aside = _room(situation, arguments, quaternion, line)
    x, y, _ = situation.body(arguments[1]).centre
    along, across = (end - begin) / 2 - MARGIN, aside - min(MARGIN, aside / 2)
    if along < 0.0:
        return Volume((x, y, 0.0), (x, y, -1.0))
    ux, uy, _ = line[1]
    middle = (x + ux * (begin + end) / 2, y + uy * (begin + end) / 2, 0.0)
    return over_rectangle(middle, (ux, uy), (along, across), (-math.inf, math.inf))


BETWEEN = Predicate(
    name="between",
    violations=_violations,
    volume=_volume,
    sentence=states("{0} {is} between {1} and {2}"),
    lies_between=True,
    caption_rank=60,
)

PREDICATES = {"between": BETWEEN}
