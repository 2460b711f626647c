"""From a symbolic task to what physics has to bring about: facts of states and effects of actions."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
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
"""How far it is from where a predicate just holds to where it does not, in metres or radians."""


class Fact(NamedTuple):
    """A spatial predicate that is known to hold, or known not to hold, of some entities."""

    predicate: Predicate
    arguments: tuple[str, ...]
    value: bool

    def satisfied(self, situation: Situation) -> bool:
        """Check the fact on a situation."""
        return self.predicate.holds(situation, self.arguments) == self.value

    def distance(self, situation: Situation) -> float:
        """Return how far a situation is from satisfying the fact, in metres or radians; at most 0 where it does.

        Where it is satisfied, this is minus what it has to spare. That of a predicate that shall not hold is how deep
        the situation is in where it does: no less than what has to be moved, and more than 0 on the border.
        """
        signed = self.predicate.signed_distance(situation, self.arguments)
        return signed if self.value else (-signed or BORDER)

    def way(self, situation: Situation) -> float:
        """Return how far there is to go until a situation satisfies the fact, in metres or radians.

        It is the distance, or more where the shortest way is barred; at most 0 exactly where the fact is satisfied.
        """
        return self.predicate.signed_way(situation, self.arguments) if self.value else self.distance(situation)

    def sentence(self) -> str:
        """Return the fact in plain words."""
        return self.predicate.sentence(self.arguments, self.value)


class Step(NamedTuple):
    """What a task says of one action: its number from 1, its subgoal, and the facts of the states around it."""

    action: Atom
    number: int
    subgoal: tuple[Fact, ...]
    before: tuple[Fact, ...]
    after: tuple[Fact, ...]


@dataclass(frozen=True)
class Effect:
    """What one action does to the bodies.

    `grasps`, `releases` and `visits` name the object that the gripper takes, lets go, or goes to, `over` what it
    moves to be over. `holds` is the object held before and after. The gripper is that of `robot`, and `giver` the
    other one that lets a grasped object go. `leaves` is set where the gripper goes away from its
    object, `lifts` where a grasped object leaves what it stands on, `stays` where the gripper remains at a released
    object. `moved` are objects that the action makes the subject of a relation, `turns` the furniture that it opens or
    closes. `after` are the facts of the state
    `number` that it leads to, `fresh` those of them that the state before does not know.
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
    """A task as physics sees it: the bodies that take part, the facts of the first state, the effects.

    `held` says what each robot that holds something holds in the first state.
    """

    objects: tuple[str, ...]
    initial: tuple[Fact, ...]
    held: Mapping[str, str]
    effects: tuple[Effect, ...]

    @property
    def states(self) -> tuple[tuple[Fact, ...], ...]:
        """The facts of every state, the initial one first."""
        return (self.initial, *(effect.after for effect in self.effects))


def facts(scene: Scene, state: State) -> tuple[Fact, ...]:
    """Return what a state says about space; other fluents are left out.

    Raises:
        SceneError: the scene lacks the shape or the yaw of an entity that a spatial fluent speaks about.
    """
    return _facts(scene, state, {})


def physical_task(task: Task, scene: Scene) -> PhysicalTask:
    """Return a task as physics sees it.

    Raises:
        SceneError: the scene lacks the shape or the yaw of an entity that a spatial fluent speaks about.
    """
    known: dict[tuple[Atom, bool], Fact | None] = {}
    states = [_facts(scene, state, known) for state in (task.initial, *task.states)]
    first = {robot: _only(of_robot(states[0], robot), Gripper.HOLDS) for robot in scene.robots}
    start = {robot: thing for robot, thing in first.items() if thing}
    held, effects = dict(start), list[Effect]()
    for k, action in enumerate(task.actions):
        subgoal = _facts(scene, task.subgoals[k], known)
        effect = _effect(scene, Step(action, k + 1, subgoal, states[k], states[k + 1]), held)
        if effect.robot is not None and effect.releases is not None:
            held.pop(effect.robot, None)
        if effect.giver is not None:
            held.pop(effect.giver, None)
        if effect.robot is not None and effect.grasps is not None:
            held[effect.robot] = effect.grasps
        effects.append(effect)
    named = {entity for facts_of in states for fact in facts_of for entity in fact.arguments}
    # What never moves is there whether the task speaks of it or not.
    objects = tuple(entity for entity in [*task.entities, *sorted(named), *scene.fixed] if _is_object(scene, entity))
    return PhysicalTask(tuple(dict.fromkeys(objects)), states[0], start, tuple(effects))


def _facts(scene: Scene, state: State, known: dict[tuple[Atom, bool], Fact | None]) -> tuple[Fact, ...]:
    """Return what a state says about space, each fluent read once into `known`."""
    for item in state.items():
        if item not in known:
            known[item] = _fact(scene, *item)
    found = [known[item] for item in state.items()]
    return tuple([fact for fact in found if fact is not None])


def _fact(scene: Scene, atom: Atom, value: bool) -> Fact | None:
    """Return a fluent as a fact, None where it means nothing to physics."""
    name = scene.meaning(atom)
    if name is None:
        return None
    roles = scene.roles(name)
    if len(roles) != len(atom.arguments):
        raise SceneError(f"{atom} has {plural(len(atom.arguments), 'argument')}, but {name} takes {', '.join(roles)}")
    for role, entity in zip(roles, atom.arguments, strict=True):
        known: Mapping[str, object] = scene.rotations if role == "rotation" else scene.shapes
        if entity not in known:
            table = "rotations" if role == "rotation" else "shapes"
            raise SceneError(f"{atom} speaks about {entity}, which has no entry under [scene.{table}]")
    if not value and len(set(atom.arguments)) < len(atom.arguments):
        return None  # nothing is in a relation to itself
    own = scene.own.get(name)
    around = () if own is None or own.around is None else (own.around,)
    return Fact(predicate_of(scene, name), (*atom.arguments, *around), value)


def of_robot(state: Iterable[Fact], robot: str | None) -> list[Fact]:
    """Return what a state says of a robot's gripper, and what it says of no gripper."""
    return [fact for fact in state if not fact.predicate.of_gripper or fact.arguments[0] == robot]


def _acting(scene: Scene, subgoal: tuple[Fact, ...]) -> str | None:
    """Return the robot that an action moves: the one that gets hold of something, or else whose gripper does most.

    None where the subgoal speaks of no gripper, and any of several may be meant.
    """
    grippers = [fact for fact in subgoal if fact.predicate.of_gripper]
    ranked = sorted(grippers, key=lambda fact: (not fact.value, fact.predicate.gripper is not Gripper.HOLDS))
    possible = [fact.arguments[0] for fact in ranked[:1]] or list(scene.robots)
    return possible[0] if len(possible) == 1 else None


def _giver(subgoal: Iterable[Fact], robot: str | None, thing: str | None, all_held: Mapping[str, str]) -> str | None:
    """Return the other robot that lets a thing go that one takes, None where none does."""
    for fact in subgoal:
        other = fact.arguments[0]
        lets_go = fact.predicate.gripper is Gripper.HOLDS and not fact.value and fact.arguments[1] == thing
        if lets_go and other != robot and all_held.get(other) == thing:
            return other
    return None


def _effect(scene: Scene, step: Step, all_held: Mapping[str, str]) -> Effect:
    """Return what an action does, read off its whole subgoal and the states around it."""
    robot = _acting(scene, step.subgoal)
    held = None if robot is None else all_held.get(robot)
    subgoal = of_robot(step.subgoal, robot)
    grasps = _only(subgoal, Gripper.HOLDS)
    releases = held if _known(subgoal, Gripper.HOLDS, held) is False else None
    visits = _only(subgoal, Gripper.AT)
    holds = held if grasps is None and releases is None else None
    moved = [_moved(fact, held) for fact in subgoal if fact.value and _moves(fact)]
    known_before = set(step.before)
    return Effect(
        action=step.action,
        number=step.number,
        grasps=grasps,
        releases=releases,
        holds=holds,
        visits=visits,
        leaves=any(fact.predicate.gripper is Gripper.AT and not fact.value for fact in subgoal) and visits is None,
        lifts=grasps is not None
        and any(f.predicate.supports and not f.value and f.arguments[0] == grasps for f in subgoal),
        stays=releases is not None and _known(of_robot(step.after, robot), Gripper.AT, releases) is True,
        moved=tuple(dict.fromkeys(moved)),
        turns=tuple(dict.fromkeys(fact.arguments[0] for fact in subgoal if _turns(fact, known_before))),
        closes=_closes(subgoal),
        after=step.after,
        fresh=tuple(fact for fact in step.after if fact not in known_before),
        over=_only(subgoal, Gripper.OVER),
        robot=robot,
        giver=_giver(step.subgoal, robot, grasps, all_held),
    )


def _moves(fact: Fact) -> bool:
    """Tell whether an object is moved to make a fact true, not a gripper or a part of furniture."""
    return not (fact.predicate.of_gripper or fact.predicate.of_joint)


def _moved(fact: Fact, held: str | None) -> str:
    """Return the object that moves when a fact is made true: what the gripper holds, where it is one of two or more."""
    if held in fact.arguments and not fact.predicate.places:
        return str(held)
    return fact.arguments[fact.predicate.subject]


def _turns(fact: Fact, known: set[Fact]) -> bool:
    """Tell whether a fact says that furniture is open or closed, and is not known already."""
    return fact.predicate.of_joint and fact not in known


def _closes(subgoal: Iterable[Fact]) -> bool:
    """Tell whether an action closes the gripper."""
    return any(fact.predicate.gripper is Gripper.OPEN and not fact.value for fact in subgoal)


def _only(state: Iterable[Fact], does: Gripper) -> str | None:
    """Return the object with which a gripper is known to do something, None where there is none."""
    return next((f.arguments[1] for f in state if f.predicate.gripper is does and f.value), None)


def _known(state: Iterable[Fact], does: Gripper, entity: str | None) -> bool | None:
    """Return whether a gripper is known to do something with an object or not to, None where it is unknown."""
    matching = (f.value for f in state if f.predicate.gripper is does and f.arguments[1] == entity)
    return next(matching, None)


def _is_object(scene: Scene, entity: str) -> bool:
    """Tell whether an entity is a body of its own: it has a shape, and is no robot, table or zone."""
    return entity in scene.shapes and scene.shapes[entity].traits.body
