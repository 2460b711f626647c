"""``near`` and ``far``: the width of the gap between two bodies seen from above.

The gap is the horizontal distance between their axis-aligned bounding boxes, or 0 if one body is above the other. It is
at most `NEAR` metres for ``near``, and at least `FAR` metres for ``far``. Both predicates are symmetric.
"""

from __future__ import annotations

import math

from prag_asp.physics.extent import extent
from prag_asp.physics.predicates.predicate import Arguments, Predicate, states
from prag_asp.physics.predicates.volume import Ring, Volume
from prag_asp.physics.situation import Situation
from prag_asp.scene.geometry import Quaternion

NEAR, FAR = 0.10, 0.25
MARGIN = 0.003


def _gap(situation: Situation, arguments: Arguments) -> float:
    """Return the gap between two bodies in metres."""
    one, two = situation.body(arguments[0]), situation.body(arguments[1])
    (ax, ay, _), (bx, by, _) = one.centre, two.centre
    dx, dy = abs(ax - bx) - one.half[0] - two.half[0], abs(ay - by) - one.half[1] - two.half[1]
    return math.hypot(max(0.0, dx), max(0.0, dy))


def _around(situation: Situation, arguments: Arguments, quaternion: Quaternion, gaps: tuple[float, float]) -> Ring:
    """Return the region for the subject in which the gap is between two bounds in metres."""
    subject, other = arguments
    (x, y, _), half = situation.body(other).centre, situation.half(other)
    (dx, dy, _), own = extent(situation.shape(subject), quaternion)
    return Ring(x - dx, y - dy, *gaps, own[0] + half[0], own[1] + half[1])


def _near_volume(situation: Situation, arguments: Arguments, quaternion: Quaternion) -> Volume:
    """Return the region around the other body."""
    ring = _around(situation, arguments, quaternion, (0.0, NEAR - MARGIN))
    dx, dy = ring.half_x + ring.outer, ring.half_y + ring.outer
    low, high = (ring.x - dx, ring.y - dy, -math.inf), (ring.x + dx, ring.y + dy, math.inf)
    return Volume(low, high, rings=(ring,))


NEAR_TO = Predicate(
    name="near",
    violations=lambda situation, arguments: iter([_gap(situation, arguments) - NEAR]),
    volume=_near_volume,
    sentence=states("{0} {is} near {1}"),
    inverse="near",
    apart=(0.0, NEAR),
    caption_rank=130,
)
FAR_FROM = Predicate(
    name="far",
    violations=lambda situation, arguments: iter([FAR - _gap(situation, arguments)]),
    volume=lambda situation, arguments, quaternion: Volume(
        rings=(_around(situation, arguments, quaternion, (FAR + MARGIN, math.inf)),)
    ),
    sentence=states("{0} {is} far from {1}"),
    inverse="far",
    apart=(FAR, math.inf),
    caption_rank=140,
)

PREDICATES = {"near": NEAR_TO, "far": FAR_FROM}
