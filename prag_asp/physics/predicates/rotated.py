"""``rotated``: the yaw of a body equals the yaw of a named rotation of the scene, within `TOLERANCE`."""

from __future__ import annotations

import math
from collections.abc import Iterator

from prag_asp.errors import SceneError
from prag_asp.physics.predicates.predicate import Arguments, Predicate, states, words
from prag_asp.physics.predicates.volume import Volume, Yaws
from prag_asp.physics.situation import Situation
from prag_asp.scene.geometry import wrap, yaw_of
from prag_asp.scene.scene import Scene

TOLERANCE = math.radians(10)
MARGIN = math.radians(0.5)


def target_yaw(situation: Situation, rotation: str) -> float:
    """Return the yaw in radians that the scene assigns to a rotation.

    Raises:
        SceneError: the scene assigns no yaw to the rotation.
    """
    yaw = situation.scene.rotations.get(rotation)
    if yaw is None:
        raise SceneError(f"{rotation} has no yaw; give it one in degrees under [scene.rotations]")
    return yaw


def _violations(situation: Situation, arguments: Arguments) -> Iterator[float]:
    """Yield the angle in radians by which the error of the yaw exceeds the tolerance."""
    yaw = yaw_of(situation.pose(arguments[0]).quaternion)
    yield abs(wrap(yaw - target_yaw(situation, arguments[1]))) - TOLERANCE


def _excludes(scene: Scene, arguments: Arguments, other: Predicate, others: Arguments) -> str | None:
    """Return a reason if the body would have two different yaws; otherwise None."""
    if other.name != "rotated" or others[0] != arguments[0]:
        return None
    entity, one, two = *arguments, others[1]
    if abs(wrap(scene.rotations[two] - scene.rotations[one])) <= 2 * TOLERANCE:
        return None
    return f"{words(entity)} cannot be turned {words(one)} and {words(two)} at once"


ROTATED = Predicate(
    name="rotated",
    violations=_violations,
    volume=lambda situation, arguments, quaternion: Volume(
        yaws=(Yaws(target_yaw(situation, arguments[1]), TOLERANCE - MARGIN),)
    ),
    sentence=states("{0} {is} turned {1}"),
    turns=True,
    on_the_spot=True,
    excludes=_excludes,
    caption_rank=70,
)

PREDICATES = {"rotated": ROTATED}
