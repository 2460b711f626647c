"""The contents of a PDDL domain and problem as plain values: names in lower case, with their lines."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction

from prag_asp.pddl.formulas import Formula, FunctionTerm, Literal, Quantity, Variable

OBJECT = "object"
"""The root of the type hierarchy."""


@dataclass(frozen=True)
class SchemaEffect:
    """A literal that an action adds (if positive) or deletes, for all variable values that satisfy the condition."""

    variables: tuple[Variable, ...]
    condition: Formula
    literal: Literal


@dataclass(frozen=True)
class NumericEffect:
    """A change to a function, for all values of the variables that satisfy the condition.

    `operator` is one of ``increase decrease assign scale-up scale-down``.
    """

    variables: tuple[Variable, ...]
    condition: Formula
    operator: str
    function: FunctionTerm
    value: Quantity
    line: int


@dataclass(frozen=True)
class Schema:
    """An action with parameters; `name` is unique, but `given_name`, its name in the file, may be shared by others."""

    name: str
    given_name: str
    parameters: tuple[Variable, ...]
    precondition: Formula
    effects: tuple[SchemaEffect, ...]
    numeric: tuple[NumericEffect, ...]
    line: int


@dataclass(frozen=True)
class Derived:
    """A rule for a derived predicate, which holds for the parameters that satisfy the formula."""

    predicate: str
    parameters: tuple[Variable, ...]
    formula: Formula
    line: int


@dataclass(frozen=True)
class Declaration:
    """The declaration of a predicate or function: the alternative types of each argument."""

    types: tuple[tuple[str, ...], ...]
    line: int


@dataclass(frozen=True)
class DomainFile:
    """A domain: types with their direct supertypes, typed constants, predicates, derived predicates and actions."""

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
        """Return a type and all its supertypes."""
        types, waiting = {kind, OBJECT}, [kind]
        while waiting:
            new = set(self.types[waiting.pop()]) - types
            types |= new
            waiting += new
        return types


@dataclass(frozen=True)
class ProblemFile:
    """A problem for a domain: all objects and constants with their types, the initial literals and the goal.

    `values` are the initial values of functions; `object_lines` excludes constants.
    """

    name: str
    objects: Mapping[str, str]
    initial: tuple[Literal, ...]
    values: Mapping[tuple[str, tuple[str, ...]], Fraction]
    goal: Formula
    object_lines: Mapping[str, int]
