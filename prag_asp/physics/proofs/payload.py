"""What an action has to lift, and whether the gripper bears it: proofs about two states in a row.

A gripper may close around anything that it spans; only what it lifts weighs on it. A witness lifts what it moves: the
arm leaves straight up from where it has taken an object, and comes straight down to where it lets it go.
"""

from __future__ import annotations

from collections.abc import Iterator

from prag_asp.physics.predicates import PREDICATES
from prag_asp.physics.predicates.gripper import slips
from prag_asp.physics.symbolic_facts import Effect, Fact, PhysicalTask
from prag_asp.scene.scene import Scene


def slipping(physical: PhysicalTask, scene: Scene) -> Iterator[tuple[int, str, tuple[Fact, ...]]]:
    """Yield what is lifted though it slips, whatever its size: the state that it comes to, why, and by which facts."""
    for number, effect in enumerate(physical.effects, 1):
        found = _lifted(effect, physical.states[number - 1])
        if found is not None:
            _, held, _ = found
            robot, entity = held.arguments
            sizes = scene.ranges.get(entity, (scene.shapes[entity],))
            reasons = [slips(scene.with_shapes({entity: shape}), entity, robot) for shape in sizes]
            if reasons[0] is not None and None not in reasons:
                yield number, reasons[0], found


def _lifted(effect: Effect, before: tuple[Fact, ...]) -> tuple[Fact, Fact, Fact] | None:
    """Return that an object is at a place, that it is held, and that it is not there: it moves in the gripper.

    The place stands still where the action moves nothing but the object, and opens nothing. What is handed over may
    stay where it is.
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
