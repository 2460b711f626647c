"""``upright``: the z axis of a body is vertical within `TOLERANCE`; a ball is always upright."""

from __future__ import annotations

import math
from collections.abc import Iterator

from prag_asp.physics.predicates.predicate import Arguments, Predicate, states
from prag_asp.physics.predicates.volume import Volume
from prag_asp.physics.situation import Situation
from prag_asp.scene.geometry import rotate

TOLERANCE = math.radians(10)


def _violations(situation: Situation, arguments: Arguments) -> Iterator[float]:
    """Yield the angle in radians by which the tilt of the body exceeds the tolerance."""
    if situation.shape(arguments[0]).traits.flat:
        x, y, z = rotate(situation.pose(arguments[0]).quaternion, (0.0, 0.0, 1.0))
        yield math.atan2(math.hypot(x, y), z) - TOLERANCE
    else:
        yield -TOLERANCE


UPRIGHT = Predicate(
    name="upright",
    violations=_violations,
    # A body that is only rotated about z is upright anywhere.
    volume=lambda situation, arguments, quaternion: Volume(),
    sentence=states("{0} {is} upright"),
    on_the_spot=True,
    caption_rank=150,
)

PREDICATES = {"upright": UPRIGHT}
