"""Proofs that no arrangement of the bodies can satisfy a state, whatever their poses."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping
from graphlib import CycleError, TopologicalSorter

from prag_asp.domain.scene import Scene, Shape
from prag_asp.physics.facts import Fact, Problem
from prag_asp.physics.geometry import IDENTITY, Pose, cavity, yaw_quaternion
from prag_asp.physics.predicates.beside import DIRECTIONS
from prag_asp.physics.robot import ROBOTS
from prag_asp.physics.situation import Situation

AXES = ("x", "y", "z")


def impossibility(problem: Problem, scene: Scene) -> str | None:
    """Return why a task is infeasible, None where nothing is proved."""
    if problem.contradiction is not None:
        return problem.contradiction
    for k, facts in enumerate(problem.states):
        for reason in _reasons(facts, scene):
            where = "the initial state" if k == 0 else f"the state after {problem.effects[k - 1].action}"
            return f"{where}: {reason}"
    return None


def _reasons(facts: tuple[Fact, ...], scene: Scene) -> Iterator[str]:
    """Yield the proofs that a state cannot be."""
    true = [fact for fact in facts if fact.value]
    for fact in true:
        yield from _size_reasons(fact, scene)
    yield from _gripper_reasons(true)
    yield from _order_reasons(true)
    yield from _fixed_reasons(facts, scene)


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


def _fixed_reasons(facts: Iterable[Fact], scene: Scene) -> Iterator[str]:
    """Yield facts that speak only of bodies that never move, and are wrong."""
    poses = {
        entity: Pose((x, y, scene.shapes[entity].half[2]), yaw_quaternion(yaw))
        for entity, (x, y, yaw) in scene.fixed.items()
    }
    situation = Situation(scene, poses, Pose((0.0, 0.0, 1.0), IDENTITY), 0.0)
    for fact in facts:
        if fact.predicate.of_gripper or fact.arguments[fact.predicate.subject] not in poses:
            continue
        bodies = [
            entity for entity in fact.arguments if scene.shapes.get(entity, Shape("robot")).kind != "robot"
        ]
        still = all(entity in poses or scene.shapes[entity].kind == "table" for entity in bodies)
        if still and not fact.satisfied(situation):
            yield f"{fact.sentence()} cannot hold, for nothing of it can move"
