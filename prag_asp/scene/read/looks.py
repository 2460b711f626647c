"""Read ``[scene.materials]``: what the bodies of a class are made of."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from prag_asp.scene.model import Material
from prag_asp.scene.read.report import Report, is_number

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
