"""Warn about places that actions use but no gripper can reach."""

from __future__ import annotations

import math
from collections.abc import Iterator

from prag_asp.atom import atom_of
from prag_asp.domain.load import Domain
from prag_asp.physics.predicates import PREDICATES
from prag_asp.physics.proofs.surfaces import outline_of
from prag_asp.physics.situation import fixed_pose
from prag_asp.program.problem import Problem
from prag_asp.scene.forms import Outline, rectangle
from prag_asp.scene.furniture import cavity, cavity_pose, mechanism
from prag_asp.scene.geometry import cut, inside_by, yaw_of
from prag_asp.scene.robots import Robot, robot_of
from prag_asp.scene.scene import Scene


def out_of_reach(domain: Domain, scene: Scene) -> Iterator[Problem]:
    """Yield a warning for each fixed place in or on which actions place objects but that no gripper reaches.

    The reach is defined as in `reachable`: it is the ring around a robot's base in which its gripper reaches everything
    from above. For objects in a drawer, the drawer is assumed to be open.
    """
    facts = domain.facts
    stated = [
        of[action] for of in (facts.preconditions, facts.postconditions) for action in facts.actions if action in of
    ]
    named = {atom_of(fluent) for conditions in stated for fluent, _ in conditions}
    places = set[str]()
    for fluent in named:
        meaning = PREDICATES.get(scene.meaning(fluent) or "")
        if meaning is not None and (meaning.supports or meaning.places):
            places.add(fluent.arguments[-1])
    for place in sorted(places & scene.fixed.keys()):
        text = _beyond(scene, place)
        if text:
            line = domain.settings.line_of("scene", "fixed", place)
            yield Problem(domain.settings.path, line, f"{place} is out of reach: {text}", "out-of-reach")


def _beyond(scene: Scene, place: str) -> str:
    """Return the reason why no gripper reaches a place, and a remedy, or "" if some gripper reaches it."""
    top, height = _top(scene, place)
    if scene.shapes[place].traits.surface and not scene.shared:
        low_x, high_x, low_y, high_y = scene.workspace
        for a, b, c in ((1.0, 0.0, high_x), (-1.0, 0.0, -low_x), (0.0, 1.0, high_y), (0.0, -1.0, -low_y)):
            top = cut(top, a, b, c)
        if not top:
            return "no part of it is in the workspace, where things are put; move it, or widen scene.workspace"
    reasons = []
    for name in scene.robots:
        robot = robot_of(scene, name)
        near, far = _distances(top, robot)
        if near <= robot.reach[1] and far >= robot.reach[0] and height <= robot.reach_height:
            return ""
        if height > robot.reach_height:
            reasons.append(f"its top is {height:.3g} m high, and {name} reaches {robot.reach_height:.3g} m high")
        else:
            away = f"{near:.3g} m or more" if near > robot.reach[1] else f"{far:.3g} m or less"
            reasons.append(f"it is {away} from {name}, which reaches {robot.reach[0]:.3g} to {robot.reach[1]:.3g} m")
    return f"{'; '.join(reasons)}; move it"


def _top(scene: Scene, place: str) -> tuple[Outline, float]:
    """Return the region for the centres of objects on or in a place, seen from above, and its height in metres."""
    shape = scene.shapes[place]
    if shape.traits.surface:
        return outline_of(place, scene), 0.0
    pose = fixed_pose(scene, place)
    x, y, z = pose.position
    if not shape.traits.hollow:
        return shape.traits.form.outline(shape.half, x, y, yaw_of(pose.quaternion)), z + shape.half[2]
    half_x, half_y = (side / 2 for side in cavity(shape)[:2])
    if not shape.traits.furniture:
        return rectangle(x, y, half_x, half_y, yaw_of(pose.quaternion)), z - shape.half[2] + shape.wall
    floor = cavity_pose(shape, pose, mechanism(shape).limit)
    return rectangle(*floor.position[:2], half_x, half_y, yaw_of(floor.quaternion)), floor.position[2]


def _distances(outline: Outline, robot: Robot) -> tuple[float, float]:
    """Return the smallest and the largest distance of a convex outline from a robot's base, in metres."""
    x, y, _ = robot.base.position
    near, far = math.inf, max(math.dist((x, y), corner) for corner in outline)
    if inside_by(outline, (x, y)) >= 0.0:
        return 0.0, far
    for (ax, ay), (bx, by) in zip(outline, outline[1:] + outline[:1], strict=True):
        dx, dy = bx - ax, by - ay
        length = dx * dx + dy * dy
        share = 0.0 if length == 0.0 else ((x - ax) * dx + (y - ay) * dy) / length
        share = min(1.0, max(0.0, share))
        near = min(near, math.dist((x, y), (ax + share * dx, ay + share * dy)))
    return near, far
