"""Proofs that no poses of the bodies satisfy the facts of a state.

A proof assumes the definitions of the predicates, the poses of the fixed bodies, and six rules of every scene: a
gripper holds one body at a time, it is not open while it holds one, nothing rests on a ball, a primitive is held from
above while it stands upright, the fingertips stay above its bottom, and a gripper lifts each body that it moves, which
requires enough friction. The check of a witness enforces the last three rules as well. The workspace limits the
positions at which the search places bodies, but not those at which bodies can be, so no proof uses it. Proofs are
monotonic: a proof from some facts is valid for any superset of them.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Iterable, Iterator, Sequence
from dataclasses import dataclass
from itertools import chain, product
from typing import NamedTuple

from prag_asp.atom import Atom
from prag_asp.physics.predicates import PREDICATES
from prag_asp.physics.predicates.gaps import Demand, Gap, Node
from prag_asp.physics.predicates.grip_friction import slips
from prag_asp.physics.proofs.placement_demands import all_demands, bodies
from prag_asp.physics.proofs.reasons import (
    AXES,
    exclusions,
    gap_reasons,
    own_reasons,
    reach_reasons,
    room_reasons,
)
from prag_asp.physics.proofs.surfaces import surface_reasons
from prag_asp.physics.symbolic_facts import ActionEffect, Fact, PhysicalTask
from prag_asp.scene.scene import Scene

REMEMBERED = 1 << 14
"""The maximum number of groups of facts whose results a prover caches."""


@dataclass(frozen=True)
class Impossibility:
    """A proof that a state is impossible or cannot be reached: the reason in words, and the facts that imply it.

    These facts form a minimal set. `state` counts from 0, the initial state; `after` is the action that leads to the
    state, or None for the initial state. If the action itself is impossible, the facts include facts of the previous
    state.
    """

    reason: str
    facts: tuple[Fact, ...]
    state: int
    after: Atom | None

    def __str__(self) -> str:
        where = "the initial state" if self.after is None else f"the state after {self.after}"
        return f"{where}: {self.reason}"


class Constraints(NamedTuple):
    """The constraints that a fact implies for all sizes of its bodies, and the movable bodies and grippers involved."""

    demands: tuple[Demand, ...]
    names: frozenset[str]


class Prover:
    """A prover that states of a scene are impossible, with a cache of results about facts."""

    def __init__(self, scene: Scene):
        self._scene = scene
        self._constraints: dict[Fact, Constraints] = {}
        self._alone: dict[Fact, str | None] = {}
        self._known: dict[frozenset[Fact], str | None] = {}

    def impossibility(self, physical: PhysicalTask) -> Impossibility | None:
        """Return a proof that a task is infeasible, or None if nothing is proved."""
        seen = set[Fact]()
        for k, facts in enumerate(physical.states):
            fresh = [fact for fact in facts if fact not in seen]
            seen.update(fresh)
            if next(self._reasons(facts, fresh), None) is not None:
                least = self.fewest(facts)
                reason = next(self._reasons(least, least))
                return Impossibility(reason, least, k, physical.effects[k - 1].action if k else None)
        for number, effect in enumerate(physical.effects, 1):
            lift = _lift(effect, physical.states[number - 1])
            if lift is not None:
                robot, entity = lift[1].arguments
                by_size = [slips(sized, entity, robot) for sized in self._sized(lift[1])]
                if by_size[0] is not None and None not in by_size:
                    return Impossibility(by_size[0], lift, number, effect.action)
        return None

    def refutation(self, facts: Sequence[Fact]) -> str | None:
        """Return the reason why the given facts cannot hold together, or None if nothing is proved."""
        return next(self._reasons(facts, facts), None)

    def fewest(self, facts: Sequence[Fact]) -> tuple[Fact, ...]:
        """Return a minimal subset of the given facts that cannot hold together."""
        left = list(facts)
        for fact in facts:
            fewer = [other for other in left if other != fact]
            if self.refutation(fewer) is not None:
                left = fewer
        return tuple(left)

    def _reasons(self, facts: Sequence[Fact], fresh: Collection[Fact]) -> Iterator[str]:
        """Yield reasons why facts cannot hold together; reasons that involve no `fresh` fact may be omitted."""
        for fact in fresh:
            if fact not in self._alone:
                by_size = [next(own_reasons(fact, sized), None) for sized in self._sized(fact)]
                self._alone[fact] = None if None in by_size else by_size[0]
            never = self._alone[fact]
            if never is not None:
                yield never
        yield from surface_reasons(facts, fresh, self._scene)
        new = [fact for fact in fresh if fact.value]
        if not new:
            return
        true = [fact for fact in facts if fact.value]
        yield from gap_reasons(true)
        yield from exclusions(true, self._scene)
        for group in self._groups(true):
            if not group.isdisjoint(new):
                reason = self._together(group)
                if reason is not None:
                    yield reason

    def _groups(self, true: Iterable[Fact]) -> list[frozenset[Fact]]:
        """Return the facts with constraints, grouped by the movable bodies and grippers that they share.

        The positions of other bodies are known, so an unsatisfiable cycle of constraints lies within one group.
        """
        groups: list[tuple[set[str], list[Fact]]] = []
        for fact in true:
            names, members = set(self._constrain(fact).names), [fact]
            if not names:
                continue
            apart = []
            for group in groups:
                if group[0].isdisjoint(names):
                    apart.append(group)
                else:
                    names |= group[0]
                    members = [*group[1], *members]
            groups = [*apart, (names, members)]
        return [frozenset(members) for _, members in groups]

    def _together(self, group: frozenset[Fact]) -> str | None:
        """Return the reason why no positions of bodies satisfy facts, or None if nothing is proved; uses a cache."""
        if group not in self._known:
            true = sorted(group, key=lambda fact: (fact.predicate.name, fact.arguments))
            gaps: tuple[dict[Gap, None], ...] = ({}, {}, {})
            for fact in true:
                for axis, gap in self._constrain(fact).demands:
                    gaps[axis][gap] = None
            rows = chain.from_iterable(room_reasons(true, axis, list(gaps[axis])) for axis in range(len(AXES)))
            if len(self._known) >= REMEMBERED:
                self._known.clear()
            self._known[group] = next(chain(rows, reach_reasons(true, self._scene, gaps)), None)
        return self._known[group]

    def _constrain(self, fact: Fact) -> Constraints:
        """Return a fact's constraints, with the weakest bounds over all sizes of its bodies; results are cached."""
        if fact not in self._constraints:
            bounds = []
            for sized in self._sized(fact):
                strongest: dict[tuple[int, Node, Node], float] = {}
                for axis, (low, high, least) in all_demands(fact, sized):
                    strongest[axis, low, high] = max(least, strongest.get((axis, low, high), -math.inf))
                bounds.append(strongest)
            common = [where for where in bounds[0] if all(where in other for other in bounds)]
            demands = [(where[0], Gap(*where[1:], min(each[where] for each in bounds))) for where in common]
            names = {name for _, *ends in common for name, _ in ends if name and name not in self._scene.fixed}
            self._constraints[fact] = Constraints(tuple(demands), frozenset(names))
        return self._constraints[fact]

    def _sized(self, fact: Fact) -> Iterator[Scene]:
        """Yield the scene with each combination of sizes for the bodies in a fact."""
        drawn = [entity for entity in bodies(fact, self._scene) if entity in self._scene.ranges]
        for shapes in product(*(self._scene.ranges[entity] for entity in drawn)):
            yield self._scene.with_shapes(dict(zip(drawn, shapes, strict=True)))


def _lift(effect: ActionEffect, before: tuple[Fact, ...]) -> tuple[Fact, Fact, Fact] | None:
    """Return the facts that an object is at a place, is held, and is no longer there, or None if no object is lifted.

    A gripper may close around anything that it spans, but only lifting puts a load on it. A witness lifts each object
    that it moves: the arm retreats straight up after a grasp, and comes straight down before a release.

    The place itself is certain to keep still only if an action moves nothing but the object and opens nothing. An
    object in a handover may stay where it is.
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
