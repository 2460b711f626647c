"""The region that the facts of a state allow for one object: volumes, yaw ranges, and facts still to be checked."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from prag_asp.physics.predicates import Volume, Yaws, predicate_of
from prag_asp.physics.search.attempt import EMPTY_VOLUME, Failure, Search
from prag_asp.physics.situation import Situation
from prag_asp.physics.symbolic_facts import Fact
from prag_asp.scene.geometry import IDENTITY, Quaternion

AIM = 0.6
"""The share of a yaw range that is sampled, because an object may rotate a little when it is put down."""


def relevant_facts(facts: Iterable[Fact], entity: str, situation: Situation) -> list[Fact]:
    """Return the facts about an object that do not concern grippers and whose other bodies are already placed."""
    shapes, placed = situation.scene.shapes, {*situation.poses, entity}
    return [
        fact
        for fact in facts
        if entity in fact.arguments
        and not fact.predicate.of_gripper
        and not any(name in shapes and shapes[name].traits.body and name not in placed for name in fact.arguments)
    ]


def shapes_volume(fact: Fact, entity: str) -> bool:
    """Return whether the volume of a fact or its inverse for an object expresses the fact exactly."""
    subject = fact.arguments[fact.predicate.subject]
    return fact.value and (subject == entity or fact.predicate.inverse is not None)


def allowed_volume(situation: Situation, fact: Fact, entity: str, quaternion: Quaternion) -> Volume:
    """Return the volume that a fact allows for an oriented object; the fact has to satisfy `shapes_volume`."""
    predicate, arguments = fact.predicate, fact.arguments
    if arguments[predicate.subject] == entity:
        return predicate.volume(situation, arguments, quaternion)
    inverse = predicate_of(situation.scene, str(predicate.inverse))
    return inverse.volume(situation, arguments[::-1], quaternion)


def yaw_ranges(situation: Situation, entity: str, facts: Iterable[Fact]) -> tuple[Yaws, ...] | None:
    """Return the yaw ranges that facts allow for an object, or None if they allow any yaw.

    Raises:
        Failure: the facts allow no yaw.
    """
    volume = Volume()
    for fact in facts:
        if fact.predicate.turns and shapes_volume(fact, entity):
            volume = volume.meet(allowed_volume(situation, fact, entity, IDENTITY))
    if volume.yaws == ():
        raise Failure(EMPTY_VOLUME, entity)
    return volume.yaws


def sample_yaws(search: Search, ranges: tuple[Yaws, ...]) -> Iterator[float]:
    """Yield a random yaw in radians from each range, beginning with a random range."""
    first = 0 if len(ranges) == 1 else int(search.rng.integers(len(ranges)))
    for chosen in (*ranges[first:], *ranges[:first]):
        yield chosen.centre + search.uniform(-AIM * chosen.half, AIM * chosen.half)
