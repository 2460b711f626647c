"""Place two objects far enough apart for an object that lies between them, now or later.

This only guides sampling; all checks remain the same.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import NamedTuple

from prag_asp.physics.predicates.between import GAP, MARGIN
from prag_asp.physics.symbolic_facts import Fact, PhysicalTask
from prag_asp.scene.scene import Scene

FINGER_ROOM = 0.035
"""The distance between two objects that leaves room for a finger, in metres."""

DEPTH = 4
"""The maximum nesting depth of objects that lie between others."""


class Span(NamedTuple):
    """The desired distance between the centres of two objects, in metres: with room for a finger, or without."""

    other: str
    ample: float
    enough: float


Spans = Mapping[tuple[int, str], tuple[Span, ...]]
"""The spans of each object that is placed in a state, by the number of the state and the object."""


def foresee_spans(physical: PhysicalTask, scene: Scene) -> Spans:
    """Return the desired distances between the objects of a task, to leave room for objects that come between them."""
    all_facts = [*physical.initial, *(fact for effect in physical.effects for fact in effect.fresh)]
    if not any(fact.value and fact.predicate.lies_between for fact in all_facts):
        return {}
    spans_by_object: dict[tuple[int, str], tuple[Span, ...]] = {}
    for k in range(len(physical.states)):
        for entity in physical.objects if k == 0 else physical.effects[k - 1].moved:
            spans = tuple(
                Span(other, *(_span(physical, scene, k, (entity, other), wide) for wide in (True, False)))
                for other in physical.objects
                if other != entity and any(_between(physical, k, (entity, other)))
            )
            if spans:
                spans_by_object[k, entity] = spans
    return spans_by_object


def _span(physical: PhysicalTask, scene: Scene, k: int, pair: tuple[str, str], wide: bool, depth: int = 0) -> float:
    """Return the desired distance between the centres of two objects in state `k`, in metres."""
    one, two = pair
    need = scene.shapes[one].breadth(wide) / 2 + scene.shapes[two].breadth(wide) / 2
    need += FINGER_ROOM if wide else GAP + 2 * MARGIN
    if depth < DEPTH:
        for i, fact in _between(physical, k, pair):
            inner = fact.arguments[0]
            parts = ((one, inner), (inner, two))
            need = max(need, sum(_span(physical, scene, i, part, wide, depth + 1) for part in parts))
    return need


def _between(physical: PhysicalTask, k: int, pair: tuple[str, str]) -> Iterator[tuple[int, Fact]]:
    """Yield each fact that puts an object between two others, with its state, while the two rest as in state `k`."""
    if k == 0:
        yield from ((0, fact) for fact in physical.initial if _parts(fact, pair))
    for j in range(k, len(physical.effects)):
        effect = physical.effects[j]
        if not {*effect.moved, effect.grasps, effect.releases}.isdisjoint(pair):
            return
        yield from ((j + 1, fact) for fact in effect.fresh if _parts(fact, pair))


def _parts(fact: Fact, pair: tuple[str, str]) -> bool:
    """Return whether a fact puts an object between the two objects of a pair."""
    return fact.value and fact.predicate.lies_between and {*fact.arguments[1:]} == {*pair}
