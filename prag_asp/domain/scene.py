"""The ``[scene]`` table of a domain: what the classes look like and how they stand before the robot.

This module loads no simulator, so that the linter can use it.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from prag_asp.domain.atom import Atom
from prag_asp.domain.scene_model import BODILESS, IGNORED, PREDICATE_ROLES, Mount, Scene, Shape, Table
from prag_asp.domain.scene_table import SCENE_KEYS, SHAPE_KEYS, Problem, SceneReader, ancestors
from prag_asp.errors import SceneError

__all__ = [
    "BODILESS",
    "IGNORED",
    "PREDICATE_ROLES",
    "SCENE_KEYS",
    "SHAPE_KEYS",
    "Mount",
    "Problem",
    "Scene",
    "Shape",
    "Table",
    "ancestors",
    "parse_scene",
    "scene_problems",
]


def parse_scene(table: Mapping[str, Any], classes: Mapping[str, Sequence[str]], entities: Mapping[str, str]) -> Scene:
    """Return the scene that the ``[scene]`` table describes, shapes looked up for every entity.

    `classes` maps each class to its parents, `entities` each entity to its class.

    Raises:
        SceneError: the first problem of the table, with its key.
    """
    reader = SceneReader(classes, entities)
    scene = reader.read(table)
    if reader.problems:
        raise SceneError(str(reader.problems[0]))
    return scene


def scene_problems(
    table: Mapping[str, Any],
    classes: Mapping[str, Sequence[str]],
    entities: Mapping[str, str],
    fluents: Iterable[Atom] = (),
) -> list[Problem]:
    """Return every problem of a ``[scene]`` table, and what the spatial ones of `fluents` lack in it."""
    reader = SceneReader(classes, entities)
    scene = reader.read(table)
    problems = list(reader.problems)
    seen: set[tuple[str, str]] = set()
    for fluent in fluents:
        for problem in _fluent_problems(scene, entities, fluent):
            if tuple(problem) not in seen:
                seen.add((problem.key, problem.message))
                problems.append(problem)
    return problems


def _fluent_problems(scene: Scene, entities: Mapping[str, str], fluent: Atom) -> Iterable[Problem]:
    """Yield what a spatial fluent lacks in the scene: the right number of arguments, shapes, rotations."""
    meaning = scene.meaning(fluent)
    if meaning is None:
        return
    roles = PREDICATE_ROLES[meaning]
    if len(roles) != len(fluent.arguments):
        yield Problem(
            f"scene.predicates.{fluent.name}",
            f"{fluent} has {len(fluent.arguments)} arguments, but {meaning} takes {len(roles)} "
            f'({", ".join(roles)}); write {fluent.name} = "{IGNORED}" if it means something else',
        )
        return
    for role, entity in zip(roles, fluent.arguments, strict=True):
        shape = scene.shapes.get(entity)
        if role == "rotation" and entity not in scene.rotations:
            yield Problem(f"scene.rotations.{entity}", f"{fluent} needs the yaw of {entity} in degrees")
        elif role != "rotation" and shape is None:
            kind = entities.get(entity, entity)
            yield Problem(f"scene.shapes.{kind}", f"missing: {fluent} speaks about {entity}, a {kind}")
        elif role != "rotation" and shape is not None and (role == "robot") != (shape.kind == "robot"):
            kind = entities.get(entity, entity)
            yield Problem(f"scene.shapes.{kind}.kind", f"{fluent} needs {entity} to be of the kind {role}")
