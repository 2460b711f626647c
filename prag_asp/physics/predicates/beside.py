"""``left_of``, ``right_of``, ``in_front_of``, ``behind``: one body lies wholly to one side of another.

The frame is the scene's. For the robot, which looks along +x, left is +y and in front (nearer to it) is -x.
For a viewer who faces the robot, left is -y and in front (nearer to the viewer) is +x. The bounding boxes are
at least `GAP` apart along the axis, and the centres at most `SPREAD` times as far apart across it as along
it.
"""

from __future__ import annotations

import math
from functools import partial

from prag_asp.physics.geometry import Vector
from prag_asp.physics.predicates.predicate import Arguments, Predicate, Volume, excess, states
from prag_asp.physics.situation import Situation

GAP = 0.005
MARGIN = 0.001
SPREAD = 2.0
X, Y = 0, 1
DIRECTIONS = {"left_of": (Y, 1.0), "right_of": (Y, -1.0), "in_front_of": (X, -1.0), "behind": (X, 1.0)}
INVERSES = {"left_of": "right_of", "right_of": "left_of", "in_front_of": "behind", "behind": "in_front_of"}
PHRASES = {
    "left_of": "to the left of",
    "right_of": "to the right of",
    "in_front_of": "in front of",
    "behind": "behind",
}


def direction(name: str, frame: str) -> tuple[int, float]:
    """Return the axis (0 is x, 1 is y) and the sign along which the subject lies from the other body."""
    axis, sign = DIRECTIONS[name]
    return axis, sign if frame == "robot" else -sign


def _distance(name: str, situation: Situation, arguments: Arguments) -> float:
    """Return by how many metres the subject is short of the gap or outside the spread."""
    subject, other = arguments
    axis, sign = direction(name, situation.scene.frame)
    one, two = situation.pose(subject).position, situation.pose(other).position
    along = sign * (one[axis] - two[axis])
    across = abs(one[1 - axis] - two[1 - axis])
    needed = situation.half(subject)[axis] + situation.half(other)[axis] + GAP
    return excess(needed - along, (across - SPREAD * along) / math.hypot(1.0, SPREAD))


def _volume(name: str, situation: Situation, arguments: Arguments, half: Vector) -> Volume:
    """Return the half space beyond the other body."""
    other = arguments[1]
    axis, sign = direction(name, situation.scene.frame)
    edge = situation.half(other)[axis] + half[axis] + GAP + MARGIN
    low, high = [-math.inf] * 3, [math.inf] * 3
    (low if sign > 0 else high)[axis] = situation.pose(other).position[axis] + sign * edge
    return Volume((low[0], low[1], low[2]), (high[0], high[1], high[2]))


BESIDE = tuple(
    Predicate(
        name=name,
        distance=partial(_distance, name),
        volume=partial(_volume, name),
        sentence=states(f"{{0}} {{is}} {PHRASES[name]} {{1}}"),
        inverse=INVERSES[name],
    )
    for name in DIRECTIONS
)
