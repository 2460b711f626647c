"""Read ``[scene.robots]``: the kinds and the bases of the robots."""

from __future__ import annotations

import math
from collections.abc import Mapping
from itertools import combinations

from prag_asp.scene.footprint import TOUCHING, Footprint, apart
from prag_asp.scene.robots import ROBOTS
from prag_asp.scene.scene import Mount, Scene, Shape, only_robot
from prag_asp.tables.report import TableEntry

FARTHEST = 2.0
"""The largest distance of the base of a robot from the origin along x and y, in metres: a table is no larger."""

CLOSEST = 0.4
"""The least distance between the bases of two robots, in metres."""


def read_robots(section: TableEntry, shapes: Mapping[str, Shape], usual: str) -> dict[str, Mount]:
    """Return the mount of each robot by its entity; a table without entries means one robot at the origin.

    `usual` is the kind of a robot whose table names none.
    """
    entities = [entity for entity, shape in shapes.items() if shape.kind == "robot"]
    mounts = {}
    for entity, entry in section.entries():
        if entity in section.report.doubtful:
            continue
        if entity not in entities:
            entry.add(f"is not an entity with the shape of a robot; the scene has {', '.join(entities) or 'none'}")
        elif entry.is_table("like { base = [0.0, 0.4, 0] }", ("kind", "base")):
            kind = entry.at("kind", usual).choice(tuple(ROBOTS)) or usual
            base = entry.at("base", [0.0, 0.0, 0.0])
            x, y, yaw = base.numbers(3, "x and y in metres and a yaw in degrees") or (0.0, 0.0, 0.0)
            if max(abs(x), abs(y)) > FARTHEST:
                base.add(f"is more than {FARTHEST:g} m from the origin; move it nearer")
            if entry.is_sound:
                mounts[entity] = Mount(kind, x, y, math.radians(yaw))
    if (section.value or len(entities) > 1) and section.is_sound:
        for entity in entities:
            if entity not in section.value:
                section.at(entity).needs("{ base = [x, y, yaw] }, in metres and degrees")
    for one, two in combinations(mounts, 2):
        distance = math.hypot(mounts[one].x - mounts[two].x, mounts[one].y - mounts[two].y)
        if distance < CLOSEST:
            text = f"is {distance:g} m from that of {one}; move it to a distance of at least {CLOSEST:g} m"
            section.at(two).at("base").add(text)
    return mounts or only_robot(shapes, usual)


def check_bases(section: TableEntry, scene: Scene) -> None:
    """Report fixed bodies of a scene that overlap the base of a robot; the section is ``scene.fixed``."""
    for entity, place in scene.fixed.items():
        shape = scene.shapes[entity]
        for robot, mount in scene.robots.items() if shape.traits.body else ():
            cosine, sine = math.cos(mount.yaw), math.sin(mount.yaw)
            for piece in ROBOTS[mount.kind].footprint:
                x, y, yaw = piece.place
                there = (mount.x + cosine * x - sine * y, mount.y + sine * x + cosine * y, mount.yaw + yaw)
                if not apart(Footprint(shape, place), piece._replace(place=there), TOUCHING):
                    section.at(entity).add(f"{entity} stands on the base of {robot}; move it")
                    break
