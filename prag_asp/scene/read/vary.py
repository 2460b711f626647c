"""Read ``[scene.vary]``: the ranges within which episodes differ.

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

from prag_asp.scene.scene import Ranges
from prag_asp.tables.report import Entry

FACTORS = (0.05, 20.0)
"""The least and the largest factor of friction and mass: they cover all materials that bodies are made of."""

LIMITS: Mapping[str, tuple[float, str]] = {
    "light": (80.0, "degrees"),
    "camera": (0.4, "a share of how far the camera is from what it looks at"),
    "colour": (60.0, "Delta E in CIELAB"),
}
"""The largest value of each kind, and its unit."""


def read_vary(section: Entry) -> Ranges:
    """Return the ranges, the usual ones where nothing is said."""
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
    for name, (most, unit) in LIMITS.items():
        number = section.at(name, getattr(usual, name)).number(0.0, most, unit)
        ranges[name] = getattr(usual, name) if number is None else number
    return Ranges(**ranges)
