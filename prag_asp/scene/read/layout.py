"""Read ``[scene.table]``, ``[scene.workspace]`` and ``[scene.fixed]``: where things are."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from itertools import combinations
from typing import Any

from prag_asp.scene.footprint import TOUCHING, Footprint, Place, apart, corners
from prag_asp.scene.read.report import MAX_LENGTH, Fault, Report, is_number
from prag_asp.scene.scene import Shape, Table

PAIR, TRIPLE = 2, 3
PLACELESS = ("robot", "table")


def read_table(report: Report, value: Mapping[str, Any]) -> Table:
    """Return the table."""
    default = Table()
    report.unknown("scene.table", value, ("size", "centre", "color"))
    size = report.lengths("scene.table.size", value.get("size", list(default.size)), PAIR) or default.size
    centre = value.get("centre", list(default.centre))
    if not (isinstance(centre, list) and len(centre) == PAIR and all(map(is_number, centre))):
        report.add("scene.table.centre", f"needs x and y in metres; got {centre!r}")
        centre = default.centre
    color = report.color("scene.table.color", value.get("color", default.color))
    return Table((size[0], size[1]), (float(centre[0]), float(centre[1])), color)


def read_workspace(report: Report, value: Mapping[str, Any]) -> tuple[float, float, float, float]:
    """Return the part of the table top where objects are put: low x, high x, low y, high y in metres."""
    report.unknown("scene.workspace", value, ("x", "y"))
    bounds = []
    for name, default in (("x", [0.3, 0.7]), ("y", [-0.4, 0.4])):
        pair = value.get(name, default)
        fine = isinstance(pair, list) and len(pair) == PAIR and all(map(is_number, pair))
        if not fine or not -MAX_LENGTH <= pair[0] < pair[1] <= MAX_LENGTH:
            limits = f"within {MAX_LENGTH:g} m of the origin"
            report.add(f"scene.workspace.{name}", f"needs a low and a high end in metres, {limits}; got {pair!r}")
            pair = default
        bounds += [float(end) for end in pair]
    return (bounds[0], bounds[1], bounds[2], bounds[3])


def read_fixed(report: Report, value: Mapping[str, Any], shapes: Mapping[str, Shape]) -> dict[str, Place]:
    """Return x, y in metres and yaw in radians of the entities that never move."""
    fixed = {}
    for entity, place in value.items():
        key = f"scene.fixed.{entity}"
        fine = isinstance(place, list) and len(place) in (PAIR, TRIPLE) and all(map(is_number, place))
        if not report.known_entity(key, entity):
            continue
        if entity in report.doubtful:
            continue
        if entity not in shapes:
            kind = report.entities[entity]
            report.add(key, f"{entity} has no shape; set scene.shapes.{kind}")
            report.doubtful.add(entity)
        elif shapes[entity].kind in PLACELESS:
            report.add(
                key, f"needs an entity with the shape of an object or a zone; {entity} is a {shapes[entity].kind}"
            )
        elif not fine:
            report.add(key, f"needs x and y in metres, and a yaw in degrees if you like; got {place!r}")
        else:
            yaw = math.radians(place[2]) if len(place) == TRIPLE else 0.0
            fixed[entity] = (float(place[0]), float(place[1]), yaw)
    for entity, shape in shapes.items():
        if shape.kind == "zone" and entity not in value:
            report.add(f"scene.fixed.{entity}", "missing: a zone needs a place, x and y in metres")
    return fixed


def place_problems(table: Table, shapes: Mapping[str, Shape], fixed: Mapping[str, Place]) -> Iterator[Fault]:
    """Yield fixed bodies that are not wholly on the table, and pairs of the others that overlap."""
    (x, y), (size_x, size_y) = table.centre, table.size
    bodies = [entity for entity in fixed if shapes[entity].traits.body]
    for entity, place in fixed.items():
        outer = corners(Footprint(shapes[entity], place))
        if any(abs(at_x - x) > size_x / 2 or abs(at_y - y) > size_y / 2 for at_x, at_y in outer):
            text = f"{entity} is not wholly on the table; move it or enlarge the table"
            yield Fault(f"scene.fixed.{entity}", text)
            bodies = [other for other in bodies if other != entity]
    for one, two in combinations(bodies, 2):
        if not apart(Footprint(shapes[one], fixed[one]), Footprint(shapes[two], fixed[two]), TOUCHING):
            yield Fault(f"scene.fixed.{two}", f"{two} overlaps {one}, which is fixed too; move one of them")
