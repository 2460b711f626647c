"""Read ``[scene.robots]``: which robots there are, and where they stand."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from typing import Any

from prag_asp.scene.footprint import TOUCHING, Footprint, Place, apart
from prag_asp.scene.read.report import Fault, Report, is_number
from prag_asp.scene.robots import ROBOTS
from prag_asp.scene.scene import Mount, Scene, Shape, only_robot

BASE_LENGTH = 3
FARTHEST = 2.0
CLOSEST = 0.4
"""How far from each other the bases of two robots have to be, in metres."""


def read_robots(report: Report, value: Mapping[str, Any], shapes: Mapping[str, Shape], usual: str) -> dict[str, Mount]:
    """Return where each robot stands, by entity; where the tables say nothing the only one stands at the origin.

    `usual` is the kind of those whose table does not say.
    """
    entities = [entity for entity, shape in shapes.items() if shape.kind == "robot"]
    mounts, before = {}, len(report.problems)
    for entity, table in value.items():
        key = f"scene.robots.{entity}"
        if entity in report.doubtful:
            continue
        if entity not in entities:
            report.add(key, f"needs an entity with the shape of a robot; they are {', '.join(entities) or 'none'}")
            continue
        if (mount := _mount(report, key, table, usual)) is not None:
            mounts[entity] = mount
    if (value or len(entities) > 1) and len(report.problems) == before:
        for entity in entities:
            if entity not in value:
                report.add(f"scene.robots.{entity}", "missing: write { base = [x, y, yaw] }, in metres and degrees")
    _check_apart(report, mounts)
    return mounts or only_robot(shapes, usual)


def base_problems(scene: Scene) -> Iterator[Fault]:
    """Yield fixed bodies that stand on the base of a robot."""
    for entity, place in scene.fixed.items():
        shape = scene.shapes[entity]
        for robot, mount in scene.robots.items() if shape.traits.body else ():
            pieces = (piece._replace(place=_placed(mount, piece.place)) for piece in ROBOTS[mount.kind].footprint)
            if not all(apart(Footprint(shape, place), piece, TOUCHING) for piece in pieces):
                yield Fault(f"scene.fixed.{entity}", f"{entity} stands on the base of {robot}; move it")


def _placed(mount: Mount, place: Place) -> Place:
    """Return in the frame of the scene where something is in the frame of a robot."""
    x, y, yaw = place
    cosine, sine = math.cos(mount.yaw), math.sin(mount.yaw)
    return mount.x + cosine * x - sine * y, mount.y + sine * x + cosine * y, mount.yaw + yaw


def _mount(report: Report, key: str, table: object, usual: str) -> Mount | None:
    """Return where one robot stands."""
    if not isinstance(table, Mapping):
        report.add(key, f"needs a table like {{ base = [0.0, 0.4, 0] }}; got {table!r}")
        return None
    before = len(report.problems)
    report.unknown(key, table, ("kind", "base"))
    kind, base = table.get("kind", usual), table.get("base", [0.0, 0.0, 0.0])
    if kind not in ROBOTS:
        report.add(f"{key}.kind", f"needs one of {', '.join(ROBOTS)}; got {kind!r}")
        return None
    listed = isinstance(base, list) and len(base) == BASE_LENGTH
    if not listed or not all(map(is_number, base)):
        report.add(f"{key}.base", f"needs x and y in metres and a yaw in degrees; got {base!r}")
        return None
    if max(abs(base[0]), abs(base[1])) > FARTHEST:
        report.add(f"{key}.base", f"stands more than {FARTHEST:g} m from the origin; got {base!r}")
        return None
    if len(report.problems) > before:
        return None
    return Mount(kind, float(base[0]), float(base[1]), math.radians(base[2]))


def _check_apart(report: Report, mounts: Mapping[str, Mount]) -> None:
    """Report robots that stand in each other."""
    names = list(mounts)
    for i, one in enumerate(names):
        for two in names[i + 1 :]:
            apart = math.hypot(mounts[one].x - mounts[two].x, mounts[one].y - mounts[two].y)
            if apart < CLOSEST:
                report.add(
                    f"scene.robots.{two}.base", f"is {apart:g} m from that of {one}; they need {CLOSEST:g} m at least"
                )
