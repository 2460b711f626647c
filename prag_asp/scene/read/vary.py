"""Read ``[scene.vary]``: within what ranges recordings differ, and collect everything that is wrong with them.

[scene.vary]
friction = [0.8, 1.2]           # times what the material has
mass = [0.8, 1.2]               # times what it weighs
light = 30                      # degrees by which the light is turned at most
camera = 0.05                   # the share of what is between them by which camera and target are moved at most
colour = 10                     # Delta E in CIELAB by which a colour is moved at most
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from prag_asp.scene.read.report import Report, is_number
from prag_asp.scene.scene import Ranges

FACTORS = (0.05, 20.0)
LIMITS: Mapping[str, tuple[float, str]] = {
    "light": (80.0, "degrees"),
    "camera": (0.4, "a share of how far the camera is from what it looks at"),
    "colour": (60.0, "Delta E in CIELAB"),
}


def read_vary(report: Report, value: Mapping[str, Any]) -> Ranges:
    """Return the ranges, the usual ones where nothing is said."""
    usual = Ranges()
    report.unknown("scene.vary", value, Ranges._fields)
    low, high = FACTORS
    given: dict[str, Any] = {}
    for name in ("friction", "mass"):
        pair = value.get(name, list(getattr(usual, name)))
        if (
            isinstance(pair, list)
            and len(pair) == 2
            and all(map(is_number, pair))
            and low <= pair[0] <= pair[1] <= high
        ):
            given[name] = (float(pair[0]), float(pair[1]))
        else:
            asked = f"a low and a high factor from {low:g} to {high:g}, such as [0.8, 1.2]"
            report.add(f"scene.vary.{name}", f"needs {asked}; got {pair!r}")
    for name, (most, unit) in LIMITS.items():
        number = value.get(name, getattr(usual, name))
        if is_number(number) and 0.0 <= number <= most:
            given[name] = float(number)
        else:
            report.add(f"scene.vary.{name}", f"needs a number from 0 to {most:g} ({unit}); got {number!r}")
    return usual._replace(**given)
