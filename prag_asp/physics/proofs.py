"""Proofs that no arrangement of the bodies can satisfy a state, whatever their poses."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping
from graphlib import CycleError, TopologicalSorter

from prag_asp.domain.scene import Scene, Shape
from prag_asp.physics.facts import Fact, Problem
from prag_asp.physics.geometry import IDENTITY, Pose, cavity, extents, yaw_quaternion
from prag_asp.physics.predicates.beside import DIRECTIONS, GAP, direction
from prag_asp.physics.robot import ROBOTS
from prag_asp.physics.situation import Situation

AXES = ("x", "y", "z")
ROUNDING = 1e-9
ORDERING = ("on_top", "reachable", *DIRECTIONS)


def impossibility(problem: Problem, scene: Scene) -> str | None:
    """Return why a task is infeasible, None where nothing is proved."""
    if problem.contradiction is not None:
        return problem.contradiction
    still, seen = _still(scene), set[Fact]()
    for k, facts in enumerate(problem.states):
        fresh = [fact for fact in facts if fact not in seen]
        seen.update(fresh)
        for reason in _reasons(facts, fresh, scene, still):
            where = "the initial state" if k == 0 else f"the state after {problem.effects[k - 1].action}"
            return f"{where}: {reason}"
    return None


def _reasons(facts: tuple[Fact, ...], fresh: Iterable[Fact], scene: Scene, still: Situation) -> Iterator[str]:
    """Yield the proofs that a state cannot be; `fresh` are its facts that no state before it has."""
    true = [fact for fact in facts if fact.value]
    for fact in fresh:
        if fact.value:
            yield from _self_reasons(fact)
            yield from _size_reasons(fact, scene)
    yield from _gap_reasons(true)
    yield from _gripper_reasons(true)
    if any(fact.value and fact.predicate.name in ORDERING for fact in fresh):
        yield from _order_reasons(true)
    yield from _fixed_reasons(fresh, scene, still)
    if any(fact.value and fact.predicate.name in ORDERING for fact in fresh):
        yield from _room_reasons(true, scene)


def _self_reasons(fact: Fact) -> Iterator[str]:
    """Yield that nothing is in a relation to itself."""
    if len(set(fact.arguments)) < len(fact.arguments):
        yield f"it cannot be that {fact.sentence()}, for nothing is in a relation to itself"


def _gap_reasons(true: list[Fact]) -> Iterator[str]:
    """Yield objects that are both near each other and far from each other."""
    near = {frozenset(fact.arguments) for fact in true if fact.predicate.name == "near"}
    for fact in true:
        if near and fact.predicate.name == "far" and frozenset(fact.arguments) in near:
            yield f"{' and '.join(fact.arguments)} cannot be near and far at once"


def _size_reasons(fact: Fact, scene: Scene) -> Iterator[str]:
    """Yield why an object is too large for the gripper or a container however it is turned."""
    name = fact.predicate.name
    if name == "holding":
        entity, opening = fact.arguments[1], ROBOTS[scene.robot].opening
        narrowest = min(scene.shapes[entity].size)
        if narrowest > opening:
            yield f"{entity} is {narrowest * 1000:.0f} mm wide, the gripper opens {opening * 1000:.0f} mm"
    elif name in ("inside", "located"):
        entity, container = fact.arguments
        inner = cavity(scene.shapes[container])
        if inner[2] == 0.0:
            yield f"{container} is not a container, so {entity} cannot be in it"
        elif _too_large(scene.shapes[entity], inner[0], inner[1]):
            yield f"{entity} is larger than the cavity of {container}"
    elif name == "on_top" and scene.shapes[fact.arguments[1]].kind == "sphere":
        yield f"nothing rests on {fact.arguments[1]}, which is a ball"


def _too_large(shape: Shape, inner_x: float, inner_y: float) -> bool:
    """Tell whether no shadow of a body fits a rectangle.

    The width of a shadow is never less than that of the body, and the area of the shadow of a convex body
    never less than that of its smallest shadow.
    """
    small, middle, _ = sorted(shape.size)
    area = small * middle * (math.pi / 4 if shape.kind in ("sphere", "cylinder") else 1.0)
    return small > min(inner_x, inner_y) or area > inner_x * inner_y


def _gripper_reasons(true: list[Fact]) -> Iterator[str]:
    """Yield why the gripper cannot do two things at once."""
    held = sorted({fact.arguments[1] for fact in true if fact.predicate.name == "holding"})
    if len(held) > 1:
        yield f"the gripper cannot hold {held[0]} and {held[1]} at once"
    if held and any(fact.predicate.name == "gripper_open" for fact in true):
        yield f"the gripper cannot be open while it holds {held[0]}"


def _order_reasons(true: list[Fact]) -> Iterator[str]:
    """Yield cycles of relations that are strict orders along an axis: nothing is left of itself."""
    edges: dict[int, dict[str, set[str]]] = {0: {}, 1: {}, 2: {}}
    for fact in true:
        name = fact.predicate.name
        if name == "on_top":
            edges[2].setdefault(fact.arguments[0], set()).add(fact.arguments[1])
        elif name in DIRECTIONS:
            axis, sign = DIRECTIONS[name]
            low, high = fact.arguments if sign < 0 else fact.arguments[::-1]
            edges[axis].setdefault(high, set()).add(low)
    for axis, graph in edges.items():
        cycle = _cycle(graph)
        if cycle:
            yield f"the relations along {AXES[axis]} form a circle: {', '.join(cycle)}"


def _cycle(below: Mapping[str, set[str]]) -> list[str]:
    """Return a cycle of a directed graph, its first node again at the end; empty where there is none."""
    try:
        TopologicalSorter(below).prepare()
    except CycleError as error:
        return list(error.args[1])
    return []


def _room_reasons(true: list[Fact], scene: Scene) -> Iterator[str]:
    """Yield rows of objects that are longer than the part of the workspace in which they have to lie.

    An object on the table and within reach has its centre in the workspace, and each step of a row takes half
    of both objects, as thin as they can be, and the gap of the relation.
    """
    on_table = {
        f.arguments[0] for f in true if f.predicate.name == "on_top" and scene.shapes[f.arguments[1]].kind == "table"
    }
    bound = on_table & {f.arguments[1] for f in true if f.predicate.name == "reachable"}
    for axis in (0, 1):
        lower: dict[str, list[str]] = {}
        for fact in true:
            if fact.predicate.name in DIRECTIONS and direction(fact.predicate.name, scene.frame)[0] == axis:
                sign = direction(fact.predicate.name, scene.frame)[1]
                low, high = fact.arguments if sign < 0 else fact.arguments[::-1]
                lower.setdefault(high, []).append(low)
        if not lower:
            continue
        begin, end = scene.workspace[2 * axis : 2 * axis + 2]
        least = _least(lower, scene, axis, dict.fromkeys(bound, begin))
        for entity, (least_place, row) in least.items():
            place = scene.fixed.get(entity)
            most = place[axis] if place else end if entity in bound else math.inf
            if least_place > most + ROUNDING:
                yield f"there is no room along {AXES[axis]} for the row {', '.join(row)}"


def _least(
    lower: Mapping[str, list[str]], scene: Scene, axis: int, begin: Mapping[str, float]
) -> dict[str, tuple[float, tuple[str, ...]]]:
    """Return the least coordinate of the centres of objects in rows, in metres, and the row that needs it."""
    found: dict[str, tuple[float, tuple[str, ...]]] = {}
    for entity in TopologicalSorter(lower).static_order():
        place = scene.fixed.get(entity)
        own = place[axis] if place else begin.get(entity, -math.inf)
        best: tuple[float, tuple[str, ...]] = (own, (entity,))
        for other in lower.get(entity, ()):
            start, row = found[other]
            if other in scene.fixed:
                start, row = scene.fixed[other][axis], (other,)
            need = start + _thinnest(scene, other, axis) + _thinnest(scene, entity, axis) + GAP
            best = max(best, (need, (*row, entity)))
        found[entity] = best
    return found


def _thinnest(scene: Scene, entity: str, axis: int) -> float:
    """Return half the side of the bounding box of an object along an axis in metres, as small as it can be."""
    shape, place = scene.shapes[entity], scene.fixed.get(entity)
    return extents(shape, yaw_quaternion(place[2]))[axis] if place else min(shape.half)


def _still(scene: Scene) -> Situation:
    """Return the situation of the objects that never move."""
    poses = {
        entity: Pose((x, y, scene.shapes[entity].half[2]), yaw_quaternion(yaw))
        for entity, (x, y, yaw) in scene.fixed.items()
    }
    return Situation(scene, poses, Pose((0.0, 0.0, 1.0), IDENTITY), 0.0)


def _fixed_reasons(facts: Iterable[Fact], scene: Scene, situation: Situation) -> Iterator[str]:
    """Yield facts that speak only of bodies that never move, and are wrong."""
    for fact in facts:
        if fact.predicate.of_gripper or fact.arguments[fact.predicate.subject] not in situation.poses:
            continue
        bodies = [entity for entity in fact.arguments if scene.shapes.get(entity, Shape("robot")).kind != "robot"]
        still = all(entity in situation.poses or scene.shapes[entity].kind == "table" for entity in bodies)
        if still and not fact.satisfied(situation):
            yield f"{fact.sentence()} cannot hold, for nothing of it can move"
