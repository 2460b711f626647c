"""Represent functions whose values are objects as predicates with the value as last argument, at most one value each.

``undefined`` is a value like any other (PDDL 3.1): two functions without a value are equal. A literal that contains a
function without a value is false.
"""

from __future__ import annotations

from dataclasses import dataclass

from prag_asp.pddl.formulas import Formula, Junction, Literal, Quantified, Variable

UNDEFINED = "undefined"


@dataclass(frozen=True)
class Terms:
    """Terms of a formula. The `new` variables stand for functions; the literals in `values` define their values."""

    terms: tuple[Variable | str, ...]
    new: tuple[Variable, ...]
    values: tuple[Literal, ...]

    def bound(self, formula: Formula) -> Formula:
        """Bind the functions in a formula to their values; the result is false if a function has no value."""
        if not self.new:
            return formula
        return Quantified(False, self.new, Junction(True, (*self.values, formula), formula.line), formula.line)


@dataclass(frozen=True)
class AppliedPredicate:
    """A predicate applied to terms."""

    predicate: str
    terms: Terms
    line: int


@dataclass(frozen=True)
class ObjectFunction:
    """A function applied to terms, the types of its values, and the predicate that holds for its value."""

    predicate: str
    terms: Terms
    types: tuple[str, ...]
    line: int

    def literal(self, value: Variable | str, *, positive: bool = True) -> Literal:
        """Return the literal which states that the function has a value."""
        return Literal(self.predicate, (*self.terms.terms, value), positive, self.line)
