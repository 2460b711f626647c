"""Constraints on the positions of bodies, which follow from facts that hold and from the bodies themselves."""

from __future__ import annotations

import math
from itertools import chain

from prag_asp.physics.predicates.gaps import ORIGIN, Demand, Z, between, bottom, centre, top
from prag_asp.physics.symbolic_facts import Fact
from prag_asp.scene.scene import Scene
from prag_asp.scene.surfaces import least_extent


def demands(fact: Fact, scene: Scene) -> tuple[Demand, ...]:
    """Return the constraints that follow from a fact if it holds; there are none for furniture."""
    demanded = fact.predicate.demands
    if demanded is None or any(scene.shapes[entity].traits.furniture for entity in bodies(fact, scene)):
        return ()
    return tuple(demanded(scene, fact.arguments))


def body_demands(entity: str, scene: Scene) -> tuple[Demand, ...]:
    """Return the constraints on a body in any state: its height and, if it is fixed, its position."""
    shape, place = scene.shapes[entity], scene.fixed.get(entity)
    if shape.traits.furniture:
        return ()
    # If a body is oblique in its file, its box is thicker than the body.
    thin = 2 * min(shape.half) if shape.model is None else least_extent(shape).width
    tall = (thin, 2 * math.hypot(*shape.half)) if place is None else (shape.size[2],) * 2
    demands = [(Z, gap) for gap in between(top(entity), bottom(entity), *tall)]
    if place is not None:
        demands += [(axis, gap) for axis in (0, 1) for gap in between(centre(entity), ORIGIN, place[axis], place[axis])]
        demands += [(Z, gap) for gap in between(bottom(entity), ORIGIN, 0.0, 0.0)]
    return tuple(demands)


def bodies(fact: Fact, scene: Scene) -> tuple[str, ...]:
    """Return the objects among the arguments of a fact, without robots, tables, zones and rotations."""
    shapes = ((entity, scene.shapes.get(entity)) for entity in fact.arguments)
    return tuple(entity for entity, shape in shapes if shape is not None and shape.traits.body)


def all_demands(fact: Fact, scene: Scene) -> tuple[Demand, ...]:
    """Return the constraints that a fact implies, together with the constraints on its bodies in any state."""
    return (*demands(fact, scene), *chain.from_iterable(body_demands(entity, scene) for entity in bodies(fact, scene)))
