"""Sample the initial state of a task: each object gets a pose that the facts allow; unknown fluents are arbitrary."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable
from dataclasses import replace

from prag_asp.physics.predicates import Gripper
from prag_asp.physics.predicates.on_top import ON_TOP
from prag_asp.physics.search.action_effects import take_place
from prag_asp.physics.search.attempt import RELATION, Failure, Search, Snapshot
from prag_asp.physics.search.furniture_handling import sample_openings
from prag_asp.physics.search.meeting import move_over
from prag_asp.physics.search.moving import raise_arm, require_free, turn_to, verify_objects
from prag_asp.physics.search.packing import pack, resting_pose
from prag_asp.physics.situation import Situation, fixed_pose
from prag_asp.physics.symbolic_facts import Fact, PhysicalTask, of_robot
from prag_asp.physics.witness import Arm
from prag_asp.scene.robots import robot_of
from prag_asp.scene.scene import Scene

BACKTRACKS = 12
"""The maximum number of backtracking steps in an initial state before the search starts over."""


def sample_initial_state(search: Search, physical: PhysicalTask) -> Snapshot:
    """Return a snapshot that satisfies the facts of the initial state.

    Raises:
        Failure: a fact is violated or bodies collide in this attempt.
    """
    scene = search.scene
    poses = {entity: fixed_pose(scene, entity) for entity in scene.fixed if entity in physical.objects}
    robots = {name: robot_of(scene, name) for name in scene.robots}
    still = Situation(scene, poses, {name: Arm(robot.home, robot.opening) for name, robot in robots.items()})
    for furniture, opening in sample_openings(search, still, physical.initial).items():
        still = still.with_opening(furniture, opening)
    situation = _arrange(search, physical, still)
    verify_objects(search, situation, physical.objects)
    snapshot = Snapshot(situation, next(iter(robots)))
    for robot in robots:
        snapshot = _bring(search, turn_to(search, snapshot, robot), physical)
    for fact in physical.initial:
        if not fact.is_satisfied(snapshot.situation):
            raise Failure(RELATION, fact=fact, missed=fact.distance(snapshot.situation))
    return snapshot


def _about(physical: PhysicalTask, entity: str, situation: Situation) -> tuple[Fact, ...]:
    """Return the facts of the initial state that the pose of an object has to satisfy.

    An object that a robot holds in the air is first placed below its gripper and grasped there.
    """
    holder = next((robot for robot, thing in physical.held.items() if thing == entity), None)
    if holder is None or not (situation.scene.shared or _in_the_air(physical, entity)):
        return physical.initial
    own = of_robot(physical.initial, holder)
    below = [fact.arguments[1] for fact in own if fact.value and fact.predicate.gripper is Gripper.OVER]
    lies = [Fact(ON_TOP, (entity, place), True) for place in below if situation.is_surface(place)]
    return (*(fact for fact in physical.initial if entity not in fact.arguments), *lies)


def _in_the_air(physical: PhysicalTask, entity: str) -> bool:
    """Return whether a held object is known to have no support: some fact denies a support, and no fact states one."""
    supports = [fact for fact in physical.initial if fact.predicate.supports and fact.arguments[0] == entity]
    return bool(supports) and not any(fact.value for fact in supports)


def _bring(search: Search, snapshot: Snapshot, physical: PhysicalTask) -> Snapshot:
    """Move the acting arm to where the facts of the initial state require it to be.

    Raises:
        Failure: the arm cannot get there without a collision.
    """
    own = of_robot(physical.initial, snapshot.acting)
    held, over = physical.held.get(snapshot.acting), _place(own, Gripper.OVER)
    place = held or _place(own, Gripper.AT)
    if place is not None:
        snapshot = take_place(search, snapshot, place, closed=held is not None)
        lifted = held is not None and (search.scene.shared or _in_the_air(physical, held))
        return raise_arm(search, snapshot) if lifted else snapshot
    if over is not None:
        snapshot = move_over(search, snapshot, over, 0)
    else:
        require_free(search, snapshot)
    if any(fact.predicate.gripper is Gripper.OPEN and not fact.value for fact in own):
        return snapshot.with_arm(replace(snapshot.arm, width=0.0), snapshot.above)
    return snapshot


def _arrange(search: Search, physical: PhysicalTask, still: Situation) -> Situation:
    """Return a situation with all objects at poses that the facts allow, placed one after the other.

    If there is no pose for an object, backtrack to an earlier object related to it: first to the last such object, the
    next time to the one before it, and so on. A search that `packs` places the objects tightly instead.

    Raises:
        Failure: there is no earlier object to backtrack to, or the search has backtracked `BACKTRACKS` times.
    """
    order = [entity for entity in order_of(physical, search.scene) if entity not in still.poses]
    if search.packs:
        return pack(search, still, order, lambda entity, situation: _about(physical, entity, situation))
    partners: dict[str, set[str]] = {}
    for fact in physical.initial:
        for entity in fact.arguments if fact.value else ():
            partners.setdefault(entity, set()).update(fact.arguments)
    situations, failures = [still], Counter[str]()
    while len(situations) <= len(order):
        entity, situation = order[len(situations) - 1], situations[-1]
        try:
            about = _about(physical, entity, situation)
            pose = resting_pose(search, situation, entity, about, 0)
        except Failure:
            earlier = [i for i, other in enumerate(order[: len(situations) - 1]) if other in partners.get(entity, ())]
            if not earlier or failures.total() >= BACKTRACKS:
                raise
            failures[entity] += 1
            del situations[earlier[-failures[entity] % len(earlier)] + 1 :]
        else:
            situations.append(situation.with_pose(entity, pose))
    return situations[-1]


def order_of(physical: PhysicalTask, scene: Scene) -> list[str]:
    """Return the objects in the order in which they are placed, large ones before small ones.

    Supports come before the objects on them. Unless there is a cycle, the other arguments of a relation come before its
    subject, whose volume depends on them; for a predicate with an inverse, this order does not matter.
    """
    below: dict[str, set[str]] = {entity: set() for entity in physical.objects}
    before: dict[str, set[str]] = {entity: set() for entity in physical.objects}
    for fact in physical.initial:
        predicate, subject = fact.predicate, fact.arguments[fact.predicate.subject]
        if not fact.value or predicate.of_gripper or predicate.inverse is not None or subject not in below:
            continue
        others = (below.keys() & set(fact.arguments)) - {subject}
        before[subject] |= others
        if predicate.places:
            below[subject] |= others
    ordered: list[str] = []
    waiting = sorted(physical.objects, key=lambda entity: -scene.shapes[entity].size[0] * scene.shapes[entity].size[1])
    while waiting:
        ready = [entity for entity in waiting if before[entity] <= set(ordered)]
        ready = ready or [entity for entity in waiting if below[entity] <= set(ordered)] or waiting
        ordered.append(ready[0])
        waiting.remove(ready[0])
    return ordered


def _place(facts: Iterable[Fact], does: Gripper) -> str | None:
    """Return the object at or over which the gripper is known to be."""
    return next((fact.arguments[1] for fact in facts if fact.value and fact.predicate.gripper is does), None)
