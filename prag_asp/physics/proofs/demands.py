"""What a fact demands of the places of bodies: least differences between their coordinates, along each axis.

Each demand follows from the definition of the predicate for any way in which the bodies may be turned. Along x and y
the centres of bodies are compared, along z the bottoms and tops of their bounding boxes.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping
from itertools import chain

from prag_asp.physics.facts import Fact
from prag_asp.physics.predicates import gripper, inside, on_top
from prag_asp.physics.predicates.beside import DIRECTIONS, GAP, direction
from prag_asp.physics.proofs.differences import ORIGIN, Gap, Node, between
from prag_asp.physics.robot import robot_of
from prag_asp.scene.furniture import cavity
from prag_asp.scene.geometry import extents, yaw_quaternion
from prag_asp.scene.model import Scene, Shape

Z = 2
Demand = tuple[int, Gap]
"""An axis (0 is x, 1 is y, 2 is z) and what is demanded along it."""


def demands(fact: Fact, scene: Scene) -> tuple[Demand, ...]:
    """Return what a fact that holds demands; nothing where it says nothing about places, or speaks of furniture."""
    name = fact.predicate.name
    if any(scene.shapes[entity].traits.furniture for entity in bodies(fact, scene)):
        return ()
    if name in DIRECTIONS:
        return (_beside(fact, scene),)
    demand = DEMANDS.get(name)
    return () if demand is None else tuple(demand(scene, fact.arguments))


def standing(entity: str, scene: Scene) -> tuple[Demand, ...]:
    """Return what is so of a body in any state: how high it is, and where it is if no part of it ever moves."""
    shape, place = scene.shapes[entity], scene.fixed.get(entity)
    if shape.traits.furniture:
        return ()
    tall = (2 * min(shape.half), 2 * math.hypot(*shape.half)) if place is None else (shape.size[2],) * 2
    found = [(Z, gap) for gap in between(_top(entity), _bottom(entity), *tall)]
    if place is not None:
        found += [(axis, gap) for axis in (0, 1) for gap in between(_centre(entity), ORIGIN, place[axis], place[axis])]
        found += [(Z, gap) for gap in between(_bottom(entity), ORIGIN, 0.0, 0.0)]
    return tuple(found)


def thinnest(entity: str, axis: int, scene: Scene) -> float:
    """Return half the side of the bounding box of a body along an axis in metres, as small as it can be."""
    shape, place = scene.shapes[entity], scene.fixed.get(entity)
    return min(shape.half) if place is None else extents(shape, yaw_quaternion(place[2]))[axis]


def _centre(entity: str) -> Node:
    return (entity, "centre")


def _bottom(entity: str) -> Node:
    return (entity, "bottom")


def _top(entity: str) -> Node:
    return (entity, "top")


def _beside(fact: Fact, scene: Scene) -> Demand:
    """Return that two bodies are one beside the other."""
    axis, sign = direction(fact.predicate.name, scene.frame)
    low, high = fact.arguments if sign < 0 else fact.arguments[::-1]
    return axis, Gap(_centre(low), _centre(high), thinnest(low, axis, scene) + thinnest(high, axis, scene) + GAP)


def _on_top(scene: Scene, arguments: tuple[str, ...]) -> Iterator[Demand]:
    """Yield that a body stands on another, its centre above it."""
    entity, support = arguments
    shape = scene.shapes[support]
    if shape.kind == "zone":
        return
    if shape.kind == "table":
        for axis in (0, 1):
            middle, half = scene.table.centre[axis], scene.table.size[axis] / 2
            yield from _along(axis, between(_centre(entity), ORIGIN, middle - half, middle + half))
        yield from _along(Z, between(_bottom(entity), ORIGIN, -on_top.TOLERANCE, on_top.TOLERANCE))
        return
    yield from _above(scene, entity, support, (shape.half[0], shape.half[1]))
    yield from _along(Z, between(_bottom(entity), _top(support), -on_top.TOLERANCE, on_top.TOLERANCE))


def _inside(scene: Scene, arguments: tuple[str, ...], room: float = inside.FLOOR_BAND) -> Iterator[Demand]:
    """Yield that a body is in the cavity of another, up to `room` metres above its floor."""
    entity, container = arguments
    inner, own = cavity(scene.shapes[container]), min(scene.shapes[entity].half)
    half = (max(0.0, inner[0] / 2 - own), max(0.0, inner[1] / 2 - own))
    yield from _above(scene, entity, container, half)
    wall = scene.shapes[container].wall
    yield from _along(Z, between(_bottom(entity), _bottom(container), wall - inside.TOLERANCE, wall + room))


def _located(scene: Scene, arguments: tuple[str, ...]) -> Iterator[Demand]:
    """Yield that a body is in another or held above it; nothing for the table, over which it may be anywhere."""
    if scene.shapes[arguments[1]].kind == "table":
        return iter(())
    return _inside(scene, arguments, cavity(scene.shapes[arguments[1]])[2] + inside.HOVER)


def _above(scene: Scene, entity: str, support: str, half: tuple[float, float]) -> Iterator[Demand]:
    """Yield that the centre of a body is above a rectangle (or the circle in it) in the middle of another."""
    place = scene.fixed.get(support)
    round_top = scene.shapes[support].traits.round
    for axis in (0, 1):
        reach = half[0] if round_top else math.hypot(*half)
        if place is not None and not round_top:
            reach = extents(Shape("box", (2 * half[0], 2 * half[1], 0.0)), yaw_quaternion(place[2]))[axis]
        yield from _along(axis, between(_centre(entity), _centre(support), -reach, reach))


def _reachable(scene: Scene, arguments: tuple[str, ...]) -> Iterator[Demand]:
    """Yield that a body is within the square around the ring of the gripper's reach, and not too high."""
    robot, entity = robot_of(scene, arguments[0]), arguments[1]
    for axis in (0, 1):
        base, reach = robot.base.position[axis], robot.reach[1]
        yield from _along(axis, between(_centre(entity), ORIGIN, base - reach, base + reach))
    yield Z, Gap(_bottom(entity), ORIGIN, min(scene.shapes[entity].half) - robot.reach_height)


def _at(scene: Scene, arguments: tuple[str, ...], near: float = gripper.CENTRE_TOLERANCE) -> Iterator[Demand]:
    """Yield that the tool is at a body, `near` metres from its middle."""
    robot, entity = arguments
    for axis in (0, 1):
        yield from _along(axis, between(_centre(entity), _centre(robot), -near, near))
    yield Z, Gap(_bottom(entity), _centre(robot), -gripper.BELOW)
    yield Z, Gap(_centre(robot), _top(entity), 0.0)


def _holding(scene: Scene, arguments: tuple[str, ...]) -> Iterator[Demand]:
    """Yield that the tool is somewhere over a body, for a long one can be held at its end."""
    half = scene.shapes[arguments[1]].half
    return _at(scene, arguments, max(gripper.CENTRE_TOLERANCE, math.hypot(half[0], half[1])))


def _along(axis: int, gaps: tuple[Gap, ...]) -> Iterator[Demand]:
    return ((axis, gap) for gap in gaps)


DEMANDS: Mapping[str, Callable[[Scene, tuple[str, ...]], Iterator[Demand]]] = {
    "on_top": _on_top,
    "inside": _inside,
    "located": _located,
    "reachable": _reachable,
    "at": _at,
    "holding": _holding,
}


def bodies(fact: Fact, scene: Scene) -> tuple[str, ...]:
    """Return the bodies that a fact speaks of: no robot, not the table, no zone, no rotation."""
    known = ((entity, scene.shapes.get(entity)) for entity in fact.arguments)
    return tuple(entity for entity, shape in known if shape is not None and shape.traits.body)


def all_demands(fact: Fact, scene: Scene) -> tuple[Demand, ...]:
    """Return what a fact demands, and what is so of its bodies in any state."""
    return (*demands(fact, scene), *chain.from_iterable(standing(entity, scene) for entity in bodies(fact, scene)))
