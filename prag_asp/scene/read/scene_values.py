"""Values that several tables of a scene have: lengths, colours, and the names of classes and entities."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

from prag_asp.tables.report import TableEntry
from prag_asp.wording import did_you_mean

MAX_LENGTH = 2.0
"""The largest length of a body in metres: no table is larger, and millimetres written as metres are found."""

SMALLEST = 0.003
"""The smallest side of a body in metres.

To PyBullet boxes and cylinders are at least 2 mm thick, because it keeps 1 mm around them; and what is within 2 mm of a
top rests on it. Distances of thinner bodies are wrong, and above and below cannot be distinguished.
"""

FALLBACK_COLOR = "#808080"
COUNTS = {1: "a positive length", 2: "two positive lengths", 3: "three positive lengths"}


@dataclass(frozen=True)
class DomainNames:
    """The names that a scene may use: `classes` with their parents, `entities` with their classes; and the folder."""

    classes: Mapping[str, Sequence[str]]
    entities: Mapping[str, str]
    folder: Path = Path()

    @cached_property
    def known_classes(self) -> Mapping[str, Sequence[str]]:
        """The classes with their parents, those that only entities name included."""
        return {**dict.fromkeys(self.entities.values(), ()), **self.classes}

    def line(self, entity: str) -> list[str]:
        """Return the class of an entity and its ancestors, nearest first."""
        return ancestors(self.entities[entity], self.known_classes)

    def has_class(self, entry: TableEntry, name: str) -> bool:
        """Return whether a class exists, and report it otherwise."""
        if name in self.known_classes or any(name in parents for parents in self.classes.values()):
            return True
        entry.add(f"unknown class; {did_you_mean(name, self.known_classes)}")
        return False

    def has_entity(self, entry: TableEntry, name: str) -> bool:
        """Return whether an entity exists, and report it otherwise."""
        if name in self.entities:
            return True
        entry.add(f"unknown entity; {did_you_mean(name, self.entities)}")
        return False


def ancestors(name: str, classes: Mapping[str, Sequence[str]]) -> list[str]:
    """Return a class and its ancestors, nearest first; a cycle is walked once."""
    result = [name]
    for current in result:
        result += [parent for parent in classes.get(current, ()) if parent not in result]
    return result


def lengths(entry: TableEntry, count: int, least: float = SMALLEST) -> tuple[float, ...] | None:
    """Return `count` lengths of at least `least` metres, None where the value is something else."""
    limits = f"at least {least:g}, at most {MAX_LENGTH:g}"
    return entry.numbers(count, f"{COUNTS[count]} in metres ({limits})", least, MAX_LENGTH)


def color(entry: TableEntry) -> str:
    """Return a colour as ``#rrggbb``, grey where the value is something else."""
    return (entry.matching(r"#[0-9a-fA-F]{6}", 'a colour like "#e4572e"') or FALLBACK_COLOR).lower()
