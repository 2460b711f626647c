"""Apply the effect of one action to a snapshot; the effect is determined by facts, not by the action's name."""

from __future__ import annotations

from dataclasses import replace

from prag_asp.physics.predicates import PREDICATES
from prag_asp.physics.predicates.grip_geometry import grip_width
from prag_asp.physics.search.attempt import NO_GRASP, RELATION, Exhausted, Failure, Search, Snapshot
from prag_asp.physics.search.carrying import carry, release, relocate
from prag_asp.physics.search.furniture_handling import turn
from prag_asp.physics.search.grasping import CollisionQuery, descend, grasps
from prag_asp.physics.search.meeting import move_over, take_over
from prag_asp.physics.search.moving import raise_arm, require_free, turn_to
from prag_asp.physics.symbolic_facts import ActionEffect
from prag_asp.physics.witness import Arm, Waypoint
from prag_asp.scene.geometry import compose, invert
from prag_asp.scene.solids import weight


def advance(
    search: Search, snapshot: Snapshot, effect: ActionEffect, attempt: int
) -> tuple[Snapshot, tuple[Waypoint, ...]]:
    """Return a snapshot after an action, and the waypoints of the arm; `attempt` counts from 0.

    Raises:
        Failure: the action cannot be performed from this snapshot in this attempt.
        Exhausted: there are no further attempts.
    """
    if attempt > 0 and not (effect.moved or effect.turns or effect.grasps or effect.visits or effect.over):
        raise Exhausted
    snapshot = turn_to(search, replace(snapshot, waypoints=()), effect.robot)
    before = snapshot.situation
    for entity in effect.moved:
        if entity not in (effect.holds, effect.grasps, effect.releases):
            snapshot = relocate(search, snapshot, effect, entity)
    if snapshot.above is not None and not _stays_down(snapshot, effect):
        snapshot = raise_arm(search, snapshot)
    snapshot = _act(search, snapshot, effect, attempt)
    if not snapshot.waypoints:
        snapshot = snapshot.with_waypoint("stay")
    after, fresh = snapshot.situation, set(effect.fresh)
    changed = {entity for entity, pose in after.poses.items() if before.poses[entity] != pose}
    changed |= {entity for entity, opening in after.openings.items() if before.openings[entity] != opening}
    for fact in effect.after:
        predicate = fact.predicate
        concerned = predicate.of_gripper or predicate.looks_around or not changed.isdisjoint(fact.arguments)
        if (concerned or fact in fresh) and not fact.is_satisfied(after):
            raise Failure(RELATION, fact=fact, missed=fact.distance(after))
    return snapshot, snapshot.waypoints


def _act(search: Search, snapshot: Snapshot, effect: ActionEffect, attempt: int) -> Snapshot:
    """Return a snapshot after the gripper has performed its part of an action.

    Raises:
        Failure: the gripper cannot perform its part in this attempt.
    """
    for furniture in effect.turns:
        snapshot = turn(search, snapshot, furniture, effect.after, attempt)
    if effect.grasps is not None:
        snapshot = _grasp(search, snapshot, effect, effect.grasps, attempt)
        if effect.giver is not None:
            snapshot = take_over(search, snapshot, effect.giver)
    elif effect.releases is not None:
        snapshot = release(search, snapshot, effect)
    elif effect.holds is not None and effect.holds in effect.moved:
        snapshot = carry(search, snapshot, effect.holds, effect)
    elif effect.over is not None:
        snapshot = move_over(search, snapshot, effect.over, attempt)
    elif effect.visits is not None and snapshot.arm.held is None:
        snapshot = _visit(search, snapshot, effect.visits, attempt)
    elif effect.closes and snapshot.arm.held is None:
        snapshot = snapshot.with_arm(replace(snapshot.arm, width=0.0), snapshot.above)
    return snapshot


def take_place(search: Search, snapshot: Snapshot, entity: str, closed: bool) -> Snapshot:
    """Return a snapshot of an initial state in which the gripper is at an object, or holds it.

    Raises:
        Failure: the gripper cannot reach the object.
    """
    options = grasps(search, snapshot.situation, entity)
    choice = 0 if search.rng.random() < 0.5 else int(search.rng.integers(len(options)))
    down = _visit(search, snapshot, entity, choice)
    return _close(search, down, entity) if closed else down


def _stays_down(snapshot: Snapshot, effect: ActionEffect) -> bool:
    """Return whether a lowered gripper begins an action where it is, in order to grasp, release or wait."""
    if effect.releases is not None or effect.turns:
        return effect.releases not in effect.moved and not effect.turns
    target = effect.grasps or effect.visits
    if target is not None:
        return PREDICATES["at"].holds(snapshot.situation, (snapshot.acting, target))
    return not effect.leaves and effect.over is None and not (effect.holds is not None and effect.holds in effect.moved)


def _visit(search: Search, snapshot: Snapshot, entity: str, attempt: int) -> Snapshot:
    """Lower the open gripper to an object."""
    options = grasps(search, snapshot.situation, entity)
    if attempt >= len(options):
        raise Exhausted
    tool, opening = options[attempt]
    query = CollisionQuery(snapshot.situation, opening, entity)
    at, above = descend(search, tool, query, query, back=True)
    approach = snapshot.with_arm(Arm(above, opening)).with_waypoint("approach")
    return approach.with_arm(Arm(at, opening), above).with_waypoint("at")


def _close(search: Search, snapshot: Snapshot, entity: str) -> Snapshot:
    """Close the gripper on the object at which it is."""
    situation = snapshot.situation
    if weight(situation.scene, entity) > search.robot.payload:
        raise Failure(NO_GRASP, entity)
    width = grip_width(situation, entity, snapshot.acting)
    grasp = compose(invert(snapshot.tool), situation.poses[entity])
    closed = snapshot.with_arm(Arm(snapshot.arm.joints, width, entity, grasp), snapshot.above)
    require_free(search, closed)
    return closed


def _grasp(search: Search, snapshot: Snapshot, effect: ActionEffect, entity: str, attempt: int) -> Snapshot:
    """Grasp an object, and lift it if the object leaves its support."""
    if snapshot.arm.held not in (None, entity):
        raise Failure(NO_GRASP, entity)
    if snapshot.above is None:
        snapshot = _visit(search, snapshot, entity, attempt)
    snapshot = _close(search, snapshot, entity).with_waypoint("at")
    if effect.lifts or entity in effect.moved:
        snapshot = raise_arm(search, snapshot)
    return snapshot if effect.lifts or entity not in effect.moved else carry(search, snapshot, entity, effect)
