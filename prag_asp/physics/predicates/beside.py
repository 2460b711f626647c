"""``left_of``, ``right_of``, ``in_front_of``, ``behind``: one body lies entirely to one side of another.

The scene determines the frame. For the robot, which looks along +x, left is +y and in front (nearer to the robot) is
-x. For a viewer who faces the robot, left is -y and in front (nearer to the viewer) is +x. The bounding boxes are at
least `GAP` apart along the axis, and the centres' offset across the axis is at most `SPREAD` times that along it.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from functools import partial

from prag_asp.physics.extent import extent
from prag_asp.physics.predicates.gaps import Demand, Gap, centre, thinnest
from prag_asp.physics.predicates.predicate import Arguments, Direction, Predicate, states
from prag_asp.physics.predicates.volume import Side, Volume, opposite
from prag_asp.physics.situation import Situation
from prag_asp.scene.boxes import Vector
from prag_asp.scene.geometry import Quaternion
from prag_asp.scene.scene import Scene

GAP = 0.005
MARGIN = 0.003
SPREAD = 2.0
SLANT = math.hypot(1.0, SPREAD)
X, Y = 0, 1
SIDES = {
    "left_of": Direction(Y, 1.0),
    "right_of": Direction(Y, -1.0),
    "in_front_of": Direction(X, -1.0),
    "behind": Direction(X, 1.0),
}
"""The direction from the other body to the subject, as the robot sees it."""

WORDING = {
    "left_of": ("to the left of", "right_of", 90),
    "right_of": ("to the right of", "left_of", 91),
    "in_front_of": ("in front of", "behind", 92),
    "behind": ("behind", "in_front_of", 93),
}
"""The phrase of each predicate in a sentence, its inverse, and its rank in captions."""


def _violations(name: str, situation: Situation, arguments: Arguments) -> Iterator[float]:
    """Yield the amounts in metres by which the subject violates the spread and the gap."""
    axis, sign = SIDES[name].in_frame(situation.scene.frame)
    one, two = situation.body(arguments[0]), situation.body(arguments[1])
    at, other = one.centre, two.centre
    along = sign * (at[axis] - other[axis])
    yield (abs(at[1 - axis] - other[1 - axis]) - SPREAD * along) / SLANT
    yield one.half[axis] + two.half[axis] + GAP - along


def _volume(name: str, situation: Situation, arguments: Arguments, quaternion: Quaternion) -> Volume:
    """Return the wedge on the side of the other body that the predicate states."""
    subject, other = arguments
    side = SIDES[name].in_frame(situation.scene.frame)
    centre, half = extent(situation.shape(subject), quaternion)
    return wedge(situation, side, other, half, GAP + MARGIN).moved(opposite(centre))


def wedge(situation: Situation, side: Direction, other: str, half: Vector, gap: float) -> Volume:
    """Return the region for the centre of a box that lies on one side of a body.

    `half` contains the half-extents of the box, which has to be at least `gap` metres away from the body.
    """
    axis, sign = side
    at = situation.body(other).centre
    edge = at[axis] + sign * (half[axis] + situation.half(other)[axis] + gap)
    low, high = [-math.inf] * 3, [math.inf] * 3
    (low if sign > 0 else high)[axis] = edge
    sides = []
    for across in (1.0, -1.0):
        normal = [0.0, 0.0]
        normal[axis], normal[1 - axis] = -sign * SPREAD / SLANT, across / SLANT
        sides.append(Side(normal[0], normal[1], normal[0] * at[0] + normal[1] * at[1] - MARGIN))
    return Volume((low[0], low[1], low[2]), (high[0], high[1], high[2]), sides=tuple(sides))


def _demands(name: str, scene: Scene, arguments: Arguments) -> Iterator[Demand]:
    """Yield the minimum distance between the centres of the two bodies along the axis."""
    axis, sign = SIDES[name].in_frame(scene.frame)
    low, high = arguments if sign < 0 else arguments[::-1]
    yield axis, Gap(centre(low), centre(high), thinnest(low, axis, scene) + thinnest(high, axis, scene) + GAP)


PREDICATES = {
    name: Predicate(
        name=name,
        violations=partial(_violations, name),
        volume=partial(_volume, name),
        sentence=states(f"{{0}} {{is}} {phrase} {{1}}"),
        inverse=inverse,
        direction=SIDES[name],
        apart=(GAP, math.inf),
        seen_close=True,
        demands=partial(_demands, name),
        caption_rank=rank,
    )
    for name, (phrase, inverse, rank) in WORDING.items()
}
