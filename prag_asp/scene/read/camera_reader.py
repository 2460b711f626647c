"""Read ``[scene.cameras]``: the cameras of a scene.

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

from prag_asp.scene.boxes import Vector
from prag_asp.scene.cameras import Camera
from prag_asp.tables.report import TableEntry
from prag_asp.wording import did_you_mean

KEYS = ("at", "look_at", "field_of_view", "mount", "size", "near", "far")
NAME = re.compile(r"[a-z][a-z0-9_]*")
FARTHEST = 10.0
"""The largest distance of a camera or its target from the origin along each axis, in metres."""

CLOSEST = 0.01
"""The smallest distance of a camera from its target, in metres."""

ANGLES = (5.0, 150.0)
"""The smallest and the largest field of view in degrees; a pinhole camera always has less than 180."""

PIXELS = (16, 2048)
"""The smallest and the largest side of an image in pixels; policies need no larger images, and the software renderer is
slow."""

RANGE = (0.005, 100.0)
"""The smallest and the largest distance to a clipping plane, in metres."""


def read_cameras(section: TableEntry, robots: Mapping[str, object]) -> dict[str, Camera]:
    """Return the valid cameras by name; a camera can be mounted on any of the `robots`."""
    cameras = {}
    for name, entry in section.entries():
        if not NAME.fullmatch(name):
            entry.add("is not a valid name of a camera; use a lower-case letter, then lower-case letters, digits and _")
        elif entry.is_table("like { at = [1.2, 0.6, 0.8], look_at = [0.4, 0, 0.1] }", KEYS):
            camera = _camera(entry, robots)
            if entry.is_sound:
                cameras[name] = camera
    return cameras


def _camera(entry: TableEntry, robots: Mapping[str, object]) -> Camera:
    """Return a camera, with defaults in place of invalid values."""
    usual = Camera((0.0, 0.0, 0.0), (0.0, 0.0, 0.0))
    mount = entry.at("mount")
    if not mount.missing and str(mount.value) not in robots:
        mount.add(f"needs a robot of the scene; {did_you_mean(str(mount.value), robots)}")
    at, look_at = _point(entry.at("at")), _point(entry.at("look_at"))
    if at and look_at and math.dist(at, look_at) < CLOSEST:
        entry.at("look_at").add(f"is the position of the camera; look at a point at least {CLOSEST:g} m away")
    near = entry.at("near", usual.near).number(*RANGE, "metres") or usual.near
    far = entry.at("far", usual.far).number(*RANGE, "metres") or usual.far
    if near >= far:
        entry.at("far").add(f"is {far:g} m, not farther than near, {near:g} m; make it larger")
    angle = entry.at("field_of_view", usual.field_of_view).number(*ANGLES, "degrees")
    size, (shortest, longest) = entry.at("size", list(usual.size)), PIXELS
    sides = size.value if isinstance(size.value, list) else []
    if len(sides) != 2 or not all(type(side) is int and shortest <= side <= longest for side in sides):
        size.needs(f"width and height in pixels, from {shortest} to {longest}")
        sides = list(usual.size)
    return Camera(
        at or usual.at,
        look_at or usual.look_at,
        angle or usual.field_of_view,
        str(mount.value or ""),
        (sides[0], sides[1]),
        near,
        far,
    )


def _point(entry: TableEntry) -> Vector | None:
    """Return a point in metres."""
    what = f"x, y and z in metres, within {FARTHEST:g} m of the origin"
    numbers = entry.numbers(3, what, -FARTHEST, FARTHEST)
    return None if numbers is None else (numbers[0], numbers[1], numbers[2])
