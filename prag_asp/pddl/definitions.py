"""A domain and a problem of PDDL as plain values: names in lower case, with their lines."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from prag_asp.pddl.formulas import Formula, Literal, Variable

OBJECT = "object"
"""The type above all others."""


@dataclass(frozen=True)
class SchemaEffect:
    """A literal that an action adds (positive) or deletes, for all values of variables where the condition holds."""

    variables: tuple[Variable, ...]
    condition: Formula
    literal: Literal


@dataclass(frozen=True)
class Cost:
    """The cost that an action adds to ``total-cost``: a number, or a function of its parameters."""

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
    """A derived predicate: it holds of the parameters where the formula does."""

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
    """A domain: types with those right above them, typed constants, predicates, derived predicates and actions."""

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
    """A problem of a domain: all objects and constants with their types, the initial literals and the goal.

    `costs` are the values of functions of objects, as text; `object_lines` has no constants.
    """

    name: str
    objects: Mapping[str, str]
    initial: tuple[Literal, ...]
    costs: Mapping[tuple[str, tuple[str, ...]], str]
    goal: Formula
    object_lines: Mapping[str, int]
