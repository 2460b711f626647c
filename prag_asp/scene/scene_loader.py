"""Load the ``[scene]`` table of a domain, or collect its problems for the linter, without a simulator."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from prag_asp.atom import Atom
from prag_asp.errors import SceneError
from prag_asp.scene.read.scene_reader import read_scene
from prag_asp.scene.read.scene_values import DomainNames
from prag_asp.scene.scene import IGNORED, Scene
from prag_asp.scene.shape_kinds import KINDS
from prag_asp.tables.report import Keys, TableEntry, TableProblem, TableReport, path_text
from prag_asp.wording import did_you_mean, is_misspelt, plural


def parse_scene(
    table: Mapping[str, Any],
    classes: Mapping[str, Sequence[str]],
    entities: Mapping[str, str],
    *,
    folder: Path = Path(),
    trust: bool = False,
) -> Scene:
    """Return the scene that a ``[scene]`` table defines, in which every entity has the shape of its class.

    `classes` maps each class to its parents, and `entities` maps each entity to its class. Paths are relative to
    `folder`, the folder of the domain. Physics runs the Python files of the domain only with `trust`.

    Raises:
        SceneError: the table has problems; the message contains one line for each, with its key.
    """
    report, scene = _read(table, DomainNames(classes, entities, folder))
    if not report.problems:
        _require_objects(report, scene)
    if report.problems:
        raise SceneError(*map(str, report.problems))
    return replace(scene, trusted=trust)


def scene_problems(
    table: Mapping[str, Any],
    classes: Mapping[str, Sequence[str]],
    entities: Mapping[str, str],
    fluents: Iterable[Atom] = (),
    *,
    folder: Path = Path(),
) -> list[TableProblem]:
    """Return all problems of a ``[scene]`` table; it must define everything that spatial `fluents` need."""
    report, scene = _read(table, DomainNames(classes, entities, folder))
    fluents = list(fluents)
    names = {fluent.name for fluent in fluents}
    meant = sorted(name for name in names if scene.meaning(Atom(name, ())) is None and name not in scene.predicates)
    for name in sorted(scene.predicates.keys() - names):
        # A fluent without ground atoms is not in `fluents`, so a name that resembles no other may still be correct.
        if is_misspelt(name, meant):
            report.add(("scene", "predicates", name), f"there is no fluent {name}; {did_you_mean(name, meant)}")
    for fluent in fluents:
        if report.doubtful.isdisjoint(fluent.arguments):
            _check_fluent(report, scene, entities, fluent)
    if not report.problems:
        _require_objects(report, scene)
    return list(dict.fromkeys(report.problems))


def _read(table: Mapping[str, Any], names: DomainNames) -> tuple[TableReport, Scene]:
    """Return a scene, and the report of its problems."""
    report = TableReport()
    return report, read_scene(TableEntry(report, ("scene",), table), names)


def _require_objects(report: TableReport, scene: Scene) -> None:
    """Report a scene that has no object."""
    if not any(shape.traits.body for shape in scene.shapes.values()):
        text = "no entity has the shape of an object; give a class one, such as a box"
        report.add(("scene", "shapes"), text)


def _check_fluent(report: TableReport, scene: Scene, entities: Mapping[str, str], fluent: Atom) -> None:
    """Report a spatial fluent with a wrong number of arguments, or with missing shapes or rotations."""
    meaning = scene.meaning(fluent)
    if meaning is None:
        return
    roles, own = scene.roles(meaning), scene.own.get(meaning)
    if len(roles) != len(fluent.arguments):
        keys: Keys = ("scene", "own", meaning, "arguments")
        hint = "list what each of them has to be"
        if own is None or fluent.name != meaning:
            keys = ("scene", "predicates", fluent.name)
            hint = f'write {fluent.name} = "{IGNORED}" if it means something else'
        takes = f"{meaning} takes {len(roles)} ({', '.join(roles)})"
        report.add(keys, f"{fluent} has {plural(len(fluent.arguments), 'argument')}, but {takes}; {hint}")
        return
    around = () if own is None or own.around is None else (("object", own.around),)
    for role, entity in (*zip(roles, fluent.arguments, strict=True), *around):
        shape, kind = scene.shapes.get(entity), entities.get(entity, entity)
        if role == "rotation":
            if entity not in scene.rotations:
                keys = ("scene", "rotations", entity)
                report.add(keys, f"{fluent} needs the yaw of {entity} in degrees; set {path_text(keys)}")
        elif shape is None:
            keys = ("scene", "shapes", kind)
            report.add(keys, f"missing: {fluent} names {entity}, a {kind}; set {path_text(keys)}")
        elif not (shape.traits.furniture if role == "furniture" else (role == "robot") == (shape.kind == "robot")):
            furniture = " or ".join(name for name, each in KINDS.items() if each.furniture)
            needed = f"{fluent} needs {entity} to be of the kind {furniture if role == 'furniture' else role}"
            if fluent.name in scene.predicates:
                hint = f"let it mean something else, or change scene.shapes.{kind}"
                report.add(("scene", "predicates", fluent.name), f"{needed} where it means {meaning}; {hint}")
            else:
                report.add(("scene", "shapes", kind, "kind"), f"{needed}; change it")
