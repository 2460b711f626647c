"""Read the ``[scene]`` table of a domain, and collect everything that is wrong with it.

Lengths are metres, angles in the file degrees.
"""

from __future__ import annotations

import difflib
import math
import re
from collections.abc import Iterable, Mapping, Sequence
from typing import Any, NamedTuple

from prag_asp.domain.scene_model import IGNORED, PREDICATE_ROLES, Scene, Shape, Table
from prag_asp.domain.scene_robots import ROBOTS, read_robots

FRAMES = ("robot", "viewer")
PALETTE = ("#e4572e", "#2e86ab", "#f2b134", "#3a9d5d", "#8e5bb5", "#d64577", "#4bb3b8", "#a0714f")
CONTAINER_COLOR = "#b9c4cc"
SHAPE_KEYS: Mapping[str, tuple[str, ...]] = {
    "box": ("size",),
    "cylinder": ("radius", "height"),
    "sphere": ("radius",),
    "container": ("size", "wall"),
    "table": (),
    "robot": (),
    "zone": ("size",),
}
SCENE_KEYS = ("robot", "robots", "frame", "workspace", "table", "shapes", "colors", "fixed", "predicates", "rotations")
MIN_WALL, MAX_LENGTH = 0.003, 2.0
PAIR, TRIPLE = 2, 3


class Problem(NamedTuple):
    """One mistake in a ``[scene]`` table: the dotted path of the key, and what is wrong with its value."""

    key: str
    message: str

    def __str__(self) -> str:
        return f"{self.key}: {self.message}"


def ancestors(name: str, classes: Mapping[str, Sequence[str]]) -> list[str]:
    """Return a class and its ancestors, nearest first; a cycle is walked once."""
    found = [name]
    for current in found:
        found += [parent for parent in classes.get(current, ()) if parent not in found]
    return found


def suggest(name: str, known: Iterable[str]) -> str:
    """Return a hint that names the nearest of `known`, or all of them."""
    options = sorted(known)
    near = difflib.get_close_matches(name, options, n=1)
    return f"did you mean {near[0]}?" if near else f"known are {', '.join(options) or 'none'}"


def _is_number(value: object) -> bool:
    """Tell whether a TOML value is a finite number."""
    return isinstance(value, int | float) and not isinstance(value, bool) and math.isfinite(value)


class SceneReader:
    """Reads a ``[scene]`` table, and collects what is wrong with it instead of stopping."""

    def __init__(self, classes: Mapping[str, Sequence[str]], entities: Mapping[str, str]):
        self.classes = {**dict.fromkeys(entities.values(), ()), **classes}
        self.entities = entities
        self.problems: list[Problem] = []

    def read(self, table: Mapping[str, Any]) -> Scene:
        """Return a scene; where a value is wrong the default stands in for it."""
        self.unknown("scene", table, SCENE_KEYS)
        by_class = {
            name: shape
            for name, value in self.section(table, "shapes").items()
            if self.known_class(f"scene.shapes.{name}", name)
            and (shape := self.shape(f"scene.shapes.{name}", value)) is not None
        }
        shapes = {entity: shape for entity in self.entities if (shape := self.inherited(entity, by_class))}
        robot = self.choice(table, "robot", ROBOTS)
        return Scene(
            shapes=shapes,
            robot=robot,
            frame=self.choice(table, "frame", FRAMES),
            workspace=self.workspace(self.section(table, "workspace")),
            table=self.table(self.section(table, "table")),
            colors=self.colors(self.section(table, "colors"), shapes),
            fixed=self.fixed(self.section(table, "fixed"), shapes),
            predicates=self.predicates(self.section(table, "predicates")),
            rotations=self.rotations(self.section(table, "rotations")),
            robots=read_robots(self, self.section(table, "robots"), shapes, robot),
        )

    def add(self, key: str, message: str) -> None:
        """Remember a problem."""
        self.problems.append(Problem(key, message))

    def unknown(self, key: str, table: Mapping[str, Any], known: Sequence[str]) -> None:
        """Report the keys of a table that are not known."""
        for name in table:
            if name not in known:
                self.add(f"{key}.{name}", f"unknown key; {suggest(name, known)}")

    def section(self, table: Mapping[str, Any], name: str) -> Mapping[str, Any]:
        """Return a table within the table, empty where it is missing."""
        value = table.get(name, {})
        if isinstance(value, Mapping):
            return value
        self.add(f"scene.{name}", f"needs a table; got {value!r}")
        return {}

    def choice(self, table: Mapping[str, Any], name: str, options: Sequence[str]) -> str:
        """Return one of `options`, the first where the key is missing."""
        value = table.get(name, options[0])
        if value in options:
            return str(value)
        self.add(f"scene.{name}", f"needs one of {', '.join(options)}; got {value!r}")
        return options[0]

    def lengths(self, key: str, value: Any, count: int) -> tuple[float, ...] | None:
        """Return `count` positive lengths in metres."""
        listed = isinstance(value, list) and len(value) == count
        if listed and all(_is_number(length) and 0 < length <= MAX_LENGTH for length in value):
            return tuple(map(float, value))
        words = {1: "a positive length", 2: "two positive lengths", 3: "three positive lengths"}[count]
        shown = value[0] if count == 1 and isinstance(value, list) else value
        self.add(key, f"needs {words} in metres (at most {MAX_LENGTH:g}); got {shown!r}")
        return None

    def known_class(self, key: str, name: str) -> bool:
        """Tell whether a class exists, and report it otherwise."""
        if name in self.classes or any(name in parents for parents in self.classes.values()):
            return True
        self.add(key, f"unknown class; {suggest(name, self.classes)}")
        return False

    def known_entity(self, key: str, name: str) -> bool:
        """Tell whether an entity exists, and report it otherwise."""
        if name in self.entities:
            return True
        self.add(key, f"unknown entity; {suggest(name, self.entities)}")
        return False

    def inherited(self, entity: str, by_class: Mapping[str, Shape]) -> Shape | None:
        """Return the shape of an entity's class or of its nearest ancestor that has one."""
        line = ancestors(self.entities[entity], self.classes)
        return next((by_class[name] for name in line if name in by_class), None)

    def shape(self, key: str, value: object) -> Shape | None:
        """Return the shape that a table of ``scene.shapes`` describes."""
        if not isinstance(value, Mapping):
            self.add(key, f'needs a table like {{ kind = "box", size = [0.05, 0.05, 0.05] }}; got {value!r}')
            return None
        kind = value.get("kind")
        if not isinstance(kind, str) or kind not in SHAPE_KEYS:
            self.add(f"{key}.kind", f"unknown shape {kind!r}; {suggest(str(kind), SHAPE_KEYS)}")
            return None
        before = len(self.problems)
        self.unknown(key, value, ("kind", *SHAPE_KEYS[kind]))
        size = self.size(key, kind, value)
        wall = self.wall(key, value, size) if kind == "container" else 0.0
        return Shape(kind, size, wall) if len(self.problems) == before else None

    def size(self, key: str, kind: str, value: Mapping[str, Any]) -> tuple[float, float, float]:
        """Return the sides of the bounding box of a shape in metres."""
        found: dict[str, tuple[float, ...]] = {}
        for name in SHAPE_KEYS[kind]:
            if name == "wall":
                continue
            count = (PAIR if kind == "zone" else TRIPLE) if name == "size" else 1
            given = value.get(name)
            found[name] = self.lengths(f"{key}.{name}", given if count > 1 else [given], count) or (0.0,) * count
        if "size" in found:
            sides = (*found["size"], 0.0)  # a zone is flat
            return (sides[0], sides[1], sides[2])
        diameter = 2 * found["radius"][0] if "radius" in found else 0.0
        height = found["height"][0] if "height" in found else diameter
        return (diameter, diameter, height)

    def wall(self, key: str, value: Mapping[str, Any], size: tuple[float, float, float]) -> float:
        """Return the thickness of a container's walls and floor in metres; 6 mm where it is missing."""
        wall = value.get("wall", 0.006)
        if _is_number(wall) and wall >= MIN_WALL and all(2 * wall < side for side in size):
            return float(wall)
        self.add(
            f"{key}.wall",
            f"needs a thickness in metres of at least {MIN_WALL} that leaves a cavity in size; got {wall!r}",
        )
        return MIN_WALL

    def table(self, value: Mapping[str, Any]) -> Table:
        """Return the table."""
        default = Table()
        self.unknown("scene.table", value, ("size", "centre", "color"))
        size = self.lengths("scene.table.size", value.get("size", list(default.size)), PAIR) or default.size
        centre = value.get("centre", list(default.centre))
        if not (isinstance(centre, list) and len(centre) == PAIR and all(map(_is_number, centre))):
            self.add("scene.table.centre", f"needs x and y in metres; got {centre!r}")
            centre = default.centre
        color = self.color("scene.table.color", value.get("color", default.color))
        return Table((size[0], size[1]), (float(centre[0]), float(centre[1])), color)

    def workspace(self, value: Mapping[str, Any]) -> tuple[float, float, float, float]:
        """Return the part of the table top where objects are put: low x, high x, low y, high y in metres."""
        self.unknown("scene.workspace", value, ("x", "y"))
        bounds = []
        for name, default in (("x", [0.3, 0.7]), ("y", [-0.4, 0.4])):
            pair = value.get(name, default)
            fine = isinstance(pair, list) and len(pair) == PAIR and all(map(_is_number, pair))
            if not fine or not -MAX_LENGTH <= pair[0] < pair[1] <= MAX_LENGTH:
                self.add(f"scene.workspace.{name}", f"needs a low and a high end in metres; got {pair!r}")
                pair = default
            bounds += [float(end) for end in pair]
        return (bounds[0], bounds[1], bounds[2], bounds[3])

    def color(self, key: str, value: object) -> str:
        """Return a colour as ``#rrggbb``."""
        if isinstance(value, str) and re.fullmatch(r"#[0-9a-fA-F]{6}", value):
            return value.lower()
        self.add(key, f'needs a colour like "#e4572e"; got {value!r}')
        return PALETTE[0]

    def colors(self, value: Mapping[str, Any], shapes: Mapping[str, Shape]) -> dict[str, str]:
        """Return the colour of every entity: its own, its class's, or the next of the palette."""
        given = {name: self.color(f"scene.colors.{name}", color) for name, color in value.items()}
        for name in value:
            if name not in self.entities and name not in self.classes:
                self.add(f"scene.colors.{name}", "unknown entity or class; " + suggest(name, self.entities))
        colors, position = {}, 0
        for entity, shape in shapes.items():
            line = [entity, *ancestors(self.entities[entity], self.classes)]
            own = next((given[name] for name in line if name in given), None)
            if own is None and shape.kind == "container":
                own = CONTAINER_COLOR
            colors[entity] = own or PALETTE[position % len(PALETTE)]
            position += own is None
        return colors

    def fixed(self, value: Mapping[str, Any], shapes: Mapping[str, Shape]) -> dict[str, tuple[float, float, float]]:
        """Return x, y in metres and yaw in radians of the entities that never move."""
        fixed = {}
        for entity, place in value.items():
            key = f"scene.fixed.{entity}"
            fine = isinstance(place, list) and len(place) in (PAIR, TRIPLE) and all(map(_is_number, place))
            if not self.known_entity(key, entity):
                continue
            if entity not in shapes or shapes[entity].kind in ("robot", "table"):
                self.add(key, f"needs an entity with the shape of an object or a zone; {entity} has none")
            elif not fine:
                self.add(key, f"needs x and y in metres, and a yaw in degrees if you like; got {place!r}")
            else:
                yaw = math.radians(place[2]) if len(place) == TRIPLE else 0.0
                fixed[entity] = (float(place[0]), float(place[1]), yaw)
        for entity, shape in shapes.items():
            if shape.kind == "zone" and entity not in value:
                self.add(f"scene.fixed.{entity}", "missing: a zone needs a place, x and y in metres")
        return fixed

    def predicates(self, value: Mapping[str, Any]) -> dict[str, str]:
        """Return which spatial predicate a fluent name means."""
        for fluent, predicate in value.items():
            if predicate not in PREDICATE_ROLES and predicate != IGNORED:
                hint = suggest(str(predicate), [*PREDICATE_ROLES, IGNORED])
                self.add(f"scene.predicates.{fluent}", f"unknown spatial predicate {predicate!r}; {hint}")
        return {fluent: str(predicate) for fluent, predicate in value.items()}

    def rotations(self, value: Mapping[str, Any]) -> dict[str, float]:
        """Return the yaw in radians that a name stands for."""
        rotations = {}
        for name, yaw in value.items():
            if _is_number(yaw):
                rotations[name] = math.radians(yaw)
            else:
                self.add(f"scene.rotations.{name}", f"needs a yaw in degrees; got {yaw!r}")
        return rotations
