"""What is demanded of the places of bodies: by facts that hold, and by what each body is."""

from __future__ import annotations

import math
from itertools import chain

from prag_asp.physics.predicates.gaps import ORIGIN, Demand, Z, between, bottom, centre, top
from prag_asp.physics.symbolic_facts import Fact
from prag_asp.scene.scene import Scene


def demands(fact: Fact, scene: Scene) -> tuple[Demand, ...]:
    """Return what a fact that holds demands; nothing where it says nothing about places, or speaks of furniture."""
    demanded = fact.predicate.demands
    if demanded is None or any(scene.shapes[entity].traits.furniture for entity in bodies(fact, scene)):
        return ()
    return tuple(demanded(scene, fact.arguments))


def standing(entity: str, scene: Scene) -> tuple[Demand, ...]:
    """Return what is so of a body in any state: how high it is, and where it is if no part of it ever moves."""
    shape, place = scene.shapes[entity], scene.fixed.get(entity)
    if shape.traits.furniture:
        return ()
    tall = (2 * min(shape.half), 2 * math.hypot(*shape.half)) if place is None else (shape.size[2],) * 2
    found = [(Z, gap) for gap in between(top(entity), bottom(entity), *tall)]
    if place is not None:
        found += [(axis, gap) for axis in (0, 1) for gap in between(centre(entity), ORIGIN, place[axis], place[axis])]
        found += [(Z, gap) for gap in between(bottom(entity), ORIGIN, 0.0, 0.0)]
    return tuple(found)


def bodies(fact: Fact, scene: Scene) -> tuple[str, ...]:
    """Return the bodies that a fact speaks of: no robot, not the table, no zone, no rotation."""
    known = ((entity, scene.shapes.get(entity)) for entity in fact.arguments)
    return tuple(entity for entity, shape in known if shape is not None and shape.traits.body)


def all_demands(fact: Fact, scene: Scene) -> tuple[Demand, ...]:
    """Return what a fact demands, and what is so of its bodies in any state."""
    return (*demands(fact, scene), *chain.from_iterable(standing(entity, scene) for entity in bodies(fact, scene)))
