"""Values that occur in several tables of a scene: lengths, colours, and the names of classes and entities."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TypeVar

from prag_asp.scene.scene import GREY
from prag_asp.tables.report import TableEntry
from prag_asp.wording import did_you_mean

MAX_LENGTH = 2.0
"""The largest length of a body in metres; no table is larger, and the limit detects values in millimetres."""

SMALLEST = 0.003
"""The smallest dimension of a body in metres.

PyBullet adds a margin of 1 mm on all sides of boxes and cylinders, so its distances are wrong for thinner bodies. A
body within 2 mm of a top rests on it, so for a thinner body, above and below could not be distinguished.
"""

Value = TypeVar("Value")
COUNTS = {1: "a positive length", 2: "two positive lengths", 3: "three positive lengths"}


@dataclass(frozen=True)
class DomainNames:
    """The names in a domain: `classes` with their parents, `entities` with their classes, and the domain's folder."""

    classes: Mapping[str, Sequence[str]]
    entities: Mapping[str, str]
    folder: Path = Path()

    @cached_property
    def known_classes(self) -> Mapping[str, Sequence[str]]:
        """The classes with their parents, including classes of entities that no rule declares."""
        return {**dict.fromkeys(self.entities.values(), ()), **self.classes}

    def line(self, entity: str) -> list[str]:
        """Return the class of an entity and its ancestors, nearest first."""
        return ancestors(self.entities[entity], self.known_classes)

    def inherited(self, entity: str, by_class: Mapping[str, Value]) -> Value | None:
        """Return the value for the class of an entity, or for its nearest ancestor that has a value."""
        return next((by_class[name] for name in self.line(entity) if name in by_class), None)

    def has_class(self, entry: TableEntry, name: str) -> bool:
        """Return whether a class exists, and report it if it does not."""
        if name in self.known_classes or any(name in parents for parents in self.classes.values()):
            return True
        entry.add(f"unknown class; {did_you_mean(name, self.known_classes)}")
        return False

    def has_entity(self, entry: TableEntry, name: str) -> bool:
        """Return whether an entity exists, and report it if it does not."""
        if name in self.entities:
            return True
        entry.add(f"unknown entity; {did_you_mean(name, self.entities)}")
        return False


def ancestors(name: str, classes: Mapping[str, Sequence[str]]) -> list[str]:
    """Return a class and its ancestors without repetition, nearest first."""
    result = [name]
    for current in result:
        result += [parent for parent in classes.get(current, ()) if parent not in result]
    return result


def lengths(entry: TableEntry, count: int, least: float = SMALLEST) -> tuple[float, ...] | None:
    """Return `count` lengths of at least `least` metres, or report the value and return None."""
    limits = f"at least {least:g}, at most {MAX_LENGTH:g}"
    return entry.numbers(count, f"{COUNTS[count]} in metres ({limits})", least, MAX_LENGTH)


def color(entry: TableEntry) -> str:
    """Return a colour as ``#rrggbb``, or report the value and return grey."""
    return (entry.matching(r"#[0-9a-fA-F]{6}", 'a colour like "#e4572e"') or GREY).lower()
