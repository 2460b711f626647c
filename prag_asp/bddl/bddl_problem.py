"""A BDDL problem as plain values: objects, fixtures, regions, initial facts, goal and language."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TypeAlias

Rectangle: TypeAlias = tuple[float, float, float, float]
"""The minimum x and y and the maximum x and y of an area, in metres."""


@dataclass(frozen=True)
class BddlFact:
    """An atom; a term is the name of an object, a fixture, a region or a room, or of a variable in a quantifier."""

    predicate: str
    terms: tuple[str, ...] = ()
    line: int = field(default=0, compare=False)


@dataclass(frozen=True)
class Connective:
    """A formula composed of others by ``and``, ``or``, ``not`` (one part) or ``imply`` (two parts)."""

    kind: str
    parts: tuple[BddlFormula, ...]


@dataclass(frozen=True)
class Quantifier:
    """A formula over all objects of some classes.

    `kind` is ``forall``, ``exists``, ``forn`` (exactly `number` objects), ``forpairs`` (as many pairs of two classes as
    the smaller class has objects) or ``fornpairs`` (`number` pairs). `variables` are names with their classes.
    """

    kind: str
    variables: tuple[tuple[str, str], ...]
    part: BddlFormula
    number: int | None = None


BddlFormula: TypeAlias = "BddlFact | Connective | Quantifier"

TRUE = Connective("and", ())
"""The empty conjunction, which is the goal of a problem without a goal."""


@dataclass(frozen=True)
class Region:
    """A named part of a fixture or an object, or an area on it if there are `ranges`; in facts, it is ``TARGET_NAME``.

    `yaw` holds the smallest and the largest yaw of objects placed there, in radians.
    """

    name: str
    target: str
    ranges: tuple[Rectangle, ...] = ()
    yaw: tuple[float, float] | None = None
    line: int = field(default=0, compare=False)

    @property
    def full_name(self) -> str:
        """The name used in facts."""
        return f"{self.target}_{self.name}"


@dataclass(frozen=True)
class BddlProblem:
    """A BDDL problem, with the classes of its objects and fixtures by name; all names are in lower case.

    `initial` contains facts with their values. `remarks` contains the lines of ignored parts, each with a reason.
    """

    name: str
    domain: str
    language: str = ""
    objects: Mapping[str, str] = field(default_factory=dict)
    fixtures: Mapping[str, str] = field(default_factory=dict)
    regions: tuple[Region, ...] = ()
    interest: tuple[str, ...] = ()
    initial: tuple[tuple[BddlFact, bool], ...] = ()
    goal: BddlFormula = TRUE
    remarks: tuple[tuple[int, str], ...] = field(default=(), compare=False)

    @property
    def classes(self) -> Mapping[str, str]:
        """The classes of all objects and fixtures by name."""
        return {**self.fixtures, **self.objects}

    @property
    def region_by_name(self) -> Mapping[str, Region]:
        """The regions by the names that facts use."""
        return {each.full_name: each for each in self.regions}


def facts_of(formula: BddlFormula) -> tuple[BddlFact, ...]:
    """Return the facts in a formula, in order."""
    if isinstance(formula, BddlFact):
        return (formula,)
    parts = formula.parts if isinstance(formula, Connective) else (formula.part,)
    return tuple(fact for part in parts for fact in facts_of(part))
