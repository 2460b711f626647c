"""Drawers and cupboards, measured anew from their description; metres, each in the frame of the middle of its size.

A drawer is a cabinet, open in front (-x), with a tray that slides out; a cupboard is a low box whose door lies on top
and turns clockwise about a pin at the corner of +x and +y. Handles are posts that stand up.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from tests.independent.frames import Array, Frame, moved, turned

GAP = 0.002
"""Between what moves and what does not."""

POST, STEM, TALL, GRIP = 0.022, 0.010, 0.055, 0.020
"""Sides and height of a post, the thickness of the stem that holds it, how far below its top it is gripped."""

OFF = 0.025
"""From the front of a drawer to the middle of its post; as far is that of a door from its edge."""

Corners = tuple[tuple[float, float], tuple[float, float], tuple[float, float]]
"""The ends of a box along x, y and z."""


class Furniture(NamedTuple):
    """What stands still, and what moves, in the frame of its joint; boxes by their ends.

    The last `handles` of the `moving` boxes are what the gripper may touch; it holds them at `grip`, in the frame of
    the joint. `limit` is in metres where it `slides`, else in radians. `room` is where things lie, from the floor to
    the rim, in the frame of the joint where it slides, and `floor` what it is laid out on.
    """

    still: tuple[Corners, ...]
    moving: tuple[Corners, ...]
    handles: int
    joint: Array
    slides: bool
    limit: float
    grip: Array
    room: Corners
    floor: Corners

    def shift(self, opening: float) -> Frame:
        """Return the frame of the joint where furniture is open so far, in that of the furniture."""
        if self.slides:
            return moved(self.joint[0] - opening, self.joint[1], self.joint[2])
        return Frame(turned(-opening, "z"), self.joint)


def drawer(size: Array, wall: float) -> Furniture:
    """Return a drawer of a size with walls of a thickness."""
    x, y, z = size / 2
    mouth, end = wall - x, x - wall - GAP
    side, bottom, floor = y - wall - GAP, GAP - z, GAP + wall - z
    rim = floor + 2 / 3 * (z - wall - GAP - floor)
    low = z + GRIP - TALL
    post = -x - OFF
    roof = ((mouth, x), (-y, y), (z - wall, z))
    sides = [((mouth, x), (min(a, b), max(a, b)), (-z, z - wall)) for a, b in ((y - wall, y), (-y, wall - y))]
    back = ((x - wall, x), (wall - y, y - wall), (-z, z - wall))
    panel = ((-x, mouth - GAP), (-y, y), (bottom, z))
    tray = ((mouth - GAP, end), (-side, side), (bottom, floor))
    walls = [((mouth - GAP, end), ends, (floor, rim)) for ends in ((side - wall, side), (-side, wall - side))]
    rear = ((end - wall, end), (wall - side, side - wall), (floor, rim))
    stem = ((post, -x), (-STEM / 2, STEM / 2), (low, low + STEM))
    return Furniture(
        still=(roof, *sides, back),
        moving=(panel, tray, *walls, rear, stem, _post(post, 0.0, low)),
        handles=2,
        joint=np.zeros(3),
        slides=True,
        limit=float(end - wall - mouth),
        grip=np.array([post, 0.0, low + TALL - GRIP]),
        room=((mouth - GAP, end - wall), (wall - side, side - wall), (floor, rim)),
        floor=tray,
    )


def cupboard(size: Array, wall: float) -> Furniture:
    """Return a cupboard of a size with walls of a thickness."""
    x, y, z = size / 2
    floor, rim = wall - z, z - wall - GAP
    bottom = ((-x, x), (-y, y), (-z, floor))
    long = [((-x, x), ends, (floor, rim)) for ends in ((y - wall, y), (-y, wall - y))]
    short = [(ends, (wall - y, y - wall), (floor, rim)) for ends in ((x - wall, x), (-x, wall - x))]
    pin = np.array([x - wall / 2, y - wall / 2, 0.0])
    door = (((-x, x), (-y, y), (z - wall, z)), _post(OFF - x, 0.0, z))
    return Furniture(
        still=(bottom, *long, *short),
        moving=tuple(_from(pin, box) for box in door),
        handles=1,
        joint=pin,
        slides=False,
        limit=float(np.pi / 2),
        grip=np.array([OFF - x, 0.0, z + TALL - GRIP]) - pin,
        room=((wall - x, x - wall), (wall - y, y - wall), (floor, rim)),
        floor=bottom,
    )


def _post(x: float, y: float, low: float) -> Corners:
    return (x - POST / 2, x + POST / 2), (y - POST / 2, y + POST / 2), (low, low + TALL)


def _from(origin: Array, box: Corners) -> Corners:
    (ax, bx), (ay, by), (az, bz) = box
    x, y, z = origin
    return (ax - x, bx - x), (ay - y, by - y), (az - z, bz - z)


MADE = {"drawer": drawer, "cupboard": cupboard}
"""By the kind of its shape."""
