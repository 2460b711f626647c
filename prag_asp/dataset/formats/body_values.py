"""The values in ``observation.environment_state``: the poses of a scene's objects and the openings of furniture."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from prag_asp.physics.situation import Situation
from prag_asp.scene.scene import Scene

POSE = ("x", "y", "z", "qx", "qy", "qz", "qw")


def objects_in(scene: Scene) -> list[str]:
    """Return all objects of a scene; a task may have only some of them."""
    return [entity for entity, shape in scene.shapes.items() if shape.traits.body]


def furniture_in(scene: Scene) -> list[str]:
    """Return the objects of a scene that have a jointed part."""
    return [entity for entity in objects_in(scene) if scene.shapes[entity].traits.furniture]


def body_names(scene: Scene) -> list[str]:
    """Return the names of the values that `body_values` returns."""
    poses = [f"{entity}/{number}" for entity in objects_in(scene) for number in ("there", *POSE)]
    return [*poses, *(f"{entity}/opening" for entity in furniture_in(scene))]


def body_values(situation: Situation) -> NDArray[np.float32]:
    """Return the values at a moment, shape (values,): 1 and the pose for each object, or zeros if it is absent.

    The openings of furniture follow, in metres or radians.
    """
    values: list[Any] = []
    for entity in objects_in(situation.scene):
        pose = situation.poses.get(entity)
        values += [0.0] * (1 + len(POSE)) if pose is None else [1.0, *pose.position, *pose.quaternion]
    values += [situation.opening(entity) for entity in furniture_in(situation.scene)]
    return np.array(values, dtype=np.float32)
