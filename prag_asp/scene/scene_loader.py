"""The ``[scene]`` table of a domain: what the classes look like and how they stand before the robot.

This module loads no simulator, so that the linter can use it.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from prag_asp.atom import Atom
from prag_asp.errors import SceneError
from prag_asp.scene.read.predicates import read_own
from prag_asp.scene.read.report import Fault, Report
from prag_asp.scene.read.scene_reader import read_scene
from prag_asp.scene.scene import (
    IGNORED,
    Scene,
    Shape,
)
from prag_asp.scene.shape_kinds import KINDS
from prag_asp.wording import did_you_mean, is_misspelt, plural


def parse_scene(
    table: Mapping[str, Any],
    classes: Mapping[str, Sequence[str]],
    entities: Mapping[str, str],
    *,
    folder: Path = Path(),
    trust: bool = False,
) -> Scene:
    """Return the scene that the ``[scene]`` table describes, shapes looked up for every entity.

    `classes` maps each class to its parents, `entities` each entity to its class. Paths begin at `folder`, that of the
    domain; physics runs the Python files there only with `trust`.

    Raises:
        SceneError: the first problem of the table, with its key.
    """
    report = Report(classes, entities, folder)
    scene = read_scene(report, table, read_own(report, table.get("own", {})))
    problems = report.problems or _without_objects(scene)
    if problems:
        raise SceneError(str(problems[0]))
    return replace(scene, trusted=trust)


def scene_problems(
    table: Mapping[str, Any],
    classes: Mapping[str, Sequence[str]],
    entities: Mapping[str, str],
    fluents: Iterable[Atom] = (),
    *,
    folder: Path = Path(),
) -> list[Fault]:
    """Return every problem of a ``[scene]`` table, and what the spatial ones of `fluents` lack in it."""
    report = Report(classes, entities, folder)
    scene = read_scene(report, table, read_own(report, table.get("own", {})))
    fluents = list(fluents)
    problems = [*report.problems, *_misspelt_fluents(scene, fluents)]
    seen: set[tuple[str, str]] = set()
    for fluent in fluents:
        if not report.doubtful.isdisjoint(fluent.arguments):
            continue
        for problem in _fluent_problems(scene, entities, fluent):
            if tuple(problem) not in seen:
                seen.add((problem.key, problem.message))
                problems.append(problem)
    return problems or _without_objects(scene)


def _misspelt_fluents(scene: Scene, fluents: Iterable[Atom]) -> Iterator[Fault]:
    """Yield names under ``scene.predicates`` that are no fluent's, but misspell that of one without meaning.

    A fluent that nothing grounds is not seen here, so a name that is unlike all others may well be right.
    """
    known = {fluent.name for fluent in fluents}
    meant = sorted(name for name in known if scene.meaning(Atom(name, ())) is None and name not in scene.predicates)
    for name in sorted(scene.predicates.keys() - known):
        if is_misspelt(name, meant):
            yield Fault(f"scene.predicates.{name}", f"there is no fluent {name}; {did_you_mean(name, meant)}")


def _without_objects(scene: Scene) -> list[Fault]:
    """Return the problem of a scene that has no object."""
    if any(shape.traits.body for shape in scene.shapes.values()):
        return []
    return [Fault("scene.shapes", "no entity has the shape of an object; give a class one, such as a box")]


def _fluent_problems(scene: Scene, entities: Mapping[str, str], fluent: Atom) -> Iterable[Fault]:
    """Yield what a spatial fluent lacks in the scene: the right number of arguments, shapes, rotations."""
    meaning = scene.meaning(fluent)
    if meaning is None:
        return
    roles = scene.roles(meaning)
    own = scene.own.get(meaning)
    if len(roles) != len(fluent.arguments):
        if own is not None and fluent.name == meaning:
            key, hint = f"scene.own.{meaning}.arguments", "list what each of them has to be"
        else:
            key, hint = (
                f"scene.predicates.{fluent.name}",
                f'write {fluent.name} = "{IGNORED}" if it means something else',
            )
        taken = f"{meaning} takes {len(roles)} ({', '.join(roles)})"
        yield Fault(key, f"{fluent} has {plural(len(fluent.arguments), 'argument')}, but {taken}; {hint}")
        return
    around = () if own is None or own.around is None else (("object", own.around),)
    for role, entity in (*zip(roles, fluent.arguments, strict=True), *around):
        shape = scene.shapes.get(entity)
        if role == "rotation" and entity not in scene.rotations:
            yield Fault(f"scene.rotations.{entity}", f"{fluent} needs the yaw of {entity} in degrees")
        elif role != "rotation" and shape is None:
            kind = entities.get(entity, entity)
            yield Fault(f"scene.shapes.{kind}", f"missing: {fluent} speaks about {entity}, a {kind}")
        elif role != "rotation" and shape is not None and not _plays(role, shape):
            furniture = " or ".join(name for name, each in KINDS.items() if each.furniture)
            wanted = furniture if role == "furniture" else role
            text, kind = f"{fluent} needs {entity} to be of the kind {wanted}", entities.get(entity, entity)
            if fluent.name in scene.predicates:
                hint = f"let it mean something else, or change scene.shapes.{kind}"
                yield Fault(f"scene.predicates.{fluent.name}", f"{text} where it means {meaning}; {hint}")
            else:
                yield Fault(f"scene.shapes.{kind}.kind", text)


def _plays(role: str, shape: Shape) -> bool:
    """Tell whether a body has the kind that an argument of a predicate asks for."""
    if role == "furniture":
        return shape.traits.furniture
    return (role == "robot") == (shape.kind == "robot")
