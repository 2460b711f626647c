"""Why facts cannot hold, in words: what is too large, what excludes what, what finds no room."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence

from prag_asp.physics.facts import Fact
from prag_asp.physics.predicates import rotated
from prag_asp.physics.predicates.beside import DIRECTIONS
from prag_asp.physics.predicates.predicate import words
from prag_asp.physics.proofs.demands import bodies
from prag_asp.physics.proofs.differences import ORIGIN, ROUNDING, Gap, impossible_row, lowest
from prag_asp.physics.robot import robot_of
from prag_asp.physics.situation import Situation, fixed_pose
from prag_asp.physics.world.solids import weight
from prag_asp.scene.furniture import cavity
from prag_asp.scene.geometry import wrap
from prag_asp.scene.model import Scene, Shape

AXES = ("x", "y", "z")
NO_CONTAINER = (0.0, 0.0, 0.0)
SUPPORTS = ("on_top", "inside", "located")


def own_reasons(fact: Fact, scene: Scene) -> Iterator[str]:
    """Yield why a fact can never hold, whatever else does."""
    if fact.value and len(set(fact.arguments)) < len(fact.arguments):
        yield f"it cannot be that {fact.sentence()}, for nothing is in a relation to itself"
        return
    yield from _size_reasons(fact, scene)
    entities = () if fact.predicate.of_gripper or fact.predicate.looks_around else bodies(fact, scene)
    still = _still(scene)
    if entities and all(entity in still.poses for entity in entities) and not fact.satisfied(still):
        yield f"{fact.sentence()} cannot hold, for nothing of it can move"


def _size_reasons(fact: Fact, scene: Scene) -> Iterator[str]:
    """Yield why a body is too wide or heavy for the gripper, or too large for a container however it is turned."""
    name = fact.predicate.name
    if not fact.value:
        return
    if name == "holding":
        yield from _holding_reasons(fact.arguments[0], fact.arguments[1], scene)
    elif name in ("inside", "located"):
        entity, container = fact.arguments
        shape = scene.shapes[container]
        if name == "located" and shape.kind == "table":
            return
        inner = cavity(shape)
        if inner == NO_CONTAINER:
            yield f"{words(container)} is not a container, so {words(entity)} cannot be in it"
        elif _too_large(scene.shapes[entity], inner[0], inner[1]):
            yield f"{words(entity)} is larger than the cavity of {words(container)}"
    elif name == "on_top" and not scene.shapes[fact.arguments[1]].traits.flat:
        yield f"nothing rests on {words(fact.arguments[1])}, which is a ball"


def _holding_reasons(robot: str, entity: str, scene: Scene) -> Iterator[str]:
    """Yield why a gripper cannot hold a body: it is too wide, or too heavy."""
    able, gripper = robot_of(scene, robot), _gripper(robot, scene)
    # Bodies stand upright and are gripped from above, so that their height does not count.
    narrowest, heavy = scene.shapes[entity].breadth(widest=False), weight(scene, entity)
    if narrowest > able.opening:
        yield f"{words(entity)} is {narrowest * 1000:.0f} mm wide, {gripper} opens {able.opening * 1000:.0f} mm"
    if heavy > able.payload:
        yield f"{words(entity)} weighs {heavy:.3g} kg, {gripper} carries {able.payload:g} kg"


def _too_large(shape: Shape, inner_x: float, inner_y: float) -> bool:
    """Tell whether no shadow of a body fits a rectangle.

    The width of a shadow is never less than that of the body, and the area of the shadow of a convex body
    never less than that of its smallest shadow.
    """
    small, middle, _ = sorted(shape.size)
    area = small * middle * (math.pi / 4 if shape.traits.round else 1.0)
    return small > min(inner_x, inner_y) or area > inner_x * inner_y


def gap_reasons(true: Sequence[Fact]) -> Iterator[str]:
    """Yield objects that are both near each other and far from each other."""
    near = {frozenset(fact.arguments) for fact in true if fact.predicate.name == "near"}
    for fact in true:
        if near and fact.predicate.name == "far" and frozenset(fact.arguments) in near:
            yield f"{' and '.join(map(words, fact.arguments))} cannot be near and far at once"


def gripper_reasons(true: Iterable[Fact], scene: Scene) -> Iterator[str]:
    """Yield why a gripper cannot do two things at once."""
    held: dict[str, str] = {}
    opened = set()
    for fact in true:
        robot = fact.arguments[0]
        if fact.predicate.name == "gripper_open":
            opened.add(robot)
        elif fact.predicate.name == "holding":
            other = held.setdefault(robot, fact.arguments[1])
            if other != fact.arguments[1]:
                things = f"{words(other)} and {words(fact.arguments[1])}"
                yield f"{_gripper(robot, scene)} cannot hold {things} at once"
    for robot in sorted(opened & held.keys()):
        yield f"{_gripper(robot, scene)} cannot be open while it holds {words(held[robot])}"


def turn_reasons(true: Iterable[Fact], scene: Scene) -> Iterator[str]:
    """Yield bodies that would be turned in two ways."""
    turned: dict[str, str] = {}
    for fact in true:
        if fact.predicate.name == "rotated":
            entity, rotation = fact.arguments
            other = turned.setdefault(entity, rotation)
            between = abs(wrap(scene.rotations[rotation] - scene.rotations[other]))
            if between > 2 * rotated.TOLERANCE:
                yield f"{words(entity)} cannot be turned {words(other)} and {words(rotation)} at once"


def room_reasons(true: Iterable[Fact], axis: int, gaps: Sequence[Gap]) -> Iterator[str]:
    """Yield circles of relations, rows that are longer than the room for them, and places that exclude each other."""
    row = impossible_row(gaps)
    if not row:
        return
    names = ", ".join(dict.fromkeys(words(entity) for entity, _ in row if entity))
    predicates = {fact.predicate.name for fact in true}
    if ORIGIN not in row and predicates <= {*DIRECTIONS, "on_top", "inside"}:
        yield f"the relations along {AXES[axis]} form a circle: {names}"
    elif predicates & DIRECTIONS.keys():
        yield f"there is no room along {AXES[axis]} for the row {names}"
    else:
        yield _never_together(true)


def reach_reasons(true: Sequence[Fact], scene: Scene, gaps: Sequence[Iterable[Gap]]) -> Iterator[str]:
    """Yield why a body is too near or too far for the gripper wherever the facts let it be."""
    wanted = [fact.arguments for fact in true if fact.predicate.name == "reachable"]
    if not any(fact.predicate.name in SUPPORTS and fact.arguments[1] in scene.fixed for fact in true):
        return
    least = [lowest(gaps[axis], ORIGIN) for axis in (0, 1)]
    most = [lowest((Gap(high, low, length) for low, high, length in gaps[axis]), ORIGIN) for axis in (0, 1)]
    for name, entity in wanted:
        robot, node = robot_of(scene, name), (entity, "centre")
        nearest, farthest = robot.reach
        base = robot.base.position
        # All are within the square around the ring.
        sides = [(least[axis][node] - base[axis], -most[axis][node] - base[axis]) for axis in (0, 1)]
        near = math.hypot(*(max(low, -high, 0.0) for low, high in sides))
        far = math.hypot(*(max(-low, high) for low, high in sides))
        if near > farthest + ROUNDING or far < nearest - ROUNDING:
            yield _never_together(true)


def _gripper(robot: str, scene: Scene) -> str:
    """Return which gripper is meant, in words."""
    return f"the {words(robot)} gripper" if scene.shared else "the gripper"


def _never_together(facts: Iterable[Fact]) -> str:
    """Return in words that facts exclude each other."""
    *others, last = [fact.sentence() for fact in facts]
    return f"{', '.join(others)} and {last} exclude each other" if others else f"{last} is never so"


def _still(scene: Scene) -> Situation:
    """Return the situation of the bodies that never move, not even a part of them."""
    poses = {
        entity: fixed_pose(scene, entity)
        for entity in scene.fixed
        if scene.shapes[entity].traits.body and not scene.shapes[entity].traits.furniture
    }
    return Situation(scene, poses)
