"""Comparisons of numbers that no action changes, as literals of static predicates, computed while reading."""

from __future__ import annotations

import operator
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import replace
from fractions import Fraction

from prag_asp.pddl.clingo_names import unused
from prag_asp.pddl.definitions import Declaration, DomainFile, ProblemFile
from prag_asp.pddl.formulas import (
    Comparison,
    Formula,
    FunctionTerm,
    Junction,
    Literal,
    Quantity,
    Variable,
    function_terms,
    replaced,
    variables,
)
from prag_asp.pddl.reading.pddl_source import PddlSource

COMPARE: Mapping[str, Callable[[Fraction, Fraction], bool]] = {
    "<": operator.lt, "<=": operator.le, ">": operator.gt, ">=": operator.ge, "=": operator.eq,
}  # fmt: skip

MOST_ROWS = 10**6
"""The maximum number of rows of values for a comparison; a row takes 1 kB and 10 microseconds."""

Values = Mapping[tuple[str, tuple[str, ...]], Fraction]


def settled(
    source: PddlSource, problem_source: PddlSource, domain: DomainFile, problem: ProblemFile
) -> tuple[DomainFile, ProblemFile]:
    """Return a domain and a problem with all comparisons replaced; none may read a function that an action changes.

    Raises:
        DomainError: a comparison has too many values.
    """
    table = _Comparisons(domain, problem)

    def settle(formula: Formula, at: PddlSource) -> Formula:
        return replaced(formula, lambda part: table.literal(part, at) if isinstance(part, Comparison) else part)

    actions = tuple(
        replace(
            action,
            precondition=settle(action.precondition, source),
            effects=tuple(replace(each, condition=settle(each.condition, source)) for each in action.effects),
        )
        for action in domain.actions
    )
    derived = tuple(replace(each, formula=settle(each.formula, source)) for each in domain.derived)
    goal = settle(problem.goal, problem_source)
    predicates = {**domain.predicates, **table.predicates}
    return (
        replace(domain, actions=actions, derived=derived, predicates=predicates),
        replace(problem, initial=(*problem.initial, *table.facts), goal=goal),
    )


class _Comparisons:
    """The predicates that stand for comparisons, one for each comparison, and their facts."""

    def __init__(self, domain: DomainFile, problem: ProblemFile) -> None:
        self._domain = domain
        self._problem = problem
        self._literals: dict[tuple[str, Quantity, Quantity, bool], Literal] = {}
        self._stated: dict[str, dict[tuple[str, ...], Fraction]] = {}
        for (function, terms), value in problem.values.items():
            self._stated.setdefault(function, {})[terms] = value
        self.predicates: dict[str, Declaration] = {}
        self.facts: list[Literal] = []

    def literal(self, comparison: Comparison, source: PddlSource) -> Formula:
        """Return a comparison as a literal, or as a constant if it has no variables."""
        terms = tuple(variables(comparison))
        rows = self._rows(comparison, source)
        if not terms:
            return Junction(next(rows, None) is not None, (), comparison.line)
        key = (comparison.operator, comparison.left, comparison.right, comparison.positive)
        if key not in self._literals:
            name = unused("compared", {*self._domain.predicates, *self.predicates})
            self.predicates[name] = Declaration(tuple(each.types for each in terms), comparison.line)
            self._literals[key] = Literal(name, terms, True, comparison.line)
            found = ({each: row[each] for each in terms} for row in rows)
            self.facts += (Literal(name, tuple(row.values()), True, 1) for row in found)
        return replace(self._literals[key], line=comparison.line)

    def _rows(self, comparison: Comparison, source: PddlSource) -> Iterator[dict[Variable, str]]:
        """Yield the objects that make a comparison true when assigned to its variables."""
        needed = dict.fromkeys((*function_terms(comparison.left), *function_terms(comparison.right)))
        rows: Iterable[tuple[dict[Variable, str], dict[FunctionTerm, Fraction]]] = [({}, {})]
        for term in needed:
            rows = [*self._joined(rows, term)]
            if len(rows) > MOST_ROWS:
                text = f"this comparison has more than {MOST_ROWS:,} values; compare functions of fewer objects"
                source.refuse(comparison.line, text)
        for objects, values in rows:
            left, right = quantity_value(comparison.left, values), quantity_value(comparison.right, values)
            if left is None or right is None:
                continue
            if COMPARE[comparison.operator](left, right) == comparison.positive:
                yield objects

    def _joined(
        self, rows: Iterable[tuple[dict[Variable, str], dict[FunctionTerm, Fraction]]], term: FunctionTerm
    ) -> Iterator[tuple[dict[Variable, str], dict[FunctionTerm, Fraction]]]:
        """Yield rows extended by each consistent value of another function."""
        above, kinds = self._domain.above, self._problem.objects
        for objects, values in rows:
            for names, value in self._stated.get(term.function, {}).items():
                more = dict(objects)
                for place, name in zip(term.terms, names, strict=True):
                    if isinstance(place, str):
                        if place != name:
                            break
                    elif more.setdefault(place, name) != name or above(kinds[name]).isdisjoint(place.types):
                        break
                else:
                    yield more, {**values, term: value}


def quantity_value(quantity: Quantity, values: Mapping[FunctionTerm, Fraction]) -> Fraction | None:
    """Return the value of a quantity, or None if a function has no value or a divisor is 0."""
    if isinstance(quantity, Fraction):
        return quantity
    if isinstance(quantity, FunctionTerm):
        return values.get(quantity)
    operands = [quantity_value(each, values) for each in quantity.operands]
    numbers = [each for each in operands if each is not None]
    if len(numbers) < len(operands) or (quantity.operator == "/" and numbers[1] == 0):
        return None
    first, *rest = numbers
    if quantity.operator == "-":
        return first - sum(rest) if rest else -first
    if quantity.operator == "+":
        return sum(numbers, Fraction(0))
    for each in rest:
        first = first * each if quantity.operator == "*" else first / each
    return first
