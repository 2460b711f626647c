"""``is_open`` and ``is_closed``: the position of the joint of a drawer (metres) or of a door (radians).

Furniture is open if the joint is at least at the share `OPEN` of its range, and closed if it is at most at `CLOSED`.
"""

from __future__ import annotations

from prag_asp.physics.predicates.predicate import Arguments, Predicate, states
from prag_asp.physics.predicates.volume import Volume
from prag_asp.physics.situation import Situation
from prag_asp.scene.furniture import mechanism
from prag_asp.scene.geometry import Quaternion

OPEN, CLOSED = 0.9, 0.05
OPEN_MARGIN, CLOSED_MARGIN = 0.05, 0.03


def _limit(situation: Situation, furniture: str) -> float:
    """Return the upper limit of a furniture joint, in metres or radians."""
    return mechanism(situation.shape(furniture)).limit


def _open_volume(situation: Situation, arguments: Arguments, quaternion: Quaternion) -> Volume:
    """Return the openings that count as open."""
    most = _limit(situation, arguments[0])
    return Volume(opening=((OPEN + OPEN_MARGIN) * most, most))


def _closed_volume(situation: Situation, arguments: Arguments, quaternion: Quaternion) -> Volume:
    """Return the openings that count as closed."""
    return Volume(opening=(0.0, (CLOSED - CLOSED_MARGIN) * _limit(situation, arguments[0])))


IS_OPEN = Predicate(
    name="is_open",
    violations=lambda situation, arguments: iter(
        [OPEN * _limit(situation, arguments[0]) - situation.opening(arguments[0])]
    ),
    volume=_open_volume,
    sentence=states("{0} {is} open"),
    of_joint=True,
    otherwise=_closed_volume,
    caption_rank=160,
)
IS_CLOSED = Predicate(
    name="is_closed",
    violations=lambda situation, arguments: iter(
        [situation.opening(arguments[0]) - CLOSED * _limit(situation, arguments[0])]
    ),
    volume=_closed_volume,
    sentence=states("{0} {is} closed"),
    of_joint=True,
    otherwise=_open_volume,
    caption_rank=170,
)

PREDICATES = {"is_open": IS_OPEN, "is_closed": IS_CLOSED}
