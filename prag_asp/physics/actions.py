"""Carry out the effect of one action on a snapshot: what it does is read off the facts, not off its name."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import replace

from prag_asp.physics.arm import LIFT, Configuration, collide, configure, descend, grasps
from prag_asp.physics.collisions import colliding
from prag_asp.physics.facts import Effect, Fact
from prag_asp.physics.geometry import Pose, cavity, compose, invert, multiply, raised, yaw_of, yaw_quaternion
from prag_asp.physics.kinematics import tool_pose
from prag_asp.physics.placement import any_support, draw_pose, known_support, yaw_range
from prag_asp.physics.predicates import PREDICATES
from prag_asp.physics.predicates.gripper import grip_width
from prag_asp.physics.robot import Joints
from prag_asp.physics.search import (
    ARM_COLLIDES,
    OBJECTS_COLLIDE,
    RELATION,
    UNSUPPORTED,
    Exhausted,
    Failure,
    Search,
    Snapshot,
)
from prag_asp.physics.situation import Situation
from prag_asp.physics.support import TABLE, resting_height, riders, unsupported
from prag_asp.physics.verdict import Waypoint

OVER_RIM = 0.03
Outcome = tuple[Snapshot, tuple[Waypoint, ...]]


def advance(search: Search, snapshot: Snapshot, effect: Effect, attempt: int) -> Outcome:
    """Return a snapshot after an action, and the waypoints of the arm on the way; `attempt` counts from 0.

    Raises:
        Failure: this attempt found none.
        Exhausted: earlier attempts were all that there are.
    """
    if attempt > 0 and not effect.moved and effect.grasps is None and effect.visits is None:
        raise Exhausted
    start = snapshot
    for entity in effect.moved:
        if entity not in (effect.holds, effect.grasps, effect.releases):
            snapshot = _relocate(search, snapshot, effect, entity)
    waypoints: list[Waypoint] = []
    if snapshot.above is not None and not _stays_down(snapshot, effect):
        snapshot = _raise(search, snapshot, waypoints)
    if effect.grasps is not None:
        snapshot = _grasp(search, snapshot, effect, attempt, waypoints)
    elif effect.releases is not None:
        snapshot = _release(search, snapshot, effect, waypoints)
    elif effect.holds is not None and effect.holds in effect.moved:
        snapshot = _carry(search, snapshot, effect.holds, effect, waypoints)
    elif effect.visits is not None and snapshot.held is None:
        snapshot = _visit(search, snapshot, effect.visits, attempt, waypoints)
    elif effect.closes and snapshot.held is None:
        snapshot = replace(snapshot, situation=snapshot.situation.with_tool(snapshot.situation.tool, 0.0))
    if not waypoints:
        waypoints.append(_waypoint("stay", snapshot))
    _verify(search, start, snapshot, effect.fresh, effect.after)
    return snapshot, tuple(waypoints)


def take_place(search: Search, snapshot: Snapshot, entity: str, closed: bool) -> Snapshot:
    """Return a snapshot of a first state in which the gripper is already at an object, or holds it.

    Raises:
        Failure: the gripper does not get there.
    """
    options = grasps(search, snapshot.situation, entity)
    choice = 0 if search.rng.random() < 0.5 else int(search.rng.integers(len(options)))
    down = _visit(search, snapshot, entity, choice, [])
    return _close(search, down, entity) if closed else down


def verify_objects(search: Search, situation: Situation, moved: Iterable[str], held: str | None) -> None:
    """Check that moved objects collide with nothing and that every object stays where it is.

    Raises:
        Failure: they collide, or one would fall.
    """
    if colliding(search.simulator, situation, moved, search.objects) is not None:
        raise Failure(OBJECTS_COLLIDE)
    if unsupported(situation, search.objects, held) is not None:
        raise Failure(UNSUPPORTED)


def _verify(search: Search, before: Snapshot, after: Snapshot, fresh: Iterable[Fact], facts: Iterable[Fact]) -> None:
    """Check the facts that an action can have changed or that the state newly knows."""
    known_again = set(fresh)
    changed = {
        entity
        for entity, pose in after.situation.poses.items()
        if before.situation.poses[entity] is not pose and before.situation.poses[entity] != pose
    }
    for fact in facts:
        concerned = fact.predicate.of_gripper or not changed.isdisjoint(fact.arguments)
        if (concerned or fact in known_again) and not fact.satisfied(after.situation):
            raise Failure(RELATION)


def _stays_down(snapshot: Snapshot, effect: Effect) -> bool:
    """Tell whether a lowered gripper begins an action where it is: it grasps, lets go or waits there."""
    if effect.releases is not None:
        return effect.releases not in effect.moved
    target = effect.grasps or effect.visits
    if target is not None:
        return PREDICATES["at"].holds(snapshot.situation, ("", target))
    return not effect.leaves and not (effect.holds is not None and effect.holds in effect.moved)


def _raise(search: Search, snapshot: Snapshot, waypoints: list[Waypoint]) -> Snapshot:
    """Move a lowered gripper straight up, with what it holds."""
    assert snapshot.above is not None
    poses = snapshot.situation.poses
    if snapshot.held is not None:
        lifted = raised(poses[snapshot.held], LIFT)
        poses = _with_riders(snapshot.situation, snapshot.held, lifted, search.objects)
    after = _moved_arm(snapshot, snapshot.above, poses, None)
    if snapshot.held is not None:
        verify_objects(search, after.situation, _changed(snapshot, poses), snapshot.held)
    _require_free(search, after)
    waypoints.append(_waypoint("lift" if snapshot.held else "retreat", after))
    return after


def _visit(search: Search, snapshot: Snapshot, entity: str, attempt: int, waypoints: list[Waypoint]) -> Snapshot:
    """Lower the open gripper to an object."""
    options = grasps(search, snapshot.situation, entity)
    if attempt >= len(options):
        raise Exhausted
    tool, _ = options[attempt]
    opening = search.robot.opening
    wanted = Configuration(snapshot.situation, opening, entity)
    at, above = descend(search, tool, wanted, wanted)
    waypoints += [Waypoint("approach", above, opening), Waypoint("at", at, opening)]
    situation = snapshot.situation.with_tool(tool_pose(at), opening)
    return Snapshot(situation, at, above=above)


def _close(search: Search, snapshot: Snapshot, entity: str) -> Snapshot:
    """Close the gripper on the object that it is at."""
    situation = snapshot.situation
    width = grip_width(situation, entity)
    grasp = compose(invert(situation.tool), situation.poses[entity])
    closed = replace(snapshot, situation=situation.with_tool(situation.tool, width), held=entity, grasp=grasp)
    _require_free(search, closed)
    return closed


def _grasp(search: Search, snapshot: Snapshot, effect: Effect, attempt: int, waypoints: list[Waypoint]) -> Snapshot:
    """Take hold of an object, and lift it where it leaves what it stands on."""
    entity = effect.grasps
    assert entity is not None
    if snapshot.above is None:
        snapshot = _visit(search, snapshot, entity, attempt, waypoints)
    snapshot = _close(search, snapshot, entity)
    waypoints.append(_waypoint("at", snapshot))
    if effect.lifts:
        return _raise(search, snapshot, waypoints)
    if entity in effect.moved:
        return _carry(search, _raise(search, snapshot, waypoints), entity, effect, waypoints)
    return snapshot


def _release(search: Search, snapshot: Snapshot, effect: Effect, waypoints: list[Waypoint]) -> Snapshot:
    """Put the held object where the facts want it, or straight down, and open the gripper."""
    entity, situation = effect.releases, snapshot.situation
    assert entity is not None
    opening = search.robot.opening
    if entity not in effect.moved and snapshot.above is not None:
        at, above, poses = snapshot.joints, snapshot.above, situation.poses
    else:
        rest = _rest_pose(search, snapshot, entity, effect)
        poses = _with_riders(situation, entity, rest, search.objects)
        placed = situation.with_poses(poses)
        verify_objects(search, placed, _changed(snapshot, poses), None)
        at, above = _lower(search, snapshot, entity, poses)
        waypoints += [
            Waypoint("approach", above, situation.width, entity),
            Waypoint("at", at, situation.width, entity),
        ]
    opened = situation.with_poses(poses).with_tool(tool_pose(at), opening)
    after = Snapshot(opened, at, above=above)
    _require_free(search, after, entity)
    waypoints.append(_waypoint("at", after))
    if not effect.stays:
        after = _raise(search, after, waypoints)
    return after


def _rest_pose(search: Search, snapshot: Snapshot, entity: str, effect: Effect) -> Pose:
    """Return where a released object comes to rest."""
    situation = snapshot.situation
    others = {other: pose for other, pose in situation.poses.items() if other != entity}
    if entity in effect.moved:
        around = situation.with_poses(others)
        support = known_support(around, entity, effect.after)
        if support is None:
            support = any_support(search, around, entity, effect.after)
        return draw_pose(search, around, entity, support, effect.after, effect.number)
    height = resting_height(situation, entity, others)
    return raised(situation.poses[entity], height - situation.bottom(entity))


def _lower(search: Search, snapshot: Snapshot, entity: str, poses: Mapping[str, Pose]) -> tuple[Joints, Joints]:
    """Return the configurations at and above where the held object is put down."""
    assert snapshot.grasp is not None
    situation = snapshot.situation
    tool = compose(poses[entity], invert(snapshot.grasp))
    high = situation.with_poses(_with_riders(situation, entity, raised(poses[entity], LIFT), search.objects))
    at = Configuration(situation.with_poses(poses), situation.width, entity)
    above = Configuration(high, situation.width, entity)
    joints = descend(search, tool, at, above)
    if colliding(search.simulator, high, [entity], search.objects) is not None:
        raise Failure(OBJECTS_COLLIDE)
    return joints


def _carry(search: Search, snapshot: Snapshot, entity: str, effect: Effect, waypoints: list[Waypoint]) -> Snapshot:
    """Move the held object where the facts want it, clear of what is below."""
    assert snapshot.grasp is not None
    situation = snapshot.situation
    others = {other: pose for other, pose in situation.poses.items() if other != entity}
    around = situation.with_poses(others)
    moves = {fact.predicate.name for fact in effect.fresh if fact.value and fact.arguments[0] == entity}
    if moves and moves <= {"rotated"}:
        pose = _turned(search, situation, entity, effect)
    else:
        support = known_support(around, entity, effect.after) or TABLE
        depth = cavity(situation.shape(support))[2] if support != TABLE else 0.0
        height = max(LIFT, depth + OVER_RIM)
        pose = draw_pose(search, around, entity, support, effect.after, effect.number, height=height)
    poses = _with_riders(situation, entity, pose, search.objects)
    after = situation.with_poses(poses)
    verify_objects(search, after, _changed(snapshot, poses), entity)
    wanted = Configuration(after, situation.width, entity)
    joints = configure(search, compose(pose, invert(snapshot.grasp)), wanted)
    carried = _moved_arm(snapshot, joints, poses, None)
    waypoints.append(_waypoint("carry", carried))
    return carried


def _turned(search: Search, situation: Situation, entity: str, effect: Effect) -> Pose:
    """Return the pose of the held object turned on the spot."""
    pose = situation.poses[entity]
    yaw = yaw_of(pose.quaternion)
    wanted = yaw_range(situation, entity, effect.after)
    if wanted is not None:
        yaw = wanted[0] + search.uniform(-wanted[1], wanted[1])
    turn = yaw_quaternion(yaw - yaw_of(pose.quaternion))
    return Pose(pose.position, multiply(turn, pose.quaternion))


def _relocate(search: Search, snapshot: Snapshot, effect: Effect, entity: str) -> Snapshot:
    """Move an object that the gripper does not touch, as in domains without a gripper."""
    situation = snapshot.situation
    others = {other: pose for other, pose in situation.poses.items() if other != entity}
    around = situation.with_poses(others)
    support = known_support(around, entity, effect.after)
    if support is None:
        support = any_support(search, around, entity, effect.after)
    pose = draw_pose(search, around, entity, support, effect.after, effect.number)
    poses = _with_riders(situation, entity, pose, search.objects)
    after = situation.with_poses(poses)
    verify_objects(search, after, _changed(snapshot, poses), snapshot.held)
    moved = replace(snapshot, situation=after)
    _require_free(search, moved, snapshot.held)
    return moved


def _with_riders(situation: Situation, entity: str, pose: Pose, objects: Iterable[str]) -> Mapping[str, Pose]:
    """Return all poses after an object has moved with everything that rests on it."""
    poses = {**situation.poses, entity: pose}
    delta = compose(pose, invert(situation.poses[entity]))
    for rider in riders(situation, entity, [other for other in objects if other != entity]):
        poses[rider] = compose(delta, situation.poses[rider])
    return poses


def _changed(snapshot: Snapshot, poses: Mapping[str, Pose]) -> list[str]:
    """Return the objects that have other poses than in a snapshot."""
    return [entity for entity, pose in poses.items() if snapshot.situation.poses[entity] != pose]


def _moved_arm(snapshot: Snapshot, joints: Joints, poses: Mapping[str, Pose], above: Joints | None) -> Snapshot:
    """Return a snapshot with the arm elsewhere; the held object goes along as `poses` say."""
    situation = snapshot.situation.with_poses(poses).with_tool(tool_pose(joints), snapshot.situation.width)
    return replace(snapshot, situation=situation, joints=joints, above=above)


def _require_free(search: Search, snapshot: Snapshot, touched: str | None = None) -> None:
    """Check that the arm of a snapshot is free of collisions."""
    touched = touched or snapshot.held
    wanted = Configuration(snapshot.situation, snapshot.situation.width, touched)
    if collide(search, snapshot.joints, wanted) is not None:
        raise Failure(ARM_COLLIDES)


def _waypoint(name: str, snapshot: Snapshot) -> Waypoint:
    """Return the configuration of a snapshot as a waypoint."""
    return Waypoint(name, snapshot.joints, snapshot.situation.width, snapshot.held)
