"""Read values of a ``[scene]`` table, and collect what is wrong with them instead of stopping."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

from prag_asp.wording import did_you_mean, nearest

MAX_LENGTH = 2.0
SMALLEST = 0.003
"""The smallest side of a body in metres.

To PyBullet boxes and cylinders are at least 2 mm thick, for it keeps 1 mm around them; and what is within 2 mm of a top
rests on it. Of thinner bodies distances are wrong, and above and below cannot be told apart.
"""

FALLBACK_COLOR = "#808080"
COUNTS = {1: "a positive length", 2: "two positive lengths", 3: "three positive lengths"}


class Fault(NamedTuple):
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


def is_number(value: object) -> bool:
    """Tell whether a TOML value is a number that can be a length or an angle: no NaN, and not beyond all measure."""
    return isinstance(value, int | float) and not isinstance(value, bool) and abs(value) <= 1e9


class Report:
    """The problems of a ``[scene]`` table, the classes and entities that it may speak about, the domain's folder.

    `doubtful` are entities and own predicates whose entries are wrong, `misspelt` the paths of keys that are there
    under a name that is nearly theirs: what they lack needs no second line.
    """

    def __init__(self, classes: Mapping[str, Sequence[str]], entities: Mapping[str, str], folder: Path = Path()):
        self.folder = folder
        self.classes = {**dict.fromkeys(entities.values(), ()), **classes}
        self.entities = entities
        self.problems: list[Fault] = []
        self.doubtful: set[str] = set()
        self.misspelt: set[str] = set()

    def add(self, key: str, message: str) -> None:
        """Remember a problem, unless it is that of a misspelt key."""
        if key not in self.misspelt:
            self.problems.append(Fault(key, message))

    def unknown(self, key: str, table: Mapping[str, Any], known: Sequence[str]) -> None:
        """Report the keys of a table that are not known."""
        for name in table:
            if name not in known:
                self.add(f"{key}.{name}", f"unknown key; {did_you_mean(name, known)}")
                meant = nearest(name, known)
                if meant is not None and meant not in table:
                    self.misspelt.add(f"{key}.{meant}")

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

    def lengths(self, key: str, value: Any, count: int, least: float = SMALLEST) -> tuple[float, ...] | None:
        """Return `count` lengths of at least `least` metres."""
        listed = isinstance(value, list) and len(value) == count
        if listed and all(is_number(length) and least <= length <= MAX_LENGTH for length in value):
            return tuple(map(float, value))
        shown = value[0] if count == 1 and isinstance(value, list) else value
        self.add(key, f"needs {COUNTS[count]} in metres (at least {least:g}, at most {MAX_LENGTH:g}); got {shown!r}")
        return None

    def color(self, key: str, value: object) -> str:
        """Return a colour as ``#rrggbb``."""
        if isinstance(value, str) and re.fullmatch(r"#[0-9a-fA-F]{6}", value):
            return value.lower()
        self.add(key, f'needs a colour like "#e4572e"; got {value!r}')
        return FALLBACK_COLOR

    def known_class(self, key: str, name: str) -> bool:
        """Tell whether a class exists, and report it otherwise."""
        if name in self.classes or any(name in parents for parents in self.classes.values()):
            return True
        self.add(key, f"unknown class; {did_you_mean(name, self.classes)}")
        return False

    def known_entity(self, key: str, name: str) -> bool:
        """Tell whether an entity exists, and report it otherwise."""
        if name in self.entities:
            return True
        self.add(key, f"unknown entity; {did_you_mean(name, self.entities)}")
        return False

    def line(self, entity: str) -> list[str]:
        """Return the class of an entity and its ancestors, nearest first."""
        return ancestors(self.entities[entity], self.classes)
