"""Read ``[scene.shapes]``: what the bodies of a class look like."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from prag_asp.domain.scene_model import Shape
from prag_asp.domain.scene_report import Report, is_number, suggest

SHAPE_KEYS: Mapping[str, tuple[str, ...]] = {
    "box": ("size",),
    "cylinder": ("radius", "height"),
    "sphere": ("radius",),
    "container": ("size", "wall"),
    "table": (),
    "robot": (),
}
MIN_WALL = 0.003
TRIPLE = 3


def read_shapes(report: Report, table: Mapping[str, Any]) -> dict[str, Shape]:
    """Return the shape of every entity: that of its class, or of its nearest ancestor that has one."""
    by_class = {
        name: shape
        for name, value in table.items()
        if report.known_class(f"scene.shapes.{name}", name)
        and (shape := _shape(report, f"scene.shapes.{name}", value)) is not None
    }
    found = {
        entity: next((by_class[name] for name in report.line(entity) if name in by_class), None)
        for entity in report.entities
    }
    return {entity: shape for entity, shape in found.items() if shape is not None}


def _shape(report: Report, key: str, value: object) -> Shape | None:
    """Return the shape that a table of ``scene.shapes`` describes."""
    if not isinstance(value, Mapping):
        report.add(key, f'needs a table like {{ kind = "box", size = [0.05, 0.05, 0.05] }}; got {value!r}')
        return None
    kind = value.get("kind")
    if not isinstance(kind, str) or kind not in SHAPE_KEYS:
        report.add(f"{key}.kind", f"unknown shape {kind!r}; {suggest(str(kind), SHAPE_KEYS)}")
        return None
    before = len(report.problems)
    report.unknown(key, value, ("kind", *SHAPE_KEYS[kind]))
    size = _size(report, key, kind, value)
    wall = _wall(report, key, value, size) if kind == "container" else 0.0
    return Shape(kind, size, wall) if len(report.problems) == before else None


def _size(report: Report, key: str, kind: str, value: Mapping[str, Any]) -> tuple[float, float, float]:
    """Return the sides of the bounding box of a shape in metres."""
    found: dict[str, tuple[float, ...]] = {}
    for name in SHAPE_KEYS[kind]:
        if name == "wall":
            continue
        count = TRIPLE if name == "size" else 1
        given = value.get(name)
        found[name] = report.lengths(f"{key}.{name}", given if count > 1 else [given], count) or (0.0,) * count
    if "size" in found:
        return (found["size"][0], found["size"][1], found["size"][2])
    diameter = 2 * found["radius"][0] if "radius" in found else 0.0
    height = found["height"][0] if "height" in found else diameter
    return (diameter, diameter, height)


def _wall(report: Report, key: str, value: Mapping[str, Any], size: tuple[float, float, float]) -> float:
    """Return the thickness of a container's walls and floor in metres; 6 mm where it is missing."""
    wall = value.get("wall", 0.006)
    if is_number(wall) and wall >= MIN_WALL and all(2 * wall < side for side in size):
        return float(wall)
    report.add(
        f"{key}.wall",
        f"needs a thickness in metres of at least {MIN_WALL} that leaves a cavity in size; got {wall!r}",
    )
    return MIN_WALL
