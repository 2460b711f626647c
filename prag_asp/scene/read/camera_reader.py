"""Read ``[scene.cameras]``: the cameras of a scene, and collect everything that is wrong with them.

[scene.cameras.front]
at = [1.2, 0.6, 0.8]
look_at = [0.4, 0.0, 0.1]
field_of_view = 45

[scene.cameras.wrist]           # in the frame of the tool of a robot
mount = "panda"
at = [0.08, 0.0, -0.12]
look_at = [0.0, 0.0, 0.02]
"""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from typing import Any

from prag_asp.scene.boxes import Vector
from prag_asp.scene.cameras import Camera
from prag_asp.scene.read.report import Report, is_number
from prag_asp.wording import did_you_mean

KEYS = ("at", "look_at", "field_of_view", "mount", "size", "near", "far")
NAME = re.compile(r"[a-z][a-z0-9_]*")
FARTHEST = 10.0
"""How far from the origin a camera and what it looks at can be, in metres."""

CLOSEST = 0.01
"""How far a camera is at least from what it looks at, in metres."""

ANGLES = (5.0, 150.0)
PIXELS = (16, 2048)
RANGE = (0.005, 100.0)


def read_cameras(report: Report, value: Mapping[str, Any], robots: Mapping[str, object]) -> dict[str, Camera]:
    """Return the cameras by their names, those with mistakes left out; `robots` are those that can carry one."""
    found = {}
    for name, table in value.items():
        key, before = f"scene.cameras.{name}", len(report.problems)
        if not NAME.fullmatch(name):
            report.add(key, "is no name of a camera; begin with a small letter, go on with small letters, digits and _")
        elif not isinstance(table, Mapping):
            report.add(key, f"needs a table like {{ at = [1.2, 0.6, 0.8], look_at = [0.4, 0, 0.1] }}; got {table!r}")
        else:
            camera = _camera(report, key, table, robots)
            if len(report.problems) == before:
                found[name] = camera
    return found


def _camera(report: Report, key: str, table: Mapping[str, Any], robots: Mapping[str, object]) -> Camera:
    """Return one camera; where something is wrong with it, a problem has been added."""
    report.unknown(key, table, KEYS)
    mount = str(table.get("mount", ""))
    if mount not in robots and "mount" in table:
        report.add(f"{key}.mount", f"needs a robot of the scene; {did_you_mean(mount, robots)}")
    at, look_at = (_point(report, f"{key}.{name}", table.get(name)) for name in ("at", "look_at"))
    if at and look_at and math.dist(at, look_at) < CLOSEST:
        report.add(f"{key}.look_at", f"is where the camera is; look at a point at least {CLOSEST:g} m away")
    usual = Camera((0.0, 0.0, 0.0), (0.0, 0.0, 0.0))
    near, far = (
        _number(report, f"{key}.{name}", table.get(name, getattr(usual, name)), RANGE, "metres")
        for name in ("near", "far")
    )
    if near >= far:
        report.add(f"{key}.far", f"is not farther than near, {near:g} m; got {far:g}")
    angle = table.get("field_of_view", usual.field_of_view)
    return Camera(
        at or usual.at,
        look_at or usual.look_at,
        _number(report, f"{key}.field_of_view", angle, ANGLES, "degrees"),
        mount,
        _size(report, f"{key}.size", table.get("size", list(usual.size))),
        near,
        far,
    )


def _point(report: Report, key: str, value: object) -> Vector | None:
    """Return a point in metres."""
    if isinstance(value, list) and len(value) == 3 and all(is_number(each) and abs(each) <= FARTHEST for each in value):
        return (float(value[0]), float(value[1]), float(value[2]))
    got = "" if value is None else f"; got {value!r}"
    asked = f"x, y and z in metres, within {FARTHEST:g} m of the origin"
    report.add(key, f"{'missing: write' if value is None else 'needs'} {asked}{got}")
    return None


def _number(report: Report, key: str, value: Any, limits: tuple[float, float], unit: str) -> float:
    """Return a number within limits, the low one where it is none."""
    low, high = limits
    if is_number(value) and low <= value <= high:
        return float(value)
    report.add(key, f"needs a number from {low:g} to {high:g} ({unit}); got {value!r}")
    return low


def _size(report: Report, key: str, value: object) -> tuple[int, int]:
    """Return width and height in pixels."""
    low, high = PIXELS
    whole = isinstance(value, list) and len(value) == 2 and all(type(side) is int for side in value)
    if whole and isinstance(value, list) and all(low <= side <= high for side in value):
        return (value[0], value[1])
    report.add(key, f"needs width and height in pixels, from {low} to {high}; got {value!r}")
    return (low, low)
