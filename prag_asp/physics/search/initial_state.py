"""Draw the first state of a task: each object gets a pose that the facts allow; the unknown is free."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping
from dataclasses import replace

from prag_asp.physics.predicates import Gripper
from prag_asp.physics.predicates.on_top import ON_TOP
from prag_asp.physics.search.action_effects import take_place
from prag_asp.physics.search.attempt import ARM_COLLIDES, RELATION, Failure, Search, Snapshot
from prag_asp.physics.search.furniture_handling import draw_openings
from prag_asp.physics.search.grasping import Configuration, collide
from prag_asp.physics.search.meeting import move_over
from prag_asp.physics.search.moving import raise_arm, turn_to, verify_objects
from prag_asp.physics.search.placement import any_support, draw_pose, known_support
from prag_asp.physics.situation import Situation, fixed_pose
from prag_asp.physics.symbolic_facts import Fact, PhysicalTask, of_robot
from prag_asp.physics.witness import Arm
from prag_asp.scene.geometry import Pose
from prag_asp.scene.robots import robot_of
from prag_asp.scene.scene import Scene

BACKTRACKS = 12
"""How often a first state goes back to an object that was put down before, instead of beginning anew."""


def draw_start(search: Search, physical: PhysicalTask) -> Snapshot:
    """Return a snapshot that satisfies the facts of the initial state.

    Raises:
        Failure: this attempt found none.
    """
    snapshot = _at_home(search, fixed_poses(search, physical))
    still = snapshot.situation
    for furniture, opening in draw_openings(search, still, physical.initial).items():
        still = still.with_opening(furniture, opening)
    situation = _arranged(search, physical, still)
    verify_objects(search, situation, physical.objects)
    snapshot = replace(snapshot, situation=situation)
    for robot in search.scene.robots:
        snapshot = _bring(search, turn_to(search, snapshot, robot), physical)
    for fact in physical.initial:
        if not fact.satisfied(snapshot.situation):
            raise Failure(RELATION, fact=fact)
    return snapshot


def _at_home(search: Search, poses: Mapping[str, Pose]) -> Snapshot:
    """Return a snapshot in which every arm waits, the gripper open; the first one is to act."""
    robots = {name: robot_of(search.scene, name) for name in search.scene.robots}
    arms = {name: Arm(robot.home, robot.opening) for name, robot in robots.items()}
    return turn_to(search, Snapshot(Situation(search.scene, poses, arms), next(iter(arms))), None)


def _about(physical: PhysicalTask, entity: str, situation: Situation) -> tuple[Fact, ...]:
    """Return what an object's place has to agree with: the facts of the first state.

    An object that a robot holds in the air is first put down below its gripper, to be taken from there.
    """
    holder = next((robot for robot, thing in physical.held.items() if thing == entity), None)
    if holder is None or not (situation.scene.shared or _in_the_air(physical, entity)):
        return physical.initial
    own = of_robot(physical.initial, holder)
    below = [fact.arguments[1] for fact in own if fact.value and fact.predicate.gripper is Gripper.OVER]
    lies = [Fact(ON_TOP, (entity, place), True) for place in below if situation.is_surface(place)]
    return (*(fact for fact in physical.initial if entity not in fact.arguments), *lies)


def _in_the_air(physical: PhysicalTask, entity: str) -> bool:
    """Tell whether a held object is known not to stand on or in something, and to stand on or in nothing."""
    known = [fact for fact in physical.initial if fact.predicate.supports and fact.arguments[0] == entity]
    return bool(known) and not any(fact.value for fact in known)


def _bring(search: Search, snapshot: Snapshot, physical: PhysicalTask) -> Snapshot:
    """Bring the arm that acts to where the facts of the first state have it.

    Raises:
        Failure: it does not get there.
    """
    arm, own = snapshot.arm, of_robot(physical.initial, snapshot.acting)
    held, over = physical.held.get(snapshot.acting), _place(own, Gripper.OVER)
    place = held or _place(own, Gripper.AT)
    if place is not None:
        snapshot = take_place(search, snapshot, place, closed=held is not None)
        lifted = held is not None and (search.scene.shared or _in_the_air(physical, held))
        return raise_arm(search, snapshot, []) if lifted else snapshot
    if over is not None:
        snapshot = move_over(search, snapshot, over, 0, [])
    else:
        hit = collide(search, arm.joints, Configuration(snapshot.situation, arm.width, None))
        if hit is not None:
            raise Failure(ARM_COLLIDES, hit.other)
    if any(fact.predicate.gripper is Gripper.OPEN and not fact.value for fact in own):
        return snapshot.with_arm(replace(snapshot.arm, width=0.0), snapshot.above)
    return snapshot


def fixed_poses(search: Search, physical: PhysicalTask) -> Mapping[str, Pose]:
    """Return the poses of the objects of a task that never move."""
    return {entity: fixed_pose(search.scene, entity) for entity in search.scene.fixed if entity in physical.objects}


def _arranged(search: Search, physical: PhysicalTask, still: Situation) -> Situation:
    """Return a situation with all objects at places that the facts allow, one after the other.

    Where there is no place for one, an earlier one that it is in a relation to is drawn again, and all after that:
    the nearest first, at the next time the one before it.

    Raises:
        Failure: there is no such object, or this has been tried `BACKTRACKS` times.
    """
    order = [entity for entity in order_of(physical, search.scene) if entity not in still.poses]
    partners = _partners(physical.initial)
    situations, failures = [still], Counter[str]()
    while len(situations) <= len(order):
        entity, situation = order[len(situations) - 1], situations[-1]
        try:
            about = _about(physical, entity, situation)
            support = known_support(situation, entity, about)
            if support is None:
                support = any_support(search, situation, entity, about)
            pose = draw_pose(search, situation, entity, support, about, 0)
        except Failure:
            earlier = [i for i, other in enumerate(order[: len(situations) - 1]) if other in partners.get(entity, ())]
            if not earlier or failures.total() >= BACKTRACKS:
                raise
            failures[entity] += 1
            del situations[earlier[-failures[entity] % len(earlier)] + 1 :]
        else:
            situations.append(situation.with_pose(entity, pose))
    return situations[-1]


def _partners(facts: Iterable[Fact]) -> Mapping[str, set[str]]:
    """Return for each object those that it is known to be in a relation to."""
    partners: dict[str, set[str]] = {}
    for fact in facts:
        if fact.value:
            for entity in fact.arguments:
                partners.setdefault(entity, set()).update(fact.arguments)
    return partners


def order_of(physical: PhysicalTask, scene: Scene) -> list[str]:
    """Return the objects in the order in which they are put down, large ones before small ones.

    Supports come before what stands on them and, as far as there is no circle, what a relation refers to before its
    subject, so that its volume is known; where the two can be swapped it does not matter.
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
    """Return what the gripper is known to be at or over."""
    return next((fact.arguments[1] for fact in facts if fact.value and fact.predicate.gripper is does), None)
