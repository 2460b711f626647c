"""Check how a witness moves furniture between its states: by the handle, without jumps."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence

from prag_asp.physics.situation import Situation
from prag_asp.physics.symbolic_facts import PhysicalTask
from prag_asp.physics.witness import Moment, Waypoint
from prag_asp.physics.world.support import riders
from prag_asp.scene.furniture import POST, mechanism, part_pose
from prag_asp.scene.geometry import Pose, compose, invert, turn_between
from prag_asp.scene.scene import Scene

HANDLE_TOLERANCE, TURN_TOLERANCE, OPENING_TOLERANCE = 1e-3, 1e-3, 1e-9
LONGEST_STRIDE = 0.201
"""The largest motion of furniture between two waypoints, in metres or radians."""

Openings = Mapping[str, float]


def opening_problems(moment: Moment, physical: PhysicalTask, scene: Scene) -> Iterator[str]:
    """Yield furniture whose opening is missing or out of range, and other entities that are given an opening."""
    furniture = {entity for entity in physical.objects if scene.shapes[entity].traits.furniture}
    for entity in sorted(furniture):
        opening = moment.openings.get(entity, math.nan)
        limit = mechanism(scene.shapes[entity]).limit
        if not -OPENING_TOLERANCE <= opening <= limit + OPENING_TOLERANCE:
            yield f"{entity} cannot be open by {opening:.4f}"
    yield from (f"{entity} has no part that opens" for entity in moment.openings if entity not in furniture)


def carried_along(poses: Mapping[str, Pose], before: Openings, after: Openings, scene: Scene) -> dict[str, Pose]:
    """Return all poses after drawers have moved, together with their contents."""
    all_poses = dict(poses)
    for entity, opening in after.items():
        shape = scene.shapes[entity]
        if opening != before[entity] and mechanism(shape).slides:
            situation = Situation(scene, poses, openings=before)
            start, end = (part_pose(shape, poses[entity], at) for at in (before[entity], opening))
            delta = compose(end, invert(start))
            for rider in riders(situation, entity, set(poses) - {entity}):
                all_poses[rider] = compose(delta, poses[rider])
    return all_poses


def handling_problems(
    motion: Sequence[Waypoint], tools: Sequence[Pose], before: Moment, after: Moment, scene: Scene
) -> Iterator[str]:
    """Yield waypoints where the gripper is off the handle, waypoints where furniture jumps, and wrong final openings.

    `tools` are the poses of the tool at the waypoints.
    """
    openings, grip = dict(before.openings), None
    for waypoint, tool in zip(motion, tools, strict=True):
        if waypoint.opening is None:
            grip = None
            continue
        entity = waypoint.held
        if entity is None or entity not in openings or not math.isfinite(waypoint.opening):
            yield f"{waypoint.name}: it holds no furniture, and cannot open any"
            return
        shape = scene.shapes[entity]
        here = compose(invert(part_pose(shape, before.poses[entity], waypoint.opening)), tool)
        off = math.dist(here.position, mechanism(shape).handle)
        if off > HANDLE_TOLERANCE or abs(waypoint.width - 2 * POST) > HANDLE_TOLERANCE:
            yield f"{waypoint.name}: the gripper does not hold the handle of {entity}"
        if grip is not None and turn_between(grip.quaternion, here.quaternion) > TURN_TOLERANCE:
            yield f"{waypoint.name}: the gripper turns on the handle of {entity}"
        if abs(waypoint.opening - openings[entity]) > (LONGEST_STRIDE if grip is not None else OPENING_TOLERANCE):
            yield f"{waypoint.name}: {entity} jumps"
        openings[entity], grip = waypoint.opening, here
    for entity, opening in after.openings.items():
        if abs(openings.get(entity, math.nan) - opening) > OPENING_TOLERANCE:
            yield f"{entity} ends with an opening that differs from that in the next state"
