"""PDDL formulas in negation normal form, with their lines."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import TypeAlias


@dataclass(frozen=True)
class Variable:
    """A variable with its clingo name, unique in its action, and its alternative types."""

    name: str
    types: tuple[str, ...]


@dataclass(frozen=True)
class Literal:
    """An atom or its negation; a term is a variable or the name of an object."""

    predicate: str
    terms: tuple[Variable | str, ...]
    positive: bool
    line: int


@dataclass(frozen=True)
class Equality:
    """The equality of two terms, or its negation."""

    left: Variable | str
    right: Variable | str
    positive: bool
    line: int


@dataclass(frozen=True)
class FunctionTerm:
    """A numeric function applied to terms."""

    function: str
    terms: tuple[Variable | str, ...]


@dataclass(frozen=True)
class Arithmetic:
    """An operation (``+ - * /``) on quantities; `-` with a single operand negates the operand."""

    operator: str
    operands: tuple[Quantity, ...]


Quantity: TypeAlias = "Fraction | FunctionTerm | Arithmetic"


@dataclass(frozen=True)
class Comparison:
    """A comparison (``< <= > >= =``) of quantities, or its negation; both are false if a quantity has no value."""

    operator: str
    left: Quantity
    right: Quantity
    positive: bool
    line: int


@dataclass(frozen=True)
class Junction:
    """A conjunction (`every`) or a disjunction; the empty conjunction is true, and the empty disjunction is false."""

    every: bool
    parts: tuple[Formula, ...]
    line: int


@dataclass(frozen=True)
class Quantified:
    """A universally (`every`) or existentially quantified formula."""

    every: bool
    variables: tuple[Variable, ...]
    part: Formula
    line: int


Formula: TypeAlias = "Literal | Equality | Comparison | Junction | Quantified"


def negated(formula: Formula) -> Formula:
    """Return the negation of a formula in negation normal form."""
    if isinstance(formula, Junction):
        return Junction(not formula.every, tuple(map(negated, formula.parts)), formula.line)
    if isinstance(formula, Quantified):
        return Quantified(not formula.every, formula.variables, negated(formula.part), formula.line)
    return replace(formula, positive=not formula.positive)


def conjuncts(formula: Formula) -> Iterator[Formula]:
    """Yield the conjuncts of a formula, with nested conjunctions flattened."""
    if isinstance(formula, Junction) and formula.every:
        for part in formula.parts:
            yield from conjuncts(part)
    else:
        yield formula


def demanded(formula: Formula) -> Iterator[Literal]:
    """Yield the positive literals among the conjuncts of a formula, which the formula requires to be true."""
    return (each for each in conjuncts(formula) if isinstance(each, Literal) and each.positive)


def subformulas(formula: Formula) -> Iterator[Formula]:
    """Yield a formula and all formulas in it, from the outside in."""
    yield formula
    for part in formula.parts if isinstance(formula, Junction) else ():
        yield from subformulas(part)
    if isinstance(formula, Quantified):
        yield from subformulas(formula.part)


def literals(formula: Formula) -> Iterator[Literal]:
    """Yield all literals in a formula."""
    return (each for each in subformulas(formula) if isinstance(each, Literal))


def certainly_unlike(one: Sequence[Variable | str], other: Sequence[Variable | str], condition: Formula) -> bool:
    """Return whether two tuples of terms certainly differ, by a condition or by the names of objects."""
    unequal: list[set[Variable | str]] = [
        {each.left, each.right} for each in conjuncts(condition) if isinstance(each, Equality) and not each.positive
    ]
    return any(
        {left, right} in unequal or (isinstance(left, str) and isinstance(right, str) and left != right)
        for left, right in zip(one, other, strict=True)
    )


def function_terms(quantity: Quantity) -> Iterator[FunctionTerm]:
    """Yield the function terms in a quantity."""
    if isinstance(quantity, FunctionTerm):
        yield quantity
    elif isinstance(quantity, Arithmetic):
        for each in quantity.operands:
            yield from function_terms(each)


def replaced(formula: Formula, change: Callable[[Formula], Formula]) -> Formula:
    """Return a formula in which each literal, equality and comparison has been replaced."""
    if isinstance(formula, Junction):
        return replace(formula, parts=tuple(replaced(each, change) for each in formula.parts))
    if isinstance(formula, Quantified):
        return replace(formula, part=replaced(formula.part, change))
    return change(formula)


def variables(formula: Formula) -> dict[Variable, None]:
    """Return the free variables of a formula, in order of first occurrence."""
    if isinstance(formula, Literal):
        return dict.fromkeys(term for term in formula.terms if isinstance(term, Variable))
    if isinstance(formula, Equality):
        return dict.fromkeys(term for term in (formula.left, formula.right) if isinstance(term, Variable))
    if isinstance(formula, Comparison):
        each_term = (*function_terms(formula.left), *function_terms(formula.right))
        return dict.fromkeys(term for each in each_term for term in each.terms if isinstance(term, Variable))
    if isinstance(formula, Junction):
        return {variable: None for part in formula.parts for variable in variables(part)}
    return {variable: None for variable in variables(formula.part) if variable not in formula.variables}
