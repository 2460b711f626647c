"""Read ``[scene.materials]``: what the bodies of a class are made of."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import islice

from prag_asp.scene.colours import apart, more_colours
from prag_asp.scene.read.scene_values import DomainNames, color
from prag_asp.scene.scene import Material, Shape, TableTop
from prag_asp.tables.report import TableEntry
from prag_asp.wording import did_you_mean

LIMITS: Mapping[str, tuple[float, float, str]] = {
    "density": (1.0, 25000.0, "kilograms a cubic metre"),
    "friction": (0.0, 10.0, "a coefficient"),
    "rolling": (0.0, 0.1, "metres"),
}


def read_materials(section: TableEntry, names: DomainNames) -> dict[str, Material]:
    """Return the material of every entity whose class or nearest ancestor has one."""
    by_class = {name: _material(entry) for name, entry in section.entries() if names.has_class(entry, name)}
    materials = {
        entity: next((by_class[name] for name in names.line(entity) if name in by_class), None)
        for entity in names.entities
    }
    return {entity: material for entity, material in materials.items() if material is not None}


def _material(entry: TableEntry) -> Material:
    """Return the material that a table describes; what it leaves out is as of light wood."""
    usual = Material()
    if not entry.is_table("like { density = 700, friction = 0.5 }", tuple(LIMITS)):
        return usual
    numbers = {name: entry.at(name, getattr(usual, name)).number(*limits) for name, limits in LIMITS.items()}
    return usual._replace(**{name: number for name, number in numbers.items() if number is not None})


PALETTE = ("#e4572e", "#2e86ab", "#f2b134", "#3a9d5d", "#8e5bb5", "#d64577", "#4bb3b8", "#a0714f")
CONTAINER_COLOR, FURNITURE_COLOR, ROBOT_COLOR = "#b9c4cc", "#b08457", "#edf0f2"
AROUND = (CONTAINER_COLOR, FURNITURE_COLOR, TableTop().color, "#f7f9fc", "#40434a")
"""What is seen beside objects: containers, furniture, the table, the sky, and the dark parts of robots."""

DISTINCT = 20.0
"""The least Delta E in CIELAB between colours that people do not take for one."""


def read_colors(section: TableEntry, names: DomainNames, shapes: Mapping[str, Shape], top: str) -> dict[str, str]:
    """Return the colour of every entity: its own, its class's, or the next of the palette; `top` is the table's."""
    own_colors = {name: color(entry) for name, entry in section.entries()}
    for name, entry in section.entries():
        if name not in names.entities and name not in names.known_classes:
            hint = did_you_mean(name, [*names.entities, *names.known_classes])
            entry.add(f"unknown entity or class; {hint}")
    colors: dict[str, str | None] = {}
    for entity, shape in shapes.items():
        own = next((own_colors[name] for name in (entity, *names.line(entity)) if name in own_colors), None)
        if own is None and shape.traits.hollow:
            own = FURNITURE_COLOR if shape.traits.furniture else CONTAINER_COLOR
        colors[entity] = own or {"table": top, "robot": ROBOT_COLOR}.get(shape.kind)
    others = iter(
        _distinct_colors([each for each in colors.values() if each is not None], list(colors.values()).count(None))
    )
    return {entity: each or next(others) for entity, each in colors.items()}


def _distinct_colors(taken: Sequence[str], count: int) -> list[str]:
    """Return `count` colours that look different from those that are taken, and from each other."""
    others = (*dict.fromkeys(taken), *AROUND)
    distinct = (each for each in PALETTE if all(apart(each, other) >= DISTINCT for other in others))
    chosen = list(islice(distinct, count))
    return [*chosen, *more_colours((*others, *chosen), count - len(chosen))] if len(chosen) < count else chosen
