"""Functions whose values are objects, as predicates whose last argument is the value: each has at most one.

``undefined`` is a value as others are (PDDL 3.1): two functions that have no value are equal. A literal with a function
that has no value is false.
"""

from __future__ import annotations

from dataclasses import dataclass

from prag_asp.pddl.formulas import Formula, Junction, Literal, Quantified, Variable

UNDEFINED = "undefined"


@dataclass(frozen=True)
class Terms:
    """Terms of a formula. The `new` variables stand for functions; the literals of `values` say what these are."""

    terms: tuple[Variable | str, ...]
    new: tuple[Variable, ...]
    values: tuple[Literal, ...]

    def bound(self, formula: Formula) -> Formula:
        """Return a formula for the values of the functions: it is false where one has none."""
        if not self.new:
            return formula
        return Quantified(False, self.new, Junction(True, (*self.values, formula), formula.line), formula.line)


@dataclass(frozen=True)
class AppliedPredicate:
    """A predicate of terms."""

    predicate: str
    terms: Terms
    line: int


@dataclass(frozen=True)
class ObjectFunction:
    """A function of terms with the types of its values, and the predicate that holds for its value."""

    predicate: str
    terms: Terms
    types: tuple[str, ...]
    line: int

    def literal(self, value: Variable | str, *, positive: bool = True) -> Literal:
        """Return that the function has a value."""
        return Literal(self.predicate, (*self.terms.terms, value), positive, self.line)
