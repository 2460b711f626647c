"""Read ``[scene.table]``, ``[scene.workspace]`` and ``[scene.fixed]``: the table, and positions on it."""

from __future__ import annotations

import math
from collections.abc import Mapping
from itertools import combinations

from prag_asp.scene.footprint import TOUCHING, Footprint, Place, apart, corners
from prag_asp.scene.read.scene_values import MAX_LENGTH, DomainNames, color, lengths
from prag_asp.scene.scene import Shape, TableTop
from prag_asp.tables.report import TableEntry

PLACELESS = ("robot", "table")
WORKSPACE = {"x": (0.3, 0.7), "y": (-0.4, 0.4)}
"""The default workspace in metres: the area that an arm at the origin can reach from above."""


def read_table(section: TableEntry) -> TableTop:
    """Return the table."""
    usual = TableTop()
    section.require_known(("size", "centre", "color"))
    size = lengths(section.at("size", list(usual.size)), 2) or usual.size
    centre = section.at("centre", list(usual.centre)).numbers(2, "x and y in metres") or usual.centre
    return TableTop((size[0], size[1]), (centre[0], centre[1]), color(section.at("color", usual.color)))


def read_workspace(section: TableEntry) -> tuple[float, float, float, float]:
    """Return the part of the table on which the search places objects: low x, high x, low y and high y in metres."""
    section.require_known(tuple(WORKSPACE))
    what = f"a low and a high end in metres, within {MAX_LENGTH:g} m of the origin"
    bounds: list[float] = []
    for name, usual in WORKSPACE.items():
        entry = section.at(name, list(usual))
        pair = entry.numbers(2, what, -MAX_LENGTH, MAX_LENGTH) or usual
        if pair[0] >= pair[1]:
            entry.needs(what)
        bounds += pair
    return (bounds[0], bounds[1], bounds[2], bounds[3])


def read_fixed(section: TableEntry, names: DomainNames, shapes: Mapping[str, Shape]) -> dict[str, Place]:
    """Return the x and y in metres and the yaw in radians of the entities that never move."""
    fixed, doubtful = {}, section.report.doubtful
    for entity, entry in section.entries():
        if not names.has_entity(entry, entity) or entity in doubtful:
            continue
        if entity not in shapes:
            entry.add(f"{entity} has no shape; set scene.shapes.{names.entities[entity]}")
            doubtful.add(entity)
        elif (kind := shapes[entity].kind) in PLACELESS:
            entry.add(f"names a {kind}, which cannot be fixed; fix an entity with the shape of an object or a zone")
        else:
            count = 3 if isinstance(entry.value, list) and len(entry.value) == 3 else 2
            place = entry.numbers(count, "x and y in metres, and optionally a yaw in degrees")
            if place is not None:
                fixed[entity] = (place[0], place[1], math.radians(place[2]) if count == 3 else 0.0)
    for entity, shape in shapes.items():
        if shape.kind == "zone":
            entry = section.at(entity)
            if entry.missing:
                entry.needs("x and y in metres, because a zone needs a place")
    return fixed


def check_places(section: TableEntry, top: TableTop, shapes: Mapping[str, Shape], fixed: Mapping[str, Place]) -> None:
    """Report fixed bodies that are not entirely on the table, and pairs of the other fixed bodies that overlap."""
    (x, y), (size_x, size_y) = top.centre, top.size
    bodies = [entity for entity in fixed if shapes[entity].traits.body]
    for entity, place in fixed.items():
        outer = corners(Footprint(shapes[entity], place))
        if any(abs(at_x - x) > size_x / 2 or abs(at_y - y) > size_y / 2 for at_x, at_y in outer):
            section.at(entity).add(f"{entity} is not wholly on the table; move it or enlarge the table")
            bodies = [other for other in bodies if other != entity]
    for one, two in combinations(bodies, 2):
        if not apart(Footprint(shapes[one], fixed[one]), Footprint(shapes[two], fixed[two]), TOUCHING):
            section.at(two).add(f"{two} overlaps {one}, which is fixed too; move one of them")
