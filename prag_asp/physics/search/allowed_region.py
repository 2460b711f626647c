"""What the facts of a state leave to one object: the volume of each, its yaws, and what is left to check."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from prag_asp.physics.predicates import Volume, Yaws, predicate_of
from prag_asp.physics.search.attempt import EMPTY_VOLUME, Failure, Search
from prag_asp.physics.situation import Situation
from prag_asp.physics.symbolic_facts import Fact
from prag_asp.scene.geometry import IDENTITY, Pose, Quaternion

AIM = 0.6
"""What share of a tolerance of the heading is drawn from: what is put down may turn a little."""


def relevant(facts: Iterable[Fact], entity: str, situation: Situation) -> list[Fact]:
    """Return the facts about an object whose other bodies have their places; the gripper's are left out."""
    return [
        fact
        for fact in facts
        if entity in fact.arguments
        and not fact.predicate.of_gripper
        and all(_has_place(situation, other) for other in fact.arguments if other != entity)
    ]


def shapes_volume(fact: Fact, entity: str) -> bool:
    """Tell whether a fact is one that the volume of an object expresses exactly."""
    subject = fact.arguments[fact.predicate.subject]
    return fact.value and (subject == entity or fact.predicate.inverse is not None)


def allowed(situation: Situation, fact: Fact, entity: str, quaternion: Quaternion) -> Volume:
    """Return where an object, turned as it will be, may be by a fact that its volume expresses."""
    predicate, arguments = fact.predicate, fact.arguments
    if arguments[predicate.subject] == entity:
        return predicate.volume(situation, arguments, quaternion)
    inverse = predicate_of(situation.scene, str(predicate.inverse))
    return inverse.volume(situation, arguments[::-1], quaternion)


def yaw_ranges(situation: Situation, entity: str, facts: Iterable[Fact]) -> tuple[Yaws, ...] | None:
    """Return the ranges of yaws that facts allow an object, None where any will do.

    Raises:
        Failure: no yaw is left.
    """
    volume = Volume()
    for fact in facts:
        if fact.predicate.turns and shapes_volume(fact, entity):
            volume = volume.meet(allowed(situation, fact, entity, IDENTITY))
    if volume.yaws == ():
        raise Failure(EMPTY_VOLUME, entity)
    return volume.yaws


def draw_yaws(search: Search, ranges: tuple[Yaws, ...]) -> Iterator[float]:
    """Draw a yaw in radians of each of some ranges, of any of them first."""
    first = 0 if len(ranges) == 1 else int(search.rng.integers(len(ranges)))
    for chosen in (*ranges[first:], *ranges[:first]):
        yield chosen.centre + search.uniform(-AIM * chosen.half, AIM * chosen.half)


def unsatisfied(facts: Iterable[Fact], situation: Situation, entity: str, pose: Pose) -> Fact | None:
    """Return a fact that would not hold with an object at a pose, None where all would."""
    facts = list(facts)
    if not facts:
        return None
    trial = situation.with_pose(entity, pose)
    return next((fact for fact in facts if not fact.satisfied(trial)), None)


def _has_place(situation: Situation, entity: str) -> bool:
    """Tell whether an argument of a fact needs no place of its own or has it."""
    shape = situation.scene.shapes.get(entity)
    return shape is None or not shape.traits.body or entity in situation.poses
