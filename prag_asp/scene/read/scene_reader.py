"""Read the ``[scene]`` table of a domain, and collect everything that is wrong with it.

Lengths are metres, angles in the file degrees.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from prag_asp.scene.predicate_names import PREDICATE_ROLES
from prag_asp.scene.read.camera_reader import read_cameras
from prag_asp.scene.read.layout import place_problems, read_fixed, read_table, read_workspace
from prag_asp.scene.read.materials import read_colors, read_materials
from prag_asp.scene.read.report import Report, is_number
from prag_asp.scene.read.robots import base_problems, read_robots
from prag_asp.scene.read.shapes import read_shapes
from prag_asp.scene.read.stability import falls
from prag_asp.scene.read.vary import read_vary
from prag_asp.scene.robots import ROBOTS
from prag_asp.scene.scene import IGNORED, Own, Scene, Shape, Table
from prag_asp.wording import did_you_mean

FRAMES = ("robot", "viewer")
SCENE_KEYS = (
    "robot",
    "robots",
    "frame",
    "workspace",
    "table",
    "shapes",
    "materials",
    "colors",
    "fixed",
    "predicates",
    "rotations",
    "own",
    "cameras",
    "vary",
)


def read_scene(report: Report, table: Mapping[str, Any], own: Mapping[str, Own]) -> Scene:
    """Return a scene that has its `own` predicates too; a wrong value is reported, and the default stands in for it."""
    report.unknown("scene", table, SCENE_KEYS)
    if not isinstance(table.get("shapes", {}), Mapping) or "scene.shapes" in report.misspelt:
        report.doubtful |= set(report.entities)
    sizes = read_shapes(report, report.section(table, "shapes"))
    shapes = {entity: several[-1] for entity, several in sizes.items()}
    usual = report.choice(table, "robot", tuple(ROBOTS))
    arms = {entity: shape for entity, shape in shapes.items() if shape.kind == "robot"}
    robots = read_robots(report, report.section(table, "robots"), shapes, usual)
    top = read_table(report, report.section(table, "table"))
    scene = Scene(
        shapes=shapes,
        robots=robots,
        frame=report.choice(table, "frame", FRAMES),
        workspace=read_workspace(report, report.section(table, "workspace")),
        table=top,
        colors=read_colors(report, report.section(table, "colors"), shapes, top.color),
        fixed=read_fixed(report, report.section(table, "fixed"), shapes),
        predicates=_predicates(report, report.section(table, "predicates"), own),
        rotations=_rotations(report, report.section(table, "rotations")),
        materials=read_materials(report, report.section(table, "materials")),
        own=own,
        cameras=read_cameras(report, report.section(table, "cameras"), {**robots, **arms}),
        vary=read_vary(report, report.section(table, "vary")),
        ranges={entity: several for entity, several in sizes.items() if len(several) > 1},
    )
    if not report.problems:
        _check_bodies(report, scene, report.section(table, "shapes"))
    return scene


def _check_bodies(report: Report, scene: Scene, given: Mapping[str, Any]) -> None:
    """Report objects larger than the table, fixed ones off it or in each other or a robot, furniture without a place.

    `given` is ``scene.shapes`` by class.
    """
    for entity, shape in scene.shapes.items():
        if shape.traits.furniture and entity not in scene.fixed:
            report.add(f"scene.fixed.{entity}", f"missing: {entity} is a {shape.kind}, which does not move; say where")
    bodies = {entity: shape for entity, shape in scene.shapes.items() if shape.traits.body}
    fallen: dict[str, str] = {}
    for entity, shape in bodies.items():
        owner = next(name for name in report.line(entity) if name in given)
        if shape.model is not None and entity not in scene.fixed and falls(shape.model.solids):
            fallen.setdefault(owner, entity)
        if _larger(shape, scene.table):
            sides, room = sorted(shape.size[:2]), sorted(scene.table.size)
            text = f"{sides[1]:g} x {sides[0]:g} m is larger than the table, which is {room[1]:g} x {room[0]:g} m"
            report.add(f"scene.shapes.{owner}", f"{text}; make it smaller")
            report.doubtful.add(entity)
    for owner, entity in fallen.items():
        text = f"{entity} falls over: the middle of its box, its centre of mass here, is not above what it stands on"
        report.add(f"scene.shapes.{owner}.path", f"{text}; turn it, widen its foot, or fix it to a place")
    fixed = {entity: place for entity, place in scene.fixed.items() if entity not in report.doubtful}
    report.problems += [*place_problems(scene.table, scene.shapes, fixed), *base_problems(replace(scene, fixed=fixed))]


def _larger(shape: Shape, table: Table) -> bool:
    """Tell whether a body is longer or broader than the table."""
    return any(side > room for side, room in zip(sorted(shape.size[:2]), sorted(table.size), strict=True))


def _predicates(report: Report, value: Mapping[str, Any], own: Mapping[str, Own]) -> dict[str, str]:
    """Return which spatial predicate a fluent name means."""
    known = [*PREDICATE_ROLES, *own, IGNORED]
    for fluent, predicate in value.items():
        if predicate not in known and str(predicate) not in report.doubtful:
            hint = did_you_mean(str(predicate), known)
            report.add(f"scene.predicates.{fluent}", f"unknown spatial predicate {predicate!r}; {hint}")
    return {fluent: str(predicate) for fluent, predicate in value.items()}


def _rotations(report: Report, value: Mapping[str, Any]) -> dict[str, float]:
    """Return the yaw in radians that a name stands for."""
    rotations = {}
    for name, yaw in value.items():
        if is_number(yaw):
            rotations[name] = math.radians(yaw)
        else:
            report.add(f"scene.rotations.{name}", f"needs a yaw in degrees; got {yaw!r}")
    return rotations
