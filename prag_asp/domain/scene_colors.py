"""Read ``[scene.colors]``."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from prag_asp.scene.model import Shape
from prag_asp.scene.read.report import Report, suggest

PALETTE = ("#e4572e", "#2e86ab", "#f2b134", "#3a9d5d", "#8e5bb5", "#d64577", "#4bb3b8", "#a0714f")
CONTAINER_COLOR, FURNITURE_COLOR = "#b9c4cc", "#b08457"


def read_colors(report: Report, table: Mapping[str, Any], shapes: Mapping[str, Shape]) -> dict[str, str]:
    """Return the colour of every entity: its own, its class's, or the next of the palette."""
    given = {name: report.color(f"scene.colors.{name}", color) for name, color in table.items()}
    for name in table:
        if name not in report.entities and name not in report.classes:
            report.add(f"scene.colors.{name}", "unknown entity or class; " + suggest(name, report.entities))
    colors, position = {}, 0
    for entity, shape in shapes.items():
        own = next((given[name] for name in (entity, *report.line(entity)) if name in given), None)
        if own is None and shape.traits.hollow:
            own = FURNITURE_COLOR if shape.traits.furniture else CONTAINER_COLOR
        colors[entity] = own or PALETTE[position % len(PALETTE)]
        position += own is None
    return colors
