"""Check a motion of a witness: its waypoints, and that only the bodies that its action moves have moved."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace

from prag_asp.physics.checks.approaches import End, approach_problems
from prag_asp.physics.checks.furniture_motion import carried_along, handling_problems
from prag_asp.physics.checks.numbers import broken_arm
from prag_asp.physics.checks.states import near, object_at_gripper, situation_of, tool_in
from prag_asp.physics.situation import Situation
from prag_asp.physics.symbolic_facts import ActionEffect
from prag_asp.physics.witness import TRANSIT, Arm, Moment, Waypoint
from prag_asp.physics.world.collisions import arm_collision, colliding
from prag_asp.physics.world.simulator import Simulator
from prag_asp.physics.world.support import riders
from prag_asp.scene.geometry import Pose, compose, invert


def motion_problems(motion: tuple[Waypoint, ...], start: End, end: End, simulator: Simulator) -> Iterator[str]:
    """Yield impossible waypoints, approaches that are not straight, and a wrong final configuration."""
    before, after = start.moment, end.moment
    if not motion:
        yield "it has no waypoint"
        return
    tools: list[Pose] = []
    for waypoint in motion:
        broken = list(broken_arm(waypoint.robot, waypoint.joints, waypoint.width, simulator))
        if waypoint.held is not None and waypoint.held not in before.poses:
            broken.append(f"it holds {waypoint.held}, which has no pose")
        if broken:
            yield from (f"{waypoint.name}: {text}" for text in broken)
            return
        simulator.turn_to(waypoint.robot)
        simulator.pose_arm(waypoint.joints, waypoint.width)
        tools.append(tool_in(simulator))
    wrong = list(handling_problems(motion, tools, before, after, simulator.scene))
    yield from wrong or approach_problems(motion, tools, start, end, simulator)
    arms, openings = dict(before.arms), dict(before.openings)
    for i, waypoint in enumerate(() if wrong else motion):
        grasp = arms[waypoint.robot].grasp if waypoint.held == arms[waypoint.robot].held else None
        if waypoint.held is not None and grasp is None:
            grasp = after.arms[waypoint.robot].grasp
        arms[waypoint.robot] = Arm(waypoint.joints, waypoint.width, waypoint.held, grasp)
        if waypoint.opening is not None and waypoint.held is not None:
            openings[waypoint.held] = waypoint.opening
        if i < len(motion) - 1:
            moving = waypoint.name == TRANSIT
            hit = _waypoint_collision(arms, waypoint.robot, (before, after), openings, simulator, moving)
            if hit is not None:
                yield f"{waypoint.name}: {hit}"
    for name, arm in () if wrong else after.arms.items():
        if replace(arms[name], grasp=arm.grasp) != arm:
            yield "its last waypoint differs from the arm in the next state"


def _waypoint_collision(
    arms: Mapping[str, Arm],
    robot: str,
    around: tuple[Moment, Moment],
    openings: Mapping[str, float],
    simulator: Simulator,
    moving: bool,
) -> str | None:
    """Return the bodies that collide at a waypoint, or None.

    Furniture is checked, and so is the held object if the arm is `moving`.
    """
    before, after = around
    poses = carried_along(before.poses, before.openings, openings, simulator.scene)
    situation = situation_of(simulator, poses, openings, arms)
    arm = arms[robot]
    if arm.held is not None and arm.grasp is not None:
        pose = compose(situation.tool(robot), arm.grasp)
        delta = compose(pose, invert(poses[arm.held]))
        moved = riders(Situation(simulator.scene, poses), arm.held, set(poses) - {arm.held})
        poses = {**poses, **{rider: compose(delta, poses[rider]) for rider in moved}, arm.held: pose}
    elif before.arms[robot].held is not None:
        poses = dict(after.poses)
    situation = situation.with_poses(poses)
    carried = [entity for entity in poses if poses[entity] != before.poses[entity]] if moving else []
    simulator.turn_to(robot)
    hit = arm_collision(simulator, situation, arm.joints, arm.width, arm.held or object_at_gripper(situation, robot))
    if hit is not None:
        return f"the arm collides with {hit.other}"
    pair = colliding(simulator, situation, [*openings, *carried], list(poses))
    return None if pair is None else f"{pair[0]} collides with {pair[1]}"


def stray_objects(effect: ActionEffect, before: Moment, after: Moment, simulator: Simulator) -> Iterator[str]:
    """Yield objects and furniture that have moved although the action does not move them."""
    for furniture, opening in after.openings.items():
        if opening != before.openings[furniture] and furniture not in effect.turns:
            yield f"{furniture} has been opened or closed"
    along = carried_along(before.poses, before.openings, after.openings, simulator.scene)
    held = (effect.grasps, effect.releases, effect.holds)
    may_move = {*effect.moved, *(entity for entity in held if entity is not None)}
    situation = Situation(simulator.scene, before.poses, openings=before.openings)
    for entity in [entity for entity in may_move if entity in before.poses]:
        may_move |= set(riders(situation, entity, set(before.poses) - {entity}))
    for entity, pose in along.items():
        has_moved = not near(pose, after.poses.get(entity, pose))
        if has_moved and (entity not in may_move or entity in simulator.scene.fixed):
            yield f"{entity} has moved"
