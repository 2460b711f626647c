"""Choose the view of a task that best shows the acting hands and the objects that its actions involve."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from itertools import product

from prag_asp.physics.filming.studio import Studio
from prag_asp.physics.robot.kinematics import tool_pose
from prag_asp.physics.symbolic_facts import facts
from prag_asp.physics.witness import Moment
from prag_asp.scene.boxes import Vector
from prag_asp.scene.cameras import FIELD_OF_VIEW, TOWARDS_EYE, Camera, fitted
from prag_asp.scene.robots import robot_of
from prag_asp.scene.scene import Scene
from prag_asp.task import Task

AZIMUTHS, HEIGHTS = (-22.7, 50.0, -50.0, 75.0, -75.0), (0.6, 1.1)
"""Directions to the camera: angles in degrees from the axis that points away from the robot, so that left and right are
those of a viewer who faces the robot; and heights relative to the horizontal distance."""

DIRECTIONS = (
    TOWARDS_EYE,
    *((math.cos(math.radians(a)), math.sin(math.radians(a)), height) for a, height in product(AZIMUTHS, HEIGHTS)),
)
"""The directions to the camera to try, the default one first."""

FAVOUR = 1.1
"""The factor by which another view's score must exceed that of the default view."""

MOST = 6
"""The number of states that suffices for choosing a view."""

SMALL, FAR = 96, 10.0
"""The longer side in pixels of the images with which views are compared, and the distance of their far plane in metres.
"""

SHOULDER, WRIST, HAND = 0.40, 0.22, 0.2
"""The heights of a shoulder above the table and of a wrist above the fingertips, and the width of a hand, in metres."""

View = tuple[Vector, Vector]
"""The position of the camera, and the point at which it looks, in metres."""


def best_view(
    task: Task,
    moments: Sequence[Moment],
    scene: Scene,
    studio: Studio,
    size: tuple[int, int],
    states: Sequence[int] | None = None,
) -> View:
    """Return the view that shows the actions of a task best; `size` is the size of a picture in pixels.

    For each state, the acting hand and the entities of the action and the subgoal are rated by the ratio of the number
    of their visible pixels to its maximum over all views. The score of a view combines the mean and the minimum of
    these ratios. `moments` are the moments of all states, with the objects of the studio; `states` are the states to
    draw, by default all, of which at most `MOST` are rated.
    """
    aspect = size[0] / size[1]
    states = range(len(moments)) if states is None else states
    points = tuple(dict.fromkeys(points_of_interest(task, (moments[k] for k in states), scene)))
    views = [view_from(scene, points, aspect, towards) for towards in DIRECTIONS]
    shown = [(k, acting(task, scene, k)) for k in states]
    shown = [(k, things) for k, things in shown if things]
    shown = shown[:: math.ceil(len(shown) / MOST) or 1]
    if not shown:
        return views[0]
    cameras = [counting_camera(view, size) for view in views]
    scores = [0.0] * len(views)
    for k, things in shown:
        studio.show(moments[k])
        seen = [studio.counts(camera) for camera in cameras]
        most = {thing: max(counts[thing] for counts in seen) or 1 for thing in things}
        for i, counts in enumerate(seen):
            shares = [counts[thing] / most[thing] for thing in sorted(things)]
            scores[i] += sum(shares) / len(shares) + min(shares)
    scores[0] *= FAVOUR
    return views[scores.index(max(scores))]


def counting_camera(view: View, size: tuple[int, int]) -> Camera:
    """Return the camera for counting pixels, in a smaller image than a picture of this size."""
    scale = SMALL / max(size)
    small = (max(16, round(size[0] * scale)), max(16, round(size[1] * scale)))
    return Camera(*view, FIELD_OF_VIEW, size=small, near=0.1, far=FAR)


def acting(task: Task, scene: Scene, state: int) -> set[str]:
    """Return the entities in a state's subgoal and in the action that leads to it; none for the initial state."""
    if state == 0:
        return set()
    action, subgoal = task.actions[state - 1], task.subgoals[state - 1]
    named = {
        *action.arguments,
        *(argument for fact in facts(scene, subgoal) if fact.value for argument in fact.arguments),
    }
    things = {name for name in named if name in scene.shapes and scene.shapes[name].traits.body}
    hands = named & scene.robots.keys() or ({next(iter(scene.robots))} if len(scene.robots) == 1 else set())
    return things | hands


def view_from(scene: Scene, points: Sequence[Vector], aspect: float, towards: Vector = TOWARDS_EYE) -> View:
    """Return the closest view from a direction that shows the given points and the lower parts of the robots.

    `aspect` is the ratio of the picture's width to its height.
    """
    robots = [(mount.x, mount.y, z) for mount in scene.robots.values() for z in (0.0, SHOULDER)]
    return fitted((*points, *robots), aspect, towards)


def points_of_interest(task: Task, moments: Iterable[Moment], scene: Scene) -> list[Vector]:
    """Return points, in metres, around the hands, the movable objects, and the fixed objects that the task names."""
    named = {argument for action in task.actions for argument in action.arguments}
    points = []
    for moment in moments:
        for entity, pose in moment.poses.items():
            if entity in named or entity not in scene.fixed:
                x, y, z = pose.position
                wide, high = math.hypot(*scene.shapes[entity].size[:2]) / 2, scene.shapes[entity].half[2]
                points += [(x + a * wide, y + b * wide, z + c * high) for a, b, c in product((-1, 1), repeat=3)]
        for name, arm in moment.arms.items():
            x, y, z = tool_pose(robot_of(scene, name), arm.joints).position
            points += [(x, y + side, z + WRIST) for side in (-HAND / 2, HAND / 2)]
    return points
