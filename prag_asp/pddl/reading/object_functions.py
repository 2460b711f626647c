"""Functions with objects as values, as predicates whose last argument is the value; at most one atom is true.

``undefined`` is a value like any other (PDDL 3.1), so two functions without a value are equal. A literal that contains
a function without a value is false.
"""

from __future__ import annotations

from dataclasses import dataclass

from prag_asp.pddl.formulas import Formula, Junction, Literal, Quantified, Variable

UNDEFINED = "undefined"


@dataclass(frozen=True)
class Terms:
    """The terms of a formula; `new` variables stand for functions, whose values the literals in `values` define."""

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
        """Return the literal that states that the function has the given value."""
        return Literal(self.predicate, (*self.terms.terms, value), positive, self.line)
