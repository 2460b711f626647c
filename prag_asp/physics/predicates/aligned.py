"""``aligned``: two bodies side by side with parallel sides, in a row along an axis of the scene.

To within `TURN`, the yaws of their sides differ by a multiple of 90 degrees; cylinders and balls are parallel to
everything. The sides of a body with a model are those of the smallest rectangle around it, seen from above. Along one
of the axes x and y of the scene, their centres are at most `OFFSET` metres apart; along the other, their bounding boxes
are at least `GAP` metres apart. The predicate is symmetric.
"""

from __future__ import annotations

import math
from collections.abc import Iterator

from prag_asp.physics.extent import extent, side_yaw
from prag_asp.physics.predicates.predicate import Arguments, Predicate, states
from prag_asp.physics.predicates.volume import Volume, Yaws, opposite
from prag_asp.physics.situation import Situation
from prag_asp.scene.geometry import Quaternion, wrap, yaw_of

TURN, TURN_MARGIN = math.radians(5), math.radians(0.5)
OFFSET, GAP, MARGIN = 0.01, 0.005, 0.003
QUARTER = math.pi / 2


def _parallel(situation: Situation, arguments: Arguments) -> bool:
    """Return whether both bodies have sides that can be parallel."""
    return not any(situation.shape(entity).traits.round for entity in arguments)


def _side_yaw(situation: Situation, entity: str) -> float:
    """Return the yaw of the sides of a body in radians."""
    return yaw_of(situation.pose(entity).quaternion) + side_yaw(situation.shape(entity))


def _violations(situation: Situation, arguments: Arguments) -> Iterator[float]:
    """Yield the distance from the nearest row in metres, and the deviation of the yaws from parallel in radians."""
    one, two = situation.body(arguments[0]), situation.body(arguments[1])
    apart = [abs(a - b) for a, b in zip(one.centre[:2], two.centre[:2], strict=True)]
    close = [one.half[axis] + two.half[axis] + GAP for axis in (0, 1)]
    yield min(max(apart[1 - axis] - OFFSET, close[axis] - apart[axis]) for axis in (0, 1))
    if _parallel(situation, arguments):
        yaws = [_side_yaw(situation, entity) for entity in arguments]
        off = wrap(4 * (yaws[0] - yaws[1])) / 4
        yield abs(off) - TURN


def _volume(situation: Situation, arguments: Arguments, quaternion: Quaternion) -> Volume:
    """Return the strips along the four sides of the other body, and the four ranges of parallel yaws."""
    subject, other = arguments
    at, half = situation.body(other).centre, situation.half(other)
    centre, own = extent(situation.shape(subject), quaternion)
    strips = []
    for axis in (0, 1):
        for sign in (1.0, -1.0):
            low, high = [-math.inf] * 3, [math.inf] * 3
            low[1 - axis], high[1 - axis] = at[1 - axis] - OFFSET + MARGIN, at[1 - axis] + OFFSET - MARGIN
            edge = at[axis] + sign * (half[axis] + own[axis] + GAP + MARGIN)
            (low if sign > 0 else high)[axis] = edge
            strips.append(Volume((low[0], low[1], low[2]), (high[0], high[1], high[2])))
    yaws = None
    if _parallel(situation, arguments):
        yaw = _side_yaw(situation, other) - side_yaw(situation.shape(subject))
        yaws = tuple(Yaws(yaw + turn * QUARTER, TURN - TURN_MARGIN) for turn in range(4))
    return Volume(yaws=yaws, unions=(tuple(strips),)).moved(opposite(centre))


ALIGNED = Predicate(
    name="aligned",
    violations=_violations,
    volume=_volume,
    sentence=states("{0} {is} aligned with {1}"),
    inverse="aligned",
    turns=True,
    apart=(GAP, math.inf),
    seen_close=True,
    caption_rank=80,
)

PREDICATES = {"aligned": ALIGNED}
