"""The physical meaning of a symbolic task: the spatial facts of its states, and the effects of its actions."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple

from prag_asp.atom import Atom
from prag_asp.errors import SceneError
from prag_asp.physics.predicates import Gripper, Predicate, predicate_of
from prag_asp.physics.situation import Situation
from prag_asp.scene.scene import Scene
from prag_asp.task import State, Task
from prag_asp.wording import plural

BORDER = 1e-12
"""The distance, in metres or radians, from the border of a predicate to a situation in which it does not hold."""


class Fact(NamedTuple):
    """A spatial predicate that is known to hold, or known not to hold, for some entities."""

    predicate: Predicate
    arguments: tuple[str, ...]
    value: bool

    def is_satisfied(self, situation: Situation) -> bool:
        """Return whether a situation satisfies the fact."""
        return self.predicate.holds(situation, self.arguments) == self.value

    def distance(self, situation: Situation) -> float:
        """Return the signed distance of a situation from satisfying the fact, in metres or radians.

        If the fact is satisfied, the distance is at most 0, and its absolute value is the margin. For a predicate that
        must not hold, it is the depth of the situation within the predicate, which is more than 0 even on the border.
        """
        signed = self.predicate.signed_distance(situation, self.arguments)
        return signed if self.value else (-signed or BORDER)

    def distance_up_to(self, situation: Situation, bound: float) -> float:
        """Return the signed distance if it exceeds a bound; otherwise any number from the distance to the bound.

        The result is at most 0 if and only if the fact is satisfied.
        """
        if self.value:
            return self.distance(situation)
        largest = -math.inf
        for violation in self.predicate.violations(situation, self.arguments):
            if violation > largest:
                largest = violation
                if largest > 0.0 and -largest <= bound:
                    break
        return -largest or BORDER

    def way(self, situation: Situation) -> float:
        """Return the length of a path to a situation that satisfies the fact, in metres or radians.

        It is the distance, or more if the direct path is blocked, and it is at most 0 if and only if the fact is
        satisfied.
        """
        return self.predicate.signed_way(situation, self.arguments) if self.value else self.distance(situation)

    def sentence(self) -> str:
        """Return the fact in plain words."""
        return self.predicate.sentence(self.arguments, self.value)


@dataclass(frozen=True)
class ActionEffect:
    """The physical effect of an action.

    `grasps`, `releases` and `visits` name the object that the gripper grasps, releases or moves to; `over` names the
    object over which it moves. `holds` is the object held before and after. The gripper belongs to `robot`; `giver` is
    the other robot in a handover. `leaves` means that the gripper leaves its object, `lifts` that a grasped object
    leaves its support, and `stays` that the gripper remains at a released object. `moved` are the objects that the
    action makes the subject of a relation, `turns` is the furniture that it opens or closes, `closes` means that it
    closes the gripper. `after` are the facts of the resulting state `number`, and `fresh` those that are not in the
    state before it.
    """

    action: Atom
    number: int
    grasps: str | None
    releases: str | None
    holds: str | None
    visits: str | None
    leaves: bool
    lifts: bool
    stays: bool
    moved: tuple[str, ...]
    turns: tuple[str, ...]
    closes: bool
    after: tuple[Fact, ...]
    fresh: tuple[Fact, ...]
    over: str | None = None
    robot: str | None = None
    giver: str | None = None


@dataclass(frozen=True)
class PhysicalTask:
    """The physical meaning of a task: its bodies, the facts in its initial state, and the effects of its actions.

    `held` maps each robot that holds an object in the initial state to that object.
    """

    objects: tuple[str, ...]
    initial: tuple[Fact, ...]
    held: Mapping[str, str]
    effects: tuple[ActionEffect, ...]

    @property
    def states(self) -> tuple[tuple[Fact, ...], ...]:
        """The facts of every state, the initial one first."""
        return (self.initial, *(effect.after for effect in self.effects))


def facts(scene: Scene, state: State) -> tuple[Fact, ...]:
    """Return the spatial facts in a state; other fluents are ignored.

    Raises:
        SceneError: the scene lacks the shape or the yaw of an entity in a spatial fluent.
    """
    return _facts(scene, state, {})


def physical_task(task: Task, scene: Scene) -> PhysicalTask:
    """Return the physical meaning of a task.

    Raises:
        SceneError: the scene lacks the shape or the yaw of an entity in a spatial fluent.
    """
    cache: dict[tuple[Atom, bool], Fact | None] = {}
    states = [_facts(scene, state, cache) for state in (task.initial, *task.states)]
    first = {robot: _only(of_robot(states[0], robot), Gripper.HOLDS) for robot in scene.robots}
    start = {robot: thing for robot, thing in first.items() if thing}
    held, effects = dict(start), list[ActionEffect]()
    for k, action in enumerate(task.actions):
        subgoal = _facts(scene, task.subgoals[k], cache)
        effect = _effect(scene, action, subgoal, k + 1, states, held)
        if effect.robot is not None and effect.releases is not None:
            held.pop(effect.robot, None)
        if effect.giver is not None:
            held.pop(effect.giver, None)
        if effect.robot is not None and effect.grasps is not None:
            held[effect.robot] = effect.grasps
        effects.append(effect)
    named = {entity for facts_of in states for fact in facts_of for entity in fact.arguments}
    # Fixed bodies are obstacles even if the task does not name them.
    entities = dict.fromkeys([*task.entities, *sorted(named), *scene.fixed])
    objects = tuple(each for each in entities if each in scene.shapes and scene.shapes[each].traits.body)
    return PhysicalTask(objects, states[0], start, tuple(effects))


def _facts(scene: Scene, state: State, cache: dict[tuple[Atom, bool], Fact | None]) -> tuple[Fact, ...]:
    """Return the spatial facts in a state; `cache` stores the meanings of fluents."""
    for item in state.items():
        if item not in cache:
            cache[item] = _fact(scene, *item)
    meanings = [cache[item] for item in state.items()]
    return tuple([fact for fact in meanings if fact is not None])


def _fact(scene: Scene, atom: Atom, value: bool) -> Fact | None:
    """Return the fact that a fluent states, or None if the fluent is not spatial."""
    name = scene.meaning(atom)
    if name is None:
        return None
    roles = scene.roles(name)
    if len(roles) != len(atom.arguments):
        raise SceneError(f"{atom} has {plural(len(atom.arguments), 'argument')}, but {name} takes {', '.join(roles)}")
    for role, entity in zip(roles, atom.arguments, strict=True):
        names: Mapping[str, object] = scene.rotations if role == "rotation" else scene.shapes
        if entity not in names:
            table = "rotations" if role == "rotation" else "shapes"
            raise SceneError(f"{atom} names {entity}, which has no entry under [scene.{table}]")
    if not value and len(set(atom.arguments)) < len(atom.arguments):
        return None  # no object is in a relation with itself
    own = scene.own.get(name)
    around = () if own is None or own.around is None else (own.around,)
    return Fact(predicate_of(scene, name), (*atom.arguments, *around), value)


def of_robot(state: Iterable[Fact], robot: str | None) -> list[Fact]:
    """Return the facts of a state about a robot's gripper, and those about no gripper."""
    return [fact for fact in state if not fact.predicate.of_gripper or fact.arguments[0] == robot]


def _acting(scene: Scene, subgoal: tuple[Fact, ...]) -> str | None:
    """Return the robot that an action moves: the one that grasps an object, or else the first one in the subgoal.

    The result is None if the subgoal concerns no gripper and there are several robots.
    """
    grippers = [fact for fact in subgoal if fact.predicate.of_gripper]
    ranked = sorted(grippers, key=lambda fact: (not fact.value, fact.predicate.gripper is not Gripper.HOLDS))
    possible = [fact.arguments[0] for fact in ranked[:1]] or list(scene.robots)
    return possible[0] if len(possible) == 1 else None


def _giver(subgoal: Iterable[Fact], robot: str | None, thing: str | None, all_held: Mapping[str, str]) -> str | None:
    """Return the other robot, which releases the object that a robot grasps, or None if there is none."""
    for fact in subgoal:
        other = fact.arguments[0]
        lets_go = fact.predicate.gripper is Gripper.HOLDS and not fact.value and fact.arguments[1] == thing
        if lets_go and other != robot and all_held.get(other) == thing:
            return other
    return None


def _effect(
    scene: Scene,
    action: Atom,
    all_of_subgoal: tuple[Fact, ...],
    number: int,
    states: Sequence[tuple[Fact, ...]],
    all_held: Mapping[str, str],
) -> ActionEffect:
    """Return the effect of the action that leads to state `number` (from 1), from its subgoal and the states."""
    before, after = set(states[number - 1]), states[number]
    robot = _acting(scene, all_of_subgoal)
    held = None if robot is None else all_held.get(robot)
    subgoal = of_robot(all_of_subgoal, robot)
    grasps = _only(subgoal, Gripper.HOLDS)
    releases = held if _known(subgoal, Gripper.HOLDS, held) is False else None
    visits = _only(subgoal, Gripper.AT)
    holds = held if grasps is None and releases is None else None
    moved = []
    for fact in subgoal:
        if fact.value and not (fact.predicate.of_gripper or fact.predicate.of_joint):
            # A held object moves even if it is not the subject of the relation.
            carried = held in fact.arguments and not fact.predicate.places
            moved.append(str(held) if carried else fact.arguments[fact.predicate.subject])
    turned = [f.arguments[0] for f in subgoal if f.predicate.of_joint and f not in before]
    return ActionEffect(
        action=action,
        number=number,
        grasps=grasps,
        releases=releases,
        holds=holds,
        visits=visits,
        leaves=any(fact.predicate.gripper is Gripper.AT and not fact.value for fact in subgoal) and visits is None,
        lifts=grasps is not None
        and any(f.predicate.supports and not f.value and f.arguments[0] == grasps for f in subgoal),
        stays=releases is not None and _known(of_robot(after, robot), Gripper.AT, releases) is True,
        moved=tuple(dict.fromkeys(moved)),
        turns=tuple(dict.fromkeys(turned)),
        closes=any(fact.predicate.gripper is Gripper.OPEN and not fact.value for fact in subgoal),
        after=after,
        fresh=tuple(fact for fact in after if fact not in before),
        over=_only(subgoal, Gripper.OVER),
        robot=robot,
        giver=_giver(all_of_subgoal, robot, grasps, all_held),
    )


def _only(state: Iterable[Fact], does: Gripper) -> str | None:
    """Return the object in a positive fact about a gripper, or None if there is none."""
    return next((f.arguments[1] for f in state if f.predicate.gripper is does and f.value), None)


def _known(state: Iterable[Fact], does: Gripper, entity: str | None) -> bool | None:
    """Return the value of a fact about a gripper and an object, or None if it is unknown."""
    matching = (f.value for f in state if f.predicate.gripper is does and f.arguments[1] == entity)
    return next(matching, None)
