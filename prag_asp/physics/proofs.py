"""Proofs that no arrangement of the bodies can satisfy the facts of a state, whatever their poses.

A proof takes for granted the definitions of the predicates, where the fixed bodies are, and three rules of every scene:
a gripper holds one body at a time, it is not open while it holds one, and nothing rests on a ball. The workspace
says where the search puts bodies, not where they can be, so no proof reads it. What is proved of some facts is so of
more facts, too.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Iterable, Iterator, Sequence
from dataclasses import dataclass
from itertools import product

from prag_asp.domain.atom import Atom
from prag_asp.domain.scene import BODILESS, FURNITURE, Scene, Shape
from prag_asp.physics.demands import Demand, all_demands, bodies
from prag_asp.physics.differences import ORIGIN, ROUNDING, Gap, Node, impossible_row, lowest
from prag_asp.physics.facts import Fact, Problem
from prag_asp.physics.geometry import IDENTITY, Pose, cavity, wrap, yaw_quaternion
from prag_asp.physics.mechanism import mechanism
from prag_asp.physics.predicates import rotated
from prag_asp.physics.predicates.beside import DIRECTIONS
from prag_asp.physics.robot import robot_of
from prag_asp.physics.situation import Situation

AXES = ("x", "y", "z")
NO_CONTAINER = (0.0, 0.0, 0.0)
SUPPORTS = ("on_top", "inside", "located")


@dataclass(frozen=True)
class Impossibility:
    """A proof that a state cannot be: the reason in words, and the facts that it follows from.

    None of the facts can be left out. `state` counts from 0, the initial state; `after` is the action that leads to
    the state, None at the start.
    """

    reason: str
    facts: tuple[Fact, ...]
    state: int
    after: Atom | None

    def __str__(self) -> str:
        where = "the initial state" if self.after is None else f"the state after {self.after}"
        return f"{where}: {self.reason}"


class Prover:
    """Proves states of one scene impossible; it remembers what each fact demands."""

    def __init__(self, scene: Scene):
        self._scene = scene
        self._demands: dict[Fact, tuple[Demand, ...]] = {}
        self._alone: dict[Fact, str | None] = {}

    def impossibility(self, problem: Problem) -> Impossibility | None:
        """Return a proof that a task is infeasible, None where nothing is proved."""
        seen = set[Fact]()
        for k, facts in enumerate(problem.states):
            fresh = [fact for fact in facts if fact not in seen]
            seen.update(fresh)
            if next(self._reasons(facts, fresh), None) is not None:
                least = self.fewest(facts)
                reason = next(self._reasons(least, least))
                return Impossibility(reason, least, k, problem.effects[k - 1].action if k else None)
        return None

    def refutation(self, facts: Sequence[Fact]) -> str | None:
        """Return why some facts cannot hold together, None where nothing is proved."""
        return next(self._reasons(facts, facts), None)

    def fewest(self, facts: Sequence[Fact]) -> tuple[Fact, ...]:
        """Return facts of some that cannot hold together, none of which can be left out."""
        left = list(facts)
        for fact in facts:
            fewer = [other for other in left if other != fact]
            if self.refutation(fewer) is not None:
                left = fewer
        return tuple(left)

    def _reasons(self, facts: Sequence[Fact], fresh: Collection[Fact]) -> Iterator[str]:
        """Yield why facts cannot hold together; no such reason lacks all the `fresh` ones."""
        for fact in fresh:
            reason = self._never(fact)
            if reason is not None:
                yield reason
        new = [fact for fact in fresh if fact.value]
        if not new:
            return
        true = [fact for fact in facts if fact.value]
        yield from _gap_reasons(true)
        yield from _gripper_reasons(true)
        yield from _turn_reasons(true, self._scene)
        gaps: tuple[dict[Gap, None], ...] = ({}, {}, {})
        for fact in true:
            for axis, gap in self._demanded(fact):
                gaps[axis][gap] = None
        for axis in sorted({axis for fact in new for axis, _ in self._demanded(fact)}):
            yield from _room_reasons(true, axis, list(gaps[axis]))
        yield from _reach_reasons(true, self._scene, gaps)

    def _demanded(self, fact: Fact) -> tuple[Demand, ...]:
        """Return what a fact demands of places whatever the sizes of its bodies, which is worked out once."""
        known = self._demands.get(fact)
        if known is None:
            first, *others = (_lengths(all_demands(fact, sized)) for sized in self._sized(fact))
            common = [demanded for demanded in first if all(demanded in other for other in others)]
            known = self._demands[fact] = tuple(
                (axis, Gap(low, high, min(found[axis, low, high] for found in (first, *others))))
                for axis, low, high in common
            )
        return known

    def _never(self, fact: Fact) -> str | None:
        """Return why a fact can never hold, whatever else does and however large its bodies are; found once."""
        if fact not in self._alone:
            reasons = [next(_own_reasons(fact, sized), None) for sized in self._sized(fact)]
            self._alone[fact] = None if None in reasons else reasons[0]
        return self._alone[fact]

    def _sized(self, fact: Fact) -> Iterator[Scene]:
        """Yield the scene with each choice of sizes for the bodies of a fact."""
        drawn = [entity for entity in bodies(fact, self._scene) if entity in self._scene.ranges]
        for shapes in product(*(self._scene.ranges[entity] for entity in drawn)):
            yield self._scene.with_shapes(dict(zip(drawn, shapes, strict=True)))


def impossibility(problem: Problem, scene: Scene) -> Impossibility | None:
    """Return a proof that a task is infeasible, None where nothing is proved."""
    return Prover(scene).impossibility(problem)


def _lengths(found: Iterable[Demand]) -> dict[tuple[int, Node, Node], float]:
    """Return the greatest difference that is demanded of two coordinates along an axis."""
    lengths: dict[tuple[int, Node, Node], float] = {}
    for axis, (low, high, least) in found:
        lengths[axis, low, high] = max(least, lengths.get((axis, low, high), -math.inf))
    return lengths


def _own_reasons(fact: Fact, scene: Scene) -> Iterator[str]:
    """Yield why a fact can never hold, whatever else does."""
    if fact.value and len(set(fact.arguments)) < len(fact.arguments):
        yield f"it cannot be that {fact.sentence()}, for nothing is in a relation to itself"
        return
    yield from _size_reasons(fact, scene)
    entities = () if fact.predicate.of_gripper else bodies(fact, scene)
    still = _still(scene)
    if entities and all(entity in still.poses for entity in entities) and not fact.satisfied(still):
        yield f"{fact.sentence()} cannot hold, for nothing of it can move"


def _size_reasons(fact: Fact, scene: Scene) -> Iterator[str]:
    """Yield why a body is too large for the gripper or a container however it is turned."""
    name = fact.predicate.name
    if not fact.value:
        return
    if name == "holding":
        entity, opening = fact.arguments[1], robot_of(scene, fact.arguments[0]).opening
        narrowest = min(scene.shapes[entity].size)
        if narrowest > opening:
            yield f"{entity} is {narrowest * 1000:.0f} mm wide, the gripper opens {opening * 1000:.0f} mm"
    elif name in ("inside", "located"):
        entity, container = fact.arguments
        shape = scene.shapes[container]
        if name == "located" and shape.kind == "table":
            return
        inner = mechanism(shape).cavity if shape.kind in FURNITURE else cavity(shape)
        if inner == NO_CONTAINER:
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


def _gap_reasons(true: Sequence[Fact]) -> Iterator[str]:
    """Yield objects that are both near each other and far from each other."""
    near = {frozenset(fact.arguments) for fact in true if fact.predicate.name == "near"}
    for fact in true:
        if near and fact.predicate.name == "far" and frozenset(fact.arguments) in near:
            yield f"{' and '.join(fact.arguments)} cannot be near and far at once"


def _gripper_reasons(true: Iterable[Fact]) -> Iterator[str]:
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
                yield f"the gripper cannot hold {other} and {fact.arguments[1]} at once"
    for robot in sorted(opened & held.keys()):
        yield f"the gripper cannot be open while it holds {held[robot]}"


def _turn_reasons(true: Iterable[Fact], scene: Scene) -> Iterator[str]:
    """Yield bodies that would be turned in two ways."""
    turned: dict[str, str] = {}
    for fact in true:
        if fact.predicate.name == "rotated":
            entity, rotation = fact.arguments
            other = turned.setdefault(entity, rotation)
            between = abs(wrap(scene.rotations[rotation] - scene.rotations[other]))
            if between > 2 * rotated.TOLERANCE:
                yield f"{entity} cannot be turned {other} and {rotation} at once"


def _room_reasons(true: Iterable[Fact], axis: int, gaps: Sequence[Gap]) -> Iterator[str]:
    """Yield circles of relations, rows that are longer than the room for them, and places that exclude each other."""
    row = impossible_row(gaps)
    if not row:
        return
    names = ", ".join(dict.fromkeys(entity for entity, _ in row if entity))
    predicates = {fact.predicate.name for fact in true}
    if ORIGIN not in row and predicates <= {*DIRECTIONS, "on_top", "inside"}:
        yield f"the relations along {AXES[axis]} form a circle: {names}"
    elif predicates & DIRECTIONS.keys():
        yield f"there is no room along {AXES[axis]} for the row {names}"
    else:
        yield _never_together(true)


def _reach_reasons(true: Sequence[Fact], scene: Scene, gaps: Sequence[Iterable[Gap]]) -> Iterator[str]:
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


def _never_together(facts: Iterable[Fact]) -> str:
    """Return in words that facts exclude each other."""
    *others, last = [fact.sentence() for fact in facts]
    return f"{', '.join(others)} and {last} exclude each other" if others else f"{last} is never so"


def _still(scene: Scene) -> Situation:
    """Return the situation of the bodies that never move, not even a part of them."""
    poses = {
        entity: Pose((x, y, scene.shapes[entity].half[2]), yaw_quaternion(yaw))
        for entity, (x, y, yaw) in scene.fixed.items()
        if scene.shapes[entity].kind not in (*FURNITURE, *BODILESS)
    }
    return Situation(scene, poses, Pose((0.0, 0.0, 1.0), IDENTITY), 0.0)
