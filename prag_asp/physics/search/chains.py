"""Room for what has no place yet: an object left of one that is left of a third keeps both apart.

Objects get their places one after another. What stands between two of them by the relations needs room there, whichever
of the three comes last.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from typing import NamedTuple

from prag_asp.physics.predicates import Direction, Volume
from prag_asp.physics.predicates.beside import GAP, MARGIN, SIDES, wedge
from prag_asp.physics.situation import Situation
from prag_asp.physics.symbolic_facts import Fact
from prag_asp.scene.geometry import Quaternion, extents


class Chain(NamedTuple):
    """An object that has a place, the direction in which another lies from it, what is between them in metres."""

    end: str
    side: Direction
    between: float


Links = tuple[tuple[str, str], ...]
"""Pairs of objects of which the first lies in a direction from the second."""


def chains(situation: Situation, entity: str, facts: Iterable[Fact]) -> tuple[list[Chain], ...]:
    """Return the chains of relations from an object through others without a place to ones that have one.

    Nothing where all others have their places; else twice: with the longest sides of what is between, and with the
    shortest.
    """
    beside = [fact for fact in facts if fact.value and fact.predicate.direction is not None]
    if all(other in situation.poses or other == entity for fact in beside for other in fact.arguments):
        return ()
    links = {side.seen(situation.scene.frame): tuple(_links(beside, side)) for side in SIDES.values()}
    return tuple(_longest(situation, entity, links, wide) for wide in (True, False))


def kept_apart(situation: Situation, entity: str, quaternion: Quaternion, found: Iterable[Chain]) -> Volume:
    """Return where an object, turned by a rotation about z, leaves room for what is between it and others."""
    volume = Volume()
    half = extents(situation.shape(entity), quaternion)
    for end, side, between in found:
        volume = volume.meet(wedge(situation, side, end, half, GAP + MARGIN + between))
    return volume


def _longest(situation: Situation, entity: str, links: Mapping[Direction, Links], wide: bool) -> list[Chain]:
    """Return of the chains to each end the longest in each direction."""
    found: dict[tuple[str, Direction], float] = {}
    for side, pairs in links.items():
        for end, between in _follow(situation, entity, pairs, wide, ()):
            found[end, side] = max(between, found.get((end, side), 0.0))
    return [Chain(end, side, between) for (end, side), between in found.items()]


def _links(beside: Iterable[Fact], side: Direction) -> Iterator[tuple[str, str]]:
    """Yield pairs of which the first lies in a direction from the second."""
    for fact in beside:
        one, two = fact.arguments
        if fact.predicate.direction == side:
            yield one, two
        elif fact.predicate.direction == side.opposite:
            yield two, one


def _follow(
    situation: Situation, entity: str, links: Links, wide: bool, passed: tuple[str, ...]
) -> Iterator[tuple[str, float]]:
    """Yield the ends of the chains that lead on from an object, and what is between in metres."""
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
