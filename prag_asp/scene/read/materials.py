"""Read ``[scene.materials]``: what the bodies of a class are made of."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from prag_asp.scene.colours import apart, more_colours
from prag_asp.scene.read.report import Report, is_number
from prag_asp.scene.scene import Material, Shape, Table
from prag_asp.wording import did_you_mean

LIMITS: Mapping[str, tuple[float, float, str]] = {
    "density": (1.0, 25000.0, "kilograms a cubic metre"),
    "friction": (0.0, 10.0, "a coefficient"),
    "rolling": (0.0, 0.1, "metres"),
}


def read_materials(report: Report, table: Mapping[str, Any]) -> dict[str, Material]:
    """Return the material of every entity whose class or nearest ancestor has one."""
    by_class = {
        name: _material(report, f"scene.materials.{name}", value)
        for name, value in table.items()
        if report.known_class(f"scene.materials.{name}", name)
    }
    found = {
        entity: next((by_class[name] for name in report.line(entity) if name in by_class), None)
        for entity in report.entities
    }
    return {entity: material for entity, material in found.items() if material is not None}


def _material(report: Report, key: str, value: object) -> Material:
    """Return the material that a table describes, what it leaves out as of light wood."""
    if not isinstance(value, Mapping):
        report.add(key, f"needs a table like {{ density = 700, friction = 0.5 }}; got {value!r}")
        return Material()
    report.unknown(key, value, tuple(LIMITS))
    given: dict[str, float] = {}
    for name, (low, high, unit) in LIMITS.items():
        number = value.get(name, getattr(Material(), name))
        if is_number(number) and low <= number <= high:
            given[name] = float(number)
        else:
            report.add(f"{key}.{name}", f"needs a number from {low:g} to {high:g} ({unit}); got {number!r}")
    return Material(**given)


PALETTE = ("#e4572e", "#2e86ab", "#f2b134", "#3a9d5d", "#8e5bb5", "#d64577", "#4bb3b8", "#a0714f")
CONTAINER_COLOR, FURNITURE_COLOR, ROBOT_COLOR = "#b9c4cc", "#b08457", "#edf0f2"
AROUND = (CONTAINER_COLOR, FURNITURE_COLOR, Table().color, "#f7f9fc", "#40434a")
"""What is seen beside objects: containers, furniture, the table, the sky, and the dark parts of robots."""

TOLD_APART = 20.0
"""Colours of CIELAB that are nearer to each other than this are taken for one."""


def read_colors(report: Report, table: Mapping[str, Any], shapes: Mapping[str, Shape], top: str) -> dict[str, str]:
    """Return the colour of every entity: its own, its class's, or the next of the palette; `top` is the table's."""
    given = {name: report.color(f"scene.colors.{name}", color) for name, color in table.items()}
    for name in table:
        if name not in report.entities and name not in report.classes:
            hint = did_you_mean(name, [*report.entities, *report.classes])
            report.add(f"scene.colors.{name}", f"unknown entity or class; {hint}")
    colors: dict[str, str | None] = {}
    for entity, shape in shapes.items():
        own = next((given[name] for name in (entity, *report.line(entity)) if name in given), None)
        if own is None and shape.traits.hollow:
            own = FURNITURE_COLOR if shape.traits.furniture else CONTAINER_COLOR
        colors[entity] = own or {"table": top, "robot": ROBOT_COLOR}.get(shape.kind)
    without = sum(color is None for color in colors.values())
    others = iter(_others([color for color in colors.values() if color is not None], without))
    return {entity: color or next(others) for entity, color in colors.items()}


def _others(taken: Sequence[str], count: int) -> list[str]:
    """Return so many colours that are told apart from those that are taken, and from each other."""
    known = (*dict.fromkeys(taken), *AROUND)
    found = [color for color in PALETTE if all(apart(color, other) >= TOLD_APART for other in known)][:count]
    return [*found, *more_colours((*known, *found), count - len(found))] if len(found) < count else found
