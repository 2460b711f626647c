"""Read the ``[scene]`` table of a domain.

Lengths are metres, angles in the file degrees.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from prag_asp.scene.predicate_names import PREDICATE_ROLES
from prag_asp.scene.read.camera_reader import read_cameras
from prag_asp.scene.read.layout import check_places, read_fixed, read_table, read_workspace
from prag_asp.scene.read.materials import read_colors, read_materials
from prag_asp.scene.read.predicates import read_own
from prag_asp.scene.read.robots import check_bases, read_robots
from prag_asp.scene.read.scene_values import DomainNames
from prag_asp.scene.read.shapes import read_shapes
from prag_asp.scene.read.stability import falls
from prag_asp.scene.robots import ROBOTS
from prag_asp.scene.scene import IGNORED, Own, Ranges, Scene
from prag_asp.tables.report import TableEntry, is_number, shown
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

FACTORS = (0.05, 20.0)
"""The smallest and the largest factor of friction and mass, which cover all materials."""

LARGEST_RANGES: Mapping[str, tuple[float, str]] = {
    "light": (80.0, "degrees"),
    "camera": (0.4, "a share of how far the camera is from what it looks at"),
    "colour": (60.0, "Delta E in CIELAB"),
}
"""The largest range of each kind, and its unit."""


def read_scene(root: TableEntry, names: DomainNames) -> Scene:
    """Return the scene of a ``[scene]`` table; a wrong value is reported, and replaced by the default."""
    report = root.report
    root.require_known(SCENE_KEYS)
    if not isinstance(root.value.get("shapes", {}), Mapping) or (*root.keys, "shapes") in report.misspelt:
        report.doubtful |= set(names.entities)
    own = read_own(root.at("own", {}), names)
    sizes = read_shapes(root.section("shapes"), names)
    shapes = {entity: several[-1] for entity, several in sizes.items()}
    usual = root.at("robot", next(iter(ROBOTS))).choice(tuple(ROBOTS)) or next(iter(ROBOTS))
    arms = {entity: shape for entity, shape in shapes.items() if shape.kind == "robot"}
    robots = read_robots(root.section("robots"), shapes, usual)
    top = read_table(root.section("table"))
    scene = Scene(
        shapes=shapes,
        robots=robots,
        frame=root.at("frame", FRAMES[0]).choice(FRAMES) or FRAMES[0],
        workspace=read_workspace(root.section("workspace")),
        table=top,
        colors=read_colors(root.section("colors"), names, shapes, top.color),
        fixed=read_fixed(root.section("fixed"), names, shapes),
        predicates=_predicates(root.section("predicates"), own),
        rotations=_rotations(root.section("rotations")),
        materials=read_materials(root.section("materials"), names),
        own=own,
        cameras=read_cameras(root.section("cameras"), {**robots, **arms}),
        vary=_ranges(root.section("vary")),
        ranges={entity: several for entity, several in sizes.items() if len(several) > 1},
    )
    if not report.problems:
        _check_bodies(root, scene, names)
    return scene


def _check_bodies(root: TableEntry, scene: Scene, names: DomainNames) -> None:
    """Report bodies with an impossible place.

    These are bodies larger than the table, fixed bodies off the table or overlapping each other or a robot, bodies that
    fall over, and furniture without a place.
    """
    report, shapes, places = root.report, root.section("shapes"), root.section("fixed")
    for entity, shape in scene.shapes.items():
        if shape.traits.furniture and entity not in scene.fixed:
            places.at(entity).needs(f"the place of {entity}, because a {shape.kind} does not move")
    fallen: dict[str, str] = {}
    for entity, shape in scene.shapes.items():
        if not shape.traits.body:
            continue
        owner = next(name for name in names.line(entity) if name in shapes.value)
        if shape.model is not None and entity not in scene.fixed and falls(shape.model.solids):
            fallen.setdefault(owner, entity)
        sides, room = sorted(shape.size[:2]), sorted(scene.table.size)
        if sides[0] > room[0] or sides[1] > room[1]:
            text = f"{sides[1]:g} x {sides[0]:g} m is larger than the table, which is {room[1]:g} x {room[0]:g} m"
            shapes.at(owner).add(f"{text}; make it smaller")
            report.doubtful.add(entity)
    for owner, entity in fallen.items():
        text = f"{entity} falls over: its centre of mass, the centre of its box, is not above its base"
        shapes.at(owner).at("path").add(f"{text}; turn it, widen its base, or fix its place")
    fixed = {entity: place for entity, place in scene.fixed.items() if entity not in report.doubtful}
    check_places(places, scene.table, scene.shapes, fixed)
    check_bases(places, replace(scene, fixed=fixed))


def _predicates(section: TableEntry, own: Mapping[str, Own]) -> dict[str, str]:
    """Return the spatial predicate of each fluent name."""
    names = [*PREDICATE_ROLES, *own, IGNORED]
    for _, entry in section.entries():
        if entry.value not in names and str(entry.value) not in section.report.doubtful:
            entry.add(f"unknown spatial predicate {shown(entry.value)}; {did_you_mean(str(entry.value), names)}")
    return {fluent: str(entry.value) for fluent, entry in section.entries()}


def _rotations(section: TableEntry) -> dict[str, float]:
    """Return the yaw of each rotation in radians."""
    rotations = {}
    for name, entry in section.entries():
        if is_number(entry.value):
            rotations[name] = math.radians(entry.value)
        else:
            entry.needs("a yaw in degrees")
    return rotations


def _ranges(section: TableEntry) -> Ranges:
    """Return the ranges of domain randomization; a missing one is the default."""
    usual, (low, high) = Ranges(), FACTORS
    section.require_known(Ranges._fields)
    ranges: dict[str, Any] = {}
    what = f"a low and a high factor from {low:g} to {high:g}, such as [0.8, 1.2]"
    for name in ("friction", "mass"):
        entry = section.at(name, list(getattr(usual, name)))
        pair = entry.numbers(2, what, low, high)
        if pair is not None and pair[0] > pair[1]:
            entry.needs(what)
        ranges[name] = pair or getattr(usual, name)
    for name, (most, unit) in LARGEST_RANGES.items():
        number = section.at(name, getattr(usual, name)).number(0.0, most, unit)
        ranges[name] = getattr(usual, name) if number is None else number
    return Ranges(**ranges)
