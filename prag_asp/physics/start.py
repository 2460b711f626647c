"""Draw the first state of a task: each object gets a pose that the facts allow; the unknown is free."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from prag_asp.domain.scene import Scene
from prag_asp.physics.actions import take_place
from prag_asp.physics.arm import Configuration, collide
from prag_asp.physics.facts import Fact, Problem
from prag_asp.physics.geometry import Pose, yaw_quaternion
from prag_asp.physics.handling import draw_openings
from prag_asp.physics.kinematics import tool_pose
from prag_asp.physics.moving import verify_objects
from prag_asp.physics.placement import any_support, draw_pose, known_support
from prag_asp.physics.search import ARM_COLLIDES, RELATION, Failure, Search, Snapshot
from prag_asp.physics.situation import Situation


def draw_start(search: Search, problem: Problem) -> Snapshot:
    """Return a snapshot that satisfies the facts of the initial state.

    Raises:
        Failure: this attempt found none.
    """
    home = search.robot.home
    situation = Situation(search.scene, fixed_poses(search, problem), tool_pose(home), search.robot.opening)
    for furniture, opening in draw_openings(search, situation, problem.initial).items():
        situation = situation.with_opening(furniture, opening)
    for entity in _order(problem, search.scene):
        if entity not in situation.poses:
            support = known_support(situation, entity, problem.initial)
            if support is None:
                support = any_support(search, situation, entity, problem.initial)
            situation = situation.with_pose(entity, draw_pose(search, situation, entity, support, problem.initial, 0))
    verify_objects(search, situation, problem.objects, None)
    snapshot = Snapshot(situation, home)
    place = problem.held or _visited(problem.initial)
    if place is not None:
        snapshot = take_place(search, snapshot, place, closed=problem.held is not None)
    elif collide(search, home, Configuration(situation, situation.width, None)) is not None:
        raise Failure(ARM_COLLIDES)
    elif any(fact.predicate.name == "gripper_open" and not fact.value for fact in problem.initial):
        snapshot = replace(snapshot, situation=situation.with_tool(situation.tool, 0.0))
    if not all(fact.satisfied(snapshot.situation) for fact in problem.initial):
        raise Failure(RELATION)
    return snapshot


def fixed_poses(search: Search, problem: Problem) -> Mapping[str, Pose]:
    """Return the poses of the objects of a task that never move."""
    return {
        entity: Pose((x, y, search.scene.shapes[entity].half[2]), yaw_quaternion(yaw))
        for entity, (x, y, yaw) in search.scene.fixed.items()
        if entity in problem.objects
    }


def _order(problem: Problem, scene: Scene) -> list[str]:
    """Return the objects so that supports come before what stands on them, large ones before small ones."""
    below: dict[str, set[str]] = {entity: set() for entity in problem.objects}
    for fact in problem.initial:
        if fact.value and fact.predicate.name in ("on_top", "inside", "located") and fact.arguments[0] in below:
            below[fact.arguments[0]] |= {fact.arguments[1]} & below.keys()
    ordered: list[str] = []
    shapes = scene.shapes
    waiting = sorted(problem.objects, key=lambda entity: -shapes[entity].size[0] * shapes[entity].size[1])
    while waiting:
        ready = [entity for entity in waiting if below[entity] <= set(ordered)] or waiting
        ordered.append(ready[0])
        waiting.remove(ready[0])
    return ordered


def _visited(facts: tuple[Fact, ...]) -> str | None:
    """Return the object that the gripper is known to be at."""
    return next((fact.arguments[1] for fact in facts if fact.value and fact.predicate.name == "at"), None)
