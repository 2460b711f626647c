"""Leave room between two objects for an unplaced object that will be left of one of them and right of the other.

Objects are placed one after another. An object whose relations put it between two others needs room there, whichever of
the three is placed last.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import NamedTuple

from prag_asp.physics.extent import extent
from prag_asp.physics.predicates import Direction, Volume
from prag_asp.physics.predicates.beside import GAP, MARGIN, SIDES, wedge
from prag_asp.physics.predicates.volume import opposite
from prag_asp.physics.situation import Situation
from prag_asp.physics.symbolic_facts import Fact
from prag_asp.scene.geometry import Quaternion


class SpacingChain(NamedTuple):
    """A placed object, the direction from it to another object, and the room in metres for objects in between."""

    end: str
    side: Direction
    between: float


def spacing_chains(situation: Situation, entity: str, facts: Iterable[Fact]) -> tuple[list[SpacingChain], ...]:
    """Return the chains of relations from an object through unplaced objects to placed ones.

    There are no chains if all other objects are placed. Otherwise there are two lists: one computed with the longest
    sides of the objects in between, and one with their shortest sides.
    """
    beside = [fact for fact in facts if fact.value and fact.predicate.direction is not None]
    if all(other in situation.poses or other == entity for fact in beside for other in fact.arguments):
        return ()
    longest: tuple[dict[tuple[str, Direction], float], ...] = ({}, {})
    for side in SIDES.values():
        links = []
        for fact in beside:
            one, two = fact.arguments
            if fact.predicate.direction == side:
                links.append((one, two))
            elif fact.predicate.direction == side.opposite:
                links.append((two, one))
        for chains, wide in zip(longest, (True, False), strict=True):
            for end, between in _follow(situation, entity, links, wide, ()):
                key = (end, side.in_frame(situation.scene.frame))
                chains[key] = max(between, chains.get(key, 0.0))
    return tuple([SpacingChain(*key, between) for key, between in chains.items()] for chains in longest)


def spacing_volume(situation: Situation, entity: str, quaternion: Quaternion, chains: Iterable[SpacingChain]) -> Volume:
    """Return the volume in which an oriented object leaves room for the objects between it and others."""
    volume = Volume()
    centre, half = extent(situation.shape(entity), quaternion)
    for end, side, between in chains:
        volume = volume.meet(wedge(situation, side, end, half, GAP + MARGIN + between))
    return volume.moved(opposite(centre))


def _follow(
    situation: Situation, entity: str, links: Iterable[tuple[str, str]], wide: bool, passed: tuple[str, ...]
) -> Iterator[tuple[str, float]]:
    """Yield the ends of the chains from an object, and the room in metres for the objects in between.

    `links` are pairs of objects; the first lies in the direction of the chains from the second.
    """
    for one, other in links:
        if one != entity or other in passed:
            continue
        if other in situation.poses:
            if passed:
                yield other, 0.0
            continue
        room = situation.shape(other).breadth(wide) + GAP + 2 * MARGIN
        for end, between in _follow(situation, other, links, wide, (*passed, entity)):
            yield end, between + room
