"""``on_top``: a body stands on another, with its centre above the other's top; nothing rests on a ball.

The top of a body with a model is the convex outline of its highest points.
"""

from __future__ import annotations

import math
from collections.abc import Iterator

from prag_asp.physics.extent import extent
from prag_asp.physics.predicates.gaps import ORIGIN, Demand, Z, above, along, between, bottom, centre, top
from prag_asp.physics.predicates.predicate import Arguments, Predicate, states, words
from prag_asp.physics.predicates.volume import Ring, Volume, over_polygon, over_rectangle
from prag_asp.physics.situation import Situation
from prag_asp.scene.geometry import Quaternion, crown, extents, heading, inside_by, to_local, yaw_quaternion
from prag_asp.scene.scene import Scene

TOLERANCE = 0.002
MARGIN = 0.004


def _violations(situation: Situation, arguments: Arguments) -> Iterator[float]:
    """Yield the distances in metres of the body from the height of the top, and of its centre beyond the edge."""
    subject, support = arguments
    above, below = situation.body(subject), situation.body(support)
    yield abs(above.low[2] - below.high[2]) - TOLERANCE
    x, y, _ = above.pose.position
    if situation.shape(support).model is not None:
        yield -inside_by(crown(situation.shape(support), below.pose), (x, y))
        return
    dx, dy = to_local(below.pose, x, y)
    half = situation.own_half(support)
    if situation.shape(support).traits.round:
        yield math.hypot(dx, dy) - half[0]
    else:
        yield abs(dx) - half[0]
        yield abs(dy) - half[1]


def _volume(situation: Situation, arguments: Arguments, quaternion: Quaternion) -> Volume:
    """Return the region above the support's top, at the height of the centre of a body that stands on it."""
    subject, support = arguments
    pose, half = situation.pose(support), situation.own_half(support)
    middle, (_, _, tall) = extent(situation.shape(subject), quaternion)
    z = situation.top(support) + tall - middle[2]
    if situation.shape(support).model is not None:
        return over_polygon(crown(situation.shape(support), pose), MARGIN, (z, z))
    dx, dy = (side - min(MARGIN, side / 2) for side in half[:2])
    if situation.shape(support).traits.round:
        x, y, _ = pose.position
        return Volume((x - dx, y - dx, z), (x + dx, y + dx, z), rings=(Ring(x, y, 0.0, dx),))
    return over_rectangle(pose.position, heading(pose.quaternion), (dx, dy), (z, z))


def _impossible(scene: Scene, arguments: Arguments) -> Iterator[str]:
    """Yield a reason if the support is a ball."""
    if not scene.shapes[arguments[1]].traits.flat:
        yield f"nothing rests on {words(arguments[1])}, which is a ball"


def _demands(scene: Scene, arguments: Arguments) -> Iterator[Demand]:
    """Yield the constraints for one body to stand on another with its centre above the other."""
    entity, support = arguments
    shape = scene.shapes[support]
    if shape.traits.surface:
        if shape.kind == "table":
            middle, half = scene.table.centre, (scene.table.size[0] / 2, scene.table.size[1] / 2)
        else:
            x, y, yaw = scene.fixed[support]
            middle, half = (x, y), extents(shape, yaw_quaternion(yaw))[:2]
        for axis in (0, 1):
            low, high = middle[axis] - half[axis], middle[axis] + half[axis]
            yield from along(axis, between(centre(entity), ORIGIN, low, high))
        yield from along(Z, between(bottom(entity), ORIGIN, -TOLERANCE, TOLERANCE))
        return
    yield from above(scene, entity, support, (shape.half[0], shape.half[1]))
    yield from along(Z, between(bottom(entity), top(support), -TOLERANCE, TOLERANCE))


ON_TOP = Predicate(
    name="on_top",
    violations=_violations,
    volume=_volume,
    sentence=states("{0} {is} on {1}"),
    supports=True,
    places=True,
    impossible=_impossible,
    demands=_demands,
    caption_rank=30,
)

PREDICATES = {"on_top": ON_TOP}
