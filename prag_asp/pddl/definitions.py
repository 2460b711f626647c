"""What a domain and a problem of PDDL state, as plain values: names in small letters, lines kept."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from prag_asp.pddl.formulas import Formula, Literal, Variable

OBJECT = "object"
"""The type above all others."""


@dataclass(frozen=True)
class SchemaEffect:
    """What an action adds (a positive literal) or deletes, for all values of variables where a condition holds."""

    variables: tuple[Variable, ...]
    condition: Formula
    literal: Literal


@dataclass(frozen=True)
class Cost:
    """What an action adds to ``total-cost``: a number, or a function of its parameters."""

    value: str | tuple[str, tuple[Variable | str, ...]]
    line: int


@dataclass(frozen=True)
class Schema:
    """An action with parameters."""

    name: str
    parameters: tuple[Variable, ...]
    precondition: Formula
    effects: tuple[SchemaEffect, ...]
    costs: tuple[Cost, ...]
    line: int


@dataclass(frozen=True)
class Derived:
    """A rule: the predicate holds of the variables where the formula does."""

    predicate: str
    parameters: tuple[Variable, ...]
    formula: Formula
    line: int


@dataclass(frozen=True)
class Declaration:
    """A declared predicate or function: the types of each argument."""

    types: tuple[tuple[str, ...], ...]
    line: int


@dataclass(frozen=True)
class DomainFile:
    """A domain: types with those right above them, constants with their types, predicates, rules and actions."""

    name: str
    types: Mapping[str, tuple[str, ...]]
    constants: Mapping[str, str]
    predicates: Mapping[str, Declaration]
    functions: Mapping[str, Declaration]
    derived: tuple[Derived, ...]
    actions: tuple[Schema, ...]
    type_lines: Mapping[str, int]
    constant_lines: Mapping[str, int]

    def above(self, kind: str) -> set[str]:
        """Return a type and all types above it."""
        found, waiting = {kind, OBJECT}, [kind]
        while waiting:
            new = set(self.types[waiting.pop()]) - found
            found |= new
            waiting += new
        return found


@dataclass(frozen=True)
class ProblemFile:
    """A problem of a domain: all objects with their types, constants among them, what is true at first, the goal.

    `costs` are the values of functions of objects, as they are written; `object_lines` has no constants.
    """

    name: str
    objects: Mapping[str, str]
    initial: tuple[Literal, ...]
    costs: Mapping[tuple[str, tuple[str, ...]], str]
    goal: Formula
    object_lines: Mapping[str, int]
