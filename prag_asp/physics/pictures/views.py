"""Choose the view of a task that best shows the acting hands and the objects of its actions."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from itertools import product

from prag_asp.physics.filming.studio import open_studio
from prag_asp.physics.symbolic_facts import facts
from prag_asp.physics.witness import Moment
from prag_asp.scene.boxes import Vector
from prag_asp.scene.cameras import FIELD_OF_VIEW, TOWARDS_EYE, Camera, fitted
from prag_asp.scene.scene import Scene
from prag_asp.task import Task

AZIMUTHS, HEIGHTS = (-22.7, 50.0, -50.0, 75.0, -75.0), (0.6, 1.1)
"""Directions to the camera: degrees from the axis that points away from the robot, so that left and right remain those
of a viewer who faces the robot; and heights relative to the horizontal distance."""

DIRECTIONS = (
    TOWARDS_EYE,
    *((math.cos(math.radians(a)), math.sin(math.radians(a)), height) for a, height in product(AZIMUTHS, HEIGHTS)),
)
"""The directions to the camera to try, the default one first."""

FAVOUR = 1.1
"""The factor by which another view has to score higher than the default one."""

SMALL, FAR = 96, 10.0
"""The longer side in pixels of the images by which views are compared, and their far plane in metres."""

ABOVE_TABLE, ABOVE_BASE, BEHIND_BASE = 0.06, 0.78, 0.12
"""The height of objects above the table, and the position of a robot's elbow above and behind its base, in metres."""

View = tuple[Vector, Vector]
"""The position of the camera, and the point that it looks at, in metres."""


def best_view(
    task: Task, moments: Sequence[Moment], scene: Scene, size: tuple[int, int], states: Iterable[int] | None = None
) -> View:
    """Return the view that shows the actions of a task best; `size` is the size of a picture in pixels.

    For each state, the acting hand and the entities of the action and the subgoal are rated by the ratio of their
    visible pixels to their maximum over all views. The score of a view combines the mean and the minimum of these
    ratios. `moments` are the moments of all states; `states` are the states to draw, by default all.
    """
    aspect = size[0] / size[1]
    views = [view_from(scene, aspect, towards) for towards in DIRECTIONS]
    shown = [(k, acting(task, scene, k)) for k in (range(len(moments)) if states is None else states)]
    shown = [(k, things) for k, things in shown if things]
    if not shown:
        return views[0]
    scale = SMALL / max(size)
    small = (max(16, round(size[0] * scale)), max(16, round(size[1] * scale)))
    cameras = [Camera(*view, FIELD_OF_VIEW, size=small, near=0.1, far=FAR) for view in views]
    scores = [0.0] * len(views)
    with open_studio(scene, tuple(moments[0].poses)) as studio:
        for k, things in shown:
            studio.show(moments[k])
            seen = [studio.counts(camera) for camera in cameras]
            most = {thing: max(counts[thing] for counts in seen) or 1 for thing in things}
            for i, counts in enumerate(seen):
                shares = [counts[thing] / most[thing] for thing in sorted(things)]
                scores[i] += sum(shares) / len(shares) + min(shares)
    scores[0] *= FAVOUR
    return views[scores.index(max(scores))]


def acting(task: Task, scene: Scene, state: int) -> set[str]:
    """Return the entities in the action that leads to a state and in its subgoal; none for the initial state."""
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


def view_from(scene: Scene, aspect: float, towards: Vector = TOWARDS_EYE) -> View:
    """Return the closest view in a direction that shows the workspace, the robots and the fixed objects.

    `aspect` is the ratio of the picture's width to its height.
    """
    low_x, high_x, low_y, high_y = scene.workspace
    corners = [(x, y, z) for x in (low_x, high_x) for y in (low_y, high_y) for z in (0.0, ABOVE_TABLE)]
    bases = [(mount.x, mount.y) for mount in scene.robots.values()]
    robots = [(x, y, z) for x, y in bases for z in (0.0, ABOVE_BASE)]
    robots += [(x - BEHIND_BASE, y, ABOVE_BASE) for x, y in bases]
    if len(bases) > 1:  # the elbows of several arms swing out to the sides
        robots += [(x, y + side, ABOVE_BASE / 2) for x, y in bases for side in (-ABOVE_BASE / 2, ABOVE_BASE / 2)]
    return fitted((*corners, *robots, *scene.fixed_corners()), aspect, towards)
