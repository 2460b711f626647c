"""Room for what has no place yet: an object left of one that is left of a third keeps both apart.

Objects get their places one after another. What stands between two of them by the relations needs room there, whichever
of the three comes last.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from typing import NamedTuple

from prag_asp.physics.facts import Fact
from prag_asp.physics.predicates import Volume
from prag_asp.physics.predicates.beside import DIRECTIONS, GAP, MARGIN, direction, wedge
from prag_asp.physics.situation import Situation
from prag_asp.scene.geometry import Quaternion, extents


class Chain(NamedTuple):
    """An object that has a place, the direction in which another lies from it, what is between them in metres."""

    end: str
    name: str
    between: float


def chains(situation: Situation, entity: str, facts: Iterable[Fact]) -> tuple[list[Chain], ...]:
    """Return the chains of relations from an object through others without a place to ones that have one.

    Nothing where all others have their places; else twice: with the longest sides of what is between, and with the
    shortest.
    """
    beside = [fact for fact in facts if fact.value and fact.predicate.name in DIRECTIONS]
    if all(other in situation.poses or other == entity for fact in beside for other in fact.arguments):
        return ()
    links = {name: list(_links(beside, name, situation.scene.frame)) for name in DIRECTIONS}
    return tuple(_longest(situation, entity, links, wide) for wide in (True, False))


def kept_apart(situation: Situation, entity: str, quaternion: Quaternion, found: Iterable[Chain]) -> Volume:
    """Return where an object, turned by a rotation about z, leaves room for what is between it and others."""
    volume = Volume()
    half = extents(situation.shape(entity), quaternion)
    for end, name, between in found:
        volume = volume.meet(wedge(situation, name, end, half, GAP + MARGIN + between))
    return volume


def _longest(situation: Situation, entity: str, links: Mapping[str, list[tuple[str, str]]], wide: bool) -> list[Chain]:
    """Return of the chains to each end the longest in each direction."""
    found: dict[tuple[str, str], float] = {}
    for name, pairs in links.items():
        for end, between in _follow(situation, entity, pairs, wide, ()):
            found[end, name] = max(between, found.get((end, name), 0.0))
    return [Chain(end, name, between) for (end, name), between in found.items()]


def _links(beside: Iterable[Fact], name: str, frame: str) -> Iterator[tuple[str, str]]:
    """Yield pairs of which the first lies in a direction from the second."""
    axis, sign = direction(name, frame)
    for fact in beside:
        other_axis, other_sign = direction(fact.predicate.name, frame)
        if other_axis == axis:
            one, two = fact.arguments
            yield (one, two) if other_sign == sign else (two, one)


def _follow(
    situation: Situation, entity: str, links: list[tuple[str, str]], wide: bool, passed: tuple[str, ...]
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
