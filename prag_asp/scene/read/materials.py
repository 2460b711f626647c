"""Read ``[scene.materials]`` and ``[scene.colors]``: the materials and colours of bodies."""

from __future__ import annotations

from collections.abc import Mapping

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
    """Return the material of every entity whose class or nearest ancestor has one; missing values are the default."""
    by_class = {}
    for name, entry in section.entries():
        if names.has_class(entry, name):
            usual = by_class[name] = Material()
            if entry.is_table("like { density = 700, friction = 0.5 }", tuple(LIMITS)):
                numbers = {key: entry.at(key, getattr(usual, key)).number(*limits) for key, limits in LIMITS.items()}
                by_class[name] = usual._replace(**{key: each for key, each in numbers.items() if each is not None})
    materials = {entity: names.inherited(entity, by_class) for entity in names.entities}
    return {entity: material for entity, material in materials.items() if material is not None}


PALETTE = ("#e4572e", "#2e86ab", "#f2b134", "#3a9d5d", "#8e5bb5", "#d64577", "#4bb3b8", "#a0714f")
CONTAINER_COLOR, FURNITURE_COLOR, ROBOT_COLOR = "#b9c4cc", "#b08457", "#edf0f2"
AROUND = (CONTAINER_COLOR, FURNITURE_COLOR, TableTop().color, "#f7f9fc", "#40434a")
"""The colours around objects: containers, furniture, the table, the sky, and the dark parts of robots."""

DISTINCT = 20.0
"""The smallest Delta E in CIELAB at which people distinguish two colours."""


def read_colors(section: TableEntry, names: DomainNames, shapes: Mapping[str, Shape], top: str) -> dict[str, str]:
    """Return the colour of every entity: its own, that of its class, or one that looks different from all others.

    `top` is the colour of the table.
    """
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
    taken = (*dict.fromkeys(each for each in colors.values() if each is not None), *AROUND)
    count = list(colors.values()).count(None)
    chosen = [each for each in PALETTE if all(apart(each, other) >= DISTINCT for other in taken)][:count]
    if len(chosen) < count:
        chosen += more_colours((*taken, *chosen), count - len(chosen))
    others = iter(chosen)
    return {entity: each or next(others) for entity, each in colors.items()}
