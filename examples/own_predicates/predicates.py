"""``looks_at``: the x axis of a body points at the centre of another, up to `TOLERANCE`, seen from above."""

from __future__ import annotations

import math
from collections.abc import Iterator

from prag_asp.physics import Predicate, Quaternion, Side, Situation, Volume, states, yaw_of

TOLERANCE, MARGIN = math.radians(15), math.radians(1)


def _violations(situation: Situation, arguments: tuple[str, ...]) -> Iterator[float]:
    """Yield by how many radians the direction to the other body is off, beyond the tolerance."""
    pose, other = situation.pose(arguments[0]), situation.pose(arguments[1])
    dx, dy = other.position[0] - pose.position[0], other.position[1] - pose.position[1]
    yield abs(math.remainder(math.atan2(dy, dx) - yaw_of(pose.quaternion), math.tau)) - TOLERANCE


def _volume(situation: Situation, arguments: tuple[str, ...], quaternion: Quaternion) -> Volume:
    """Return the wedge from which a body that is turned like this looks at the other one: two half planes."""
    x, y, _ = situation.pose(arguments[1]).position
    sides = []
    for turn in (1.0, -1.0):
        edge = yaw_of(quaternion) + turn * (TOLERANCE - MARGIN)
        a, b = turn * -math.sin(edge), turn * math.cos(edge)
        sides.append(Side(-a, -b, -a * x - b * y - 1e-3))
    return Volume(sides=tuple(sides))


PREDICATES = {
    "looks_at": Predicate(
        name="looks_at",
        violations=_violations,
        volume=_volume,
        sentence=states("{0} {is} looking at {1}"),
    ),
}
