"""Leave room for objects that are placed later: beside an object, or on the same support.

An object is kept away from the border of the workspace if another object will be placed beside it later. This only
guides sampling; all checks remain the same.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping

from prag_asp.physics.predicates import Direction, Volume
from prag_asp.physics.predicates.beside import GAP, MARGIN
from prag_asp.physics.symbolic_facts import Fact, PhysicalTask
from prag_asp.scene.scene import Scene

Foresight = Mapping[tuple[int, str], tuple[Volume, ...]]
"""For each state and object, the volumes in which the object, placed in the state, leaves ample room or just enough
room."""

LaterPuts = Mapping[tuple[int, str], tuple[tuple[str, tuple[Fact, ...]], ...]]
"""For each put of an object on or into a body on which the task puts several objects, given by the state and the
object: the objects that the task puts there later, each with the facts of the state after that put."""

Rooms = dict[Direction, float]


def foresee(physical: PhysicalTask, scene: Scene) -> Foresight:
    """Return the volumes for the objects of a task that leave room for objects placed beside them later."""
    volumes_by_object: dict[tuple[int, str], tuple[Volume, ...]] = {}
    begun = [_named(effect.fresh) for effect in physical.effects]
    for k in range(len(physical.states)):
        concerned = set().union(*begun[k:], _named(physical.initial) if k == 0 else ())
        for entity in physical.objects if k == 0 else physical.effects[k - 1].moved:
            if entity in concerned and entity not in scene.fixed:
                volumes = [_volume(scene, _rooms(physical, scene, k, entity, wide)) for wide in (True, False)]
                if any(volume != Volume() for volume in volumes):
                    volumes_by_object[k, entity] = tuple(volumes)
    return volumes_by_object


def foresee_puts(physical: PhysicalTask, scene: Scene) -> LaterPuts:
    """Return, for each put of a task on or into a body other than the table or a zone, the later puts on this body.

    The list ends before the next put of an object that is already in it, because that object is taken away first and
    makes room.
    """
    puts: dict[str, list[tuple[int, str]]] = {}
    for effect in physical.effects:
        for fact in effect.fresh:
            entity, place = fact.arguments[0], fact.arguments[-1]
            bounded = place in scene.shapes and not scene.shapes[place].traits.surface
            if fact.value and fact.predicate.places and entity in effect.moved and bounded:
                puts.setdefault(place, []).append((effect.number, entity))
    later: dict[tuple[int, str], tuple[tuple[str, tuple[Fact, ...]], ...]] = {}
    for there in puts.values():
        for i, (number, entity) in enumerate(there if len(there) > 1 else ()):
            listed = {entity: physical.effects[number - 1].after}
            for then, comer in there[i + 1 :]:
                if comer in listed:
                    break
                listed[comer] = physical.effects[then - 1].after
            later[number, entity] = tuple(listed.items())[1:]
    return later


def _named(facts: Iterable[Fact]) -> set[str]:
    """Return the objects in facts whose predicates have a direction."""
    return {entity for fact in facts if fact.value and fact.predicate.direction for entity in fact.arguments}


def _rooms(physical: PhysicalTask, scene: Scene, k: int, entity: str, wide: bool, depth: int = 0) -> Rooms:
    """Return the room in metres that an object placed in state `k` needs on each side."""
    rooms: Rooms = {}
    for j, comer, direction in _later(physical, scene, k, entity):
        if comer in scene.fixed or depth > len(physical.effects):
            continue
        side = direction.in_frame(scene.frame)
        radius = scene.shapes[comer].breadth(wide) / 2
        beyond = _rooms(physical, scene, j, comer, wide, depth + 1).get(side) if j > k else None
        room = GAP + 2 * MARGIN + radius + (0.0 if beyond is None else radius + beyond)
        rooms[side] = max(room, rooms.get(side, 0.0))
    return rooms


def _later(physical: PhysicalTask, scene: Scene, k: int, entity: str) -> Iterator[tuple[int, str, Direction]]:
    """Yield each object placed beside `entity` in state `k` or later: the state, the object and its direction.

    After the initial state, an object that is moved onto or into another object takes no room beside that object.
    """
    if k == 0:
        yield from ((0, *beside) for beside in _beside(physical.initial, entity))
    for j in range(k, len(physical.effects)):
        effect = physical.effects[j]
        if entity in (*effect.moved, effect.grasps, effect.releases):
            return
        lifted = {
            fact.arguments[0]
            for fact in effect.after
            if fact.value and fact.predicate.supports and not scene.shapes[fact.arguments[-1]].traits.surface
        }
        for comer, direction in _beside(effect.fresh, entity):
            if comer in effect.moved and comer not in lifted:
                yield j + 1, comer, direction


def _beside(facts: Iterable[Fact], entity: str) -> Iterator[tuple[str, Direction]]:
    """Yield each object that facts put beside `entity`, with its direction from `entity` as seen by the robot."""
    for fact in facts:
        direction = fact.predicate.direction
        if fact.value and direction is not None and entity in fact.arguments:
            subject, other = fact.arguments
            yield (subject, direction) if other == entity else (other, direction.opposite)


def _volume(scene: Scene, rooms: Rooms) -> Volume:
    """Return the part of the workspace that leaves the given room."""
    low, high = [-math.inf] * 3, [math.inf] * 3
    for (axis, sign), room in rooms.items():
        if sign > 0:
            high[axis] = scene.workspace[2 * axis + 1] - room
        else:
            low[axis] = scene.workspace[2 * axis] + room
    return Volume((low[0], low[1], low[2]), (high[0], high[1], high[2]))
