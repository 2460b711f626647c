"""Three methods to spawn random objects so that random relations hold; `spawning.py` compares them."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations

import numpy as np

from prag_asp import Task
from prag_asp.atom import Atom
from prag_asp.physics.predicates import PREDICATES, Volume
from prag_asp.physics.search.attempt import Failure, Search
from prag_asp.physics.search.initial_state import sample_initial_state
from prag_asp.physics.situation import Situation
from prag_asp.physics.symbolic_facts import Fact, PhysicalTask, physical_task
from prag_asp.physics.world.collisions import colliding
from prag_asp.scene.geometry import Pose, extents, yaw_quaternion
from prag_asp.scene.scene import Scene, Shape

DIRECTIONS = ("left_of", "right_of", "in_front_of", "behind")
SHAPES = {
    "cube": Shape("box", (0.05, 0.05, 0.05)),
    "brick": Shape("box", (0.12, 0.06, 0.04)),
    "can": Shape("cylinder", (0.066, 0.066, 0.10)),
    "ball": Shape("sphere", (0.068, 0.068, 0.068)),
}
COLORS = {
    "red_cube": "#d7263d",
    "blue_brick": "#2e86ab",
    "yellow_can": "#f2b134",
    "green_ball": "#3a9d5d",
    "purple_cube": "#8e5bb5",
    "pink_brick": "#f06fa5",
    "teal_can": "#4bb3b8",
    "brown_ball": "#8a5a3c",
}
BOX = (0.32, 0.62, -0.42, 0.42)
"""The workspace as low x, high x, low y, high y in metres; all of it is within reach."""

MOST = 8
"""The largest number of objects, and of relations."""


def random_task(scene: Scene, rng: np.random.Generator, objects: int, relations: int) -> PhysicalTask:
    """Return a task whose initial state has random relations that hold together in some arrangement."""
    names = tuple(str(name) for name in rng.permutation(list(COLORS))[:objects])
    while True:
        situation = _random_arrangement(scene, rng, names)
        pairs = [pair if rng.random() < 0.5 else pair[::-1] for pair in combinations(names, 2)]
        facts = [Atom(name, pair) for pair in pairs for name in DIRECTIONS if PREDICATES[name].holds(situation, pair)]
        if len(facts) >= relations:
            chosen = [facts[k] for k in rng.permutation(len(facts))[:relations]]
            state = {Atom("on_top", (name, "table")): True for name in names} | dict.fromkeys(chosen, True)
            entities = {name: kind_of(name) for name in names}
            return physical_task(Task("spawning", (), entities, state, (), (), {}), scene)


def kind_of(name: str) -> str:
    """Return the kind of an object, such as cube for ``red_cube``."""
    return name.partition("_")[2]


def _random_arrangement(scene: Scene, rng: np.random.Generator, names: Sequence[str]) -> Situation:
    """Return objects at random poses in the box, with disjoint bounding boxes."""
    situation = _empty(scene)
    while len(situation.poses) < len(names):
        situation = _empty(scene)
        for name in names:
            pose = _anywhere(scene, rng, name)
            trial = situation.with_pose(name, pose)
            if any(_boxes_meet(trial, name, other) for other in situation.poses):
                break
            situation = trial
    return situation


def _boxes_meet(situation: Situation, one: str, two: str) -> bool:
    """Return whether the bounding boxes of two objects on the table overlap, seen from above."""
    first, second = situation.body(one), situation.body(two)
    return all(first.low[i] < second.high[i] and second.low[i] < first.high[i] for i in (0, 1))


def _empty(scene: Scene) -> Situation:
    """Return an empty table."""
    return Situation(scene, {})


def _anywhere(scene: Scene, rng: np.random.Generator, name: str) -> Pose:
    """Return a uniformly sampled pose on the table in the box."""
    yaw = rng.uniform(-np.pi, np.pi)
    x, y = rng.uniform(BOX[0], BOX[1]), rng.uniform(BOX[2], BOX[3])
    return Pose((float(x), float(y), scene.shapes[name].half[2]), yaw_quaternion(float(yaw)))


def correct(search: Search, situation: Situation, facts: Sequence[Fact]) -> bool:
    """Return whether every relation passes its check, all objects are in the box, and nothing collides."""
    inside = all(
        BOX[0] <= pose.position[0] <= BOX[1] and BOX[2] <= pose.position[1] <= BOX[3]
        for pose in situation.poses.values()
    )
    if not inside or not all(fact.is_satisfied(situation) for fact in facts):
        return False
    return colliding(search.simulator, situation, search.objects, search.objects) is None


def uniform(search: Search, task: PhysicalTask, tries: int) -> Situation | None:
    """Sample all objects uniformly until a scene is correct."""
    for _ in range(tries):
        poses = {name: _anywhere(search.scene, search.rng, name) for name in task.objects}
        situation = _empty(search.scene).with_poses(poses)
        if correct(search, situation, task.initial):
            return situation
    return None


def by_volumes(search: Search, task: PhysicalTask, tries: int) -> Situation | None:
    """Sample object by object from the volumes of its relations to objects that are already placed."""
    for _ in range(tries):
        situation = _empty(search.scene)
        for name in task.objects:
            quaternion = yaw_quaternion(search.uniform(-np.pi, np.pi))
            height = extents(search.scene.shapes[name], quaternion)[2]
            volume = Volume((BOX[0], BOX[2], height), (BOX[1], BOX[3], height))
            for fact in task.initial:
                if fact.arguments[0] == name and fact.arguments[1] in situation.poses:
                    volume = volume.meet(fact.predicate.volume(situation, fact.arguments, quaternion))
            floor = volume.floor()
            position = None if floor is None else volume.sample(floor, search.uniform)
            if position is None:
                break
            situation = situation.with_pose(name, Pose(position, quaternion))
        if len(situation.poses) == len(task.objects) and correct(search, situation, task.initial):
            return situation
    return None


def by_placement(search: Search, task: PhysicalTask, tries: int) -> Situation | None:
    """Sample the scene as validation samples the initial state of a task."""
    for _ in range(tries):
        try:
            return sample_initial_state(search, task).situation
        except Failure:
            continue
    return None
