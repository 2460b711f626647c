"""Room for what comes later: an object beside which another will be put is kept off the border of the workspace.

This only steers draws; every check stays as it is.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping

from prag_asp.physics.facts import SUPPORTING, Effect, Fact, PhysicalTask
from prag_asp.physics.predicates import Volume
from prag_asp.physics.predicates.beside import DIRECTIONS, GAP, INVERSES, MARGIN, direction
from prag_asp.scene.model import Scene

Foresight = Mapping[tuple[int, str], tuple[Volume, ...]]
"""For a state and an object that comes to its place in it: where all of it leaves ample room, then just enough."""

Side = tuple[int, float]
Rooms = dict[Side, float]


def foresee(physical: PhysicalTask, scene: Scene) -> Foresight:
    """Return where the objects of a task should be put so that there is room for what is put beside them later."""
    found: dict[tuple[int, str], tuple[Volume, ...]] = {}
    begun = [_named(effect.fresh) for effect in physical.effects]
    for k in range(len(physical.states)):
        concerned = set().union(*begun[k:], _named(physical.initial) if k == 0 else ())
        for entity in physical.objects if k == 0 else physical.effects[k - 1].moved:
            if entity in concerned and entity not in scene.fixed:
                volumes = [_volume(scene, _rooms(physical, scene, k, entity, wide)) for wide in (True, False)]
                if any(volume != Volume() for volume in volumes):
                    found[k, entity] = tuple(volumes)
    return found


def _named(facts: Iterable[Fact]) -> set[str]:
    """Return the objects that facts put beside others, or beside which they put others."""
    return {entity for fact in facts if fact.value and fact.predicate.name in DIRECTIONS for entity in fact.arguments}


def _rooms(physical: PhysicalTask, scene: Scene, k: int, entity: str, wide: bool, depth: int = 0) -> Rooms:
    """Return how many metres there should be between an object put down in state `k` and each side."""
    rooms: Rooms = {}
    for j, fact in _later(physical, scene, k, entity):
        name, (subject, other) = fact.predicate.name, fact.arguments
        comer, side = (subject, name) if other == entity else (other, INVERSES[name])
        if comer in scene.fixed or depth > len(physical.effects):
            continue
        axis, sign = direction(side, scene.frame)
        radius = scene.shapes[comer].breadth(wide) / 2
        beyond = _rooms(physical, scene, j, comer, wide, depth + 1).get((axis, sign)) if j > k else None
        room = GAP + 2 * MARGIN + radius + (0.0 if beyond is None else radius + beyond)
        rooms[axis, sign] = max(room, rooms.get((axis, sign), 0.0))
    return rooms


def _later(physical: PhysicalTask, scene: Scene, k: int, entity: str) -> Iterator[tuple[int, Fact]]:
    """Yield the relations of other objects to one that rests since state `k`, with the state that begins each."""
    if k == 0:
        yield from ((0, fact) for fact in physical.initial if _beside(fact, entity))
    for j in range(k, len(physical.effects)):
        effect = physical.effects[j]
        if entity in (*effect.moved, effect.grasps, effect.releases):
            return
        for fact in effect.fresh:
            if _beside(fact, entity) and _comes_to_table(scene, effect, fact, entity):
                yield j + 1, fact


def _beside(fact: Fact, entity: str) -> bool:
    """Tell whether a fact puts another object beside one."""
    return fact.value and fact.predicate.name in DIRECTIONS and entity in fact.arguments


def _comes_to_table(scene: Scene, effect: Effect, fact: Fact, entity: str) -> bool:
    """Tell whether the other object of a fact is moved by an action, and not onto or into another object."""
    other = fact.arguments[0] if fact.arguments[1] == entity else fact.arguments[1]
    supports = [
        each.arguments[1]
        for each in effect.after
        if each.value and each.predicate.name in SUPPORTING and each.arguments[0] == other
    ]
    return other in effect.moved and all(scene.shapes[support].traits.surface for support in supports)


def _volume(scene: Scene, rooms: Rooms) -> Volume:
    """Return the part of the workspace that leaves room."""
    low, high = [-math.inf] * 3, [math.inf] * 3
    for (axis, sign), room in rooms.items():
        if sign > 0:
            high[axis] = scene.workspace[2 * axis + 1] - room
        else:
            low[axis] = scene.workspace[2 * axis] + room
    return Volume((low[0], low[1], low[2]), (high[0], high[1], high[2]))
