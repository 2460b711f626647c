"""Proofs about two consecutive states: an action has to lift an object that slips out of the gripper.

A gripper may close around anything that it spans, but only lifting loads it. A witness lifts what it moves: the arm
retreats straight up from where it grasps an object, and comes straight down to where it releases it.
"""

from __future__ import annotations

from collections.abc import Iterator

from prag_asp.physics.predicates import PREDICATES
from prag_asp.physics.predicates.gripper import slips
from prag_asp.physics.symbolic_facts import ActionEffect, Fact, PhysicalTask
from prag_asp.scene.scene import Scene


def slip_reasons(physical: PhysicalTask, scene: Scene) -> Iterator[tuple[int, str, tuple[Fact, ...]]]:
    """Yield lifts of objects that slip in every size: the number of the next state, the reason, and the facts."""
    for number, effect in enumerate(physical.effects, 1):
        found = _lift(effect, physical.states[number - 1])
        if found is not None:
            _, held, _ = found
            robot, entity = held.arguments
            sizes = scene.ranges.get(entity, (scene.shapes[entity],))
            reasons = [slips(scene.with_shapes({entity: shape}), entity, robot) for shape in sizes]
            if reasons[0] is not None and None not in reasons:
                yield number, reasons[0], found


def _lift(effect: ActionEffect, before: tuple[Fact, ...]) -> tuple[Fact, Fact, Fact] | None:
    """Return the facts that an object is at a place, that it is held, and that it is no longer there; None if it stays.

    Only actions that move nothing but the object, and open nothing, leave the place itself still. An object in a
    handover may stay where it is.
    """
    entity = effect.grasps or effect.holds or effect.releases
    if effect.robot is None or entity is None or effect.giver or effect.turns or {*effect.moved} - {entity}:
        return None
    held = Fact(PREDICATES["holding"], (effect.robot, entity), True)
    if held not in before and held not in effect.after:
        return None
    after = set(effect.after)
    for fact in before:
        if fact.predicate.places and fact.arguments[0] == entity:
            opposite = fact._replace(value=not fact.value)
            if opposite in after:
                return (fact, held, opposite)
    return None
