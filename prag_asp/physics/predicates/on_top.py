"""``on_top``: a body stands on the top of another, its centre above that top."""

from __future__ import annotations

import math

from prag_asp.physics.geometry import Vector, to_local
from prag_asp.physics.predicates.predicate import Arguments, Predicate, Volume, excess, states
from prag_asp.physics.situation import Situation

TOLERANCE = 0.002
MARGIN = 0.004


def _overhang(situation: Situation, support: str, x: float, y: float) -> float:
    """Return how far a point lies beyond the edge of a top in metres, at most 0 above it."""
    dx, dy = to_local(situation.pose(support), x, y)
    if situation.shape(support).kind in ("cylinder", "sphere"):
        return math.hypot(dx, dy) - situation.shape(support).half[0]
    half = situation.half(support) if situation.is_table(support) else situation.shape(support).half
    return max(abs(dx) - half[0], abs(dy) - half[1])


def _distance(situation: Situation, arguments: Arguments) -> float:
    """Return by how many metres the body floats, sinks in or hangs over."""
    subject, support = arguments
    x, y, _ = situation.pose(subject).position
    gap = abs(situation.bottom(subject) - situation.top(support))
    return excess(gap - TOLERANCE, _overhang(situation, support, x, y))


def _volume(situation: Situation, arguments: Arguments, half: Vector) -> Volume:
    """Return the bounding box of the support's top, at the height of a body that stands on it."""
    support = arguments[1]
    x, y, _ = situation.pose(support).position
    reach_x, reach_y, _ = situation.half(support)
    z = situation.top(support) + half[2]
    dx, dy = max(reach_x - MARGIN, 0.0), max(reach_y - MARGIN, 0.0)
    return Volume((x - dx, y - dy, z), (x + dx, y + dy, z))


ON_TOP = Predicate(name="on_top", distance=_distance, volume=_volume, sentence=states("{0} {is} on {1}"))
