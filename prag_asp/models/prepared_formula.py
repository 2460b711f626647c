"""Formulas prepared for compilation: units propagated, sums kept open, and variables numbered in decision order."""

from __future__ import annotations

from collections.abc import Container, Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

from prag_asp.logic.formula.clause_builder import TRUE, Literal, Sum
from prag_asp.models.answer_set_formula import ModelFormula
from prag_asp.models.variable_order import DecisionOrder, decision_order


class Missing(NamedTuple):
    """The weight that a sum lacks to reach its bound, the weight of its open literals, and its value (0 while open)."""

    bound: int
    rest: int
    value: int

    @property
    def is_closed(self) -> bool:
        """Whether the sum no longer constrains its open literals."""
        return bool(self.value) and (self.bound <= 0 or self.bound > self.rest)


@dataclass(frozen=True)
class OpenSum:
    """A sum of weighted literals over different variables; `output` is true if the sum reaches its bound."""

    output: Literal
    weights: Mapping[Literal, int]
    missing: Missing

    @cached_property
    def variables(self) -> tuple[int, ...]:
        """The open variables, sorted."""
        output = () if self.missing.value else (abs(self.output),)
        return tuple(sorted((*map(abs, self.weights), *output)))

    def renamed(self, number: Mapping[int, int]) -> OpenSum:
        """Return the sum with renumbered variables; a fixed output becomes 0."""
        weights = {
            number[abs(literal)] * (1 if literal > 0 else -1): weight for literal, weight in self.weights.items()
        }
        return OpenSum(0 if self.missing.value else number[self.output], weights, self.missing)

    def after(self, missing: Missing, literal: Literal) -> Missing:
        """Return the missing weight, the open weight and the value after one more literal has become true."""
        bound, rest, value = missing
        weight = self.weights.get(literal, 0)
        if abs(literal) == self.output:
            value = 1 if literal > 0 else -1
        return Missing(bound - weight, rest - weight - self.weights.get(-literal, 0), value)


@dataclass(frozen=True)
class PreparedFormula:
    """A formula before compilation: units are propagated, and variables numbered in decision order.

    The clauses `nodes` define the `sums`; their further variables have the last numbers, and are not decided. `names`
    holds the variable for each number, from 1; `projection` holds the numbers of decision variables, and `kept` holds
    the names of the variables whose values the diagram contains. `copies` holds the atom of each copy, or 0 if the atom
    is fixed and None for a gate over copies. All models contain the literals `fixed`; no clause or sum restricts the
    variables `free`. If the formula is `contradictory`, the other fields are meaningless.
    """

    clauses: tuple[tuple[Literal, ...], ...]
    nodes: tuple[tuple[Literal, ...], ...]
    sums: tuple[OpenSum, ...]
    names: tuple[int, ...]
    fixed: tuple[Literal, ...]
    free: tuple[int, ...]
    projection: frozenset[int]
    kept: frozenset[int]
    copies: Mapping[int, int | None]
    order: DecisionOrder
    contradictory: bool

    @property
    def cost(self) -> str:
        """The size of the formula as text: the numbers of clauses, sums and variables, and the width."""
        numbers = {"clause": len(self.clauses), "sum": len(self.sums), "variable": len(self.order.variables)}
        clauses, sums, variables = (
            f"{number:,} {what}{'' if number == 1 else 's'}" for what, number in numbers.items()
        )
        return f"{clauses}{f' and {sums}' if self.sums else ''} over {variables}, width {self.order.width}"


def prepare_formula(formula: ModelFormula, kept: Iterable[int]) -> PreparedFormula:
    """Return a formula prepared for a diagram that contains the values of the variables `kept`."""
    cnf, copies = formula.cnf, formula.completion.copies
    fixed, propagated = propagate_units(cnf.clauses)
    hidden = set() if copies else formula.completion.clauses.nodes
    sums = () if copies else open_sums(formula.completion.clauses.sums.values(), fixed)
    clauses = [clause for clause in propagated or () if hidden.isdisjoint(map(abs, clause))]
    nodes = [clause for clause in propagated or () if not hidden.isdisjoint(map(abs, clause))]
    order = decision_order(clauses, [each.variables for each in sums], looped=bool(copies))
    further = sorted({abs(literal) for clause in nodes for literal in clause}.difference(order.variables))
    number = {variable: place for place, variable in enumerate((*order.variables, *further), 1)}

    def numbered(clause: Sequence[Literal]) -> tuple[Literal, ...]:
        return tuple(number[abs(literal)] * (1 if literal > 0 else -1) for literal in clause)

    variables = range(1, cnf.variables + 1) if formula.whole else cnf.shown
    projection = [variable for variable in variables if variable not in copies and variable not in hidden]
    decided = {*order.variables, *map(abs, fixed)}
    return PreparedFormula(
        tuple(map(numbered, clauses)),
        tuple(map(numbered, nodes)),
        tuple(each.renamed(number) for each in sums),
        (0, *order.variables, *further),
        tuple(sorted(fixed, key=abs)),
        tuple(variable for variable in projection if variable not in decided),
        frozenset(number[variable] for variable in projection if variable in number),
        frozenset(kept),
        {
            number[variable]: None if literal == TRUE else number.get(abs(literal), 0)
            for variable, literal in copies.items()
            if variable in number
        },
        order,
        contradictory=propagated is None,
    )


def propagate_units(
    clauses: Iterable[Sequence[Literal]],
) -> tuple[set[Literal], list[tuple[Literal, ...]] | None]:
    """Return the literals that unit propagation derives, and the remaining clauses.

    The second item is None if propagation derives a contradiction.
    """
    distinct = list(dict.fromkeys(tuple(dict.fromkeys(clause)) for clause in clauses))
    against: dict[Literal, list[int]] = {}
    for place, clause in enumerate(distinct):
        for literal in clause:
            against.setdefault(-literal, []).append(place)
    left = list(map(len, distinct))
    waiting = [clause[0] for clause in distinct if len(clause) == 1]
    fixed: set[Literal] = set()
    for literal in waiting:  # grows during the iteration
        if -literal in fixed:
            return fixed, None
        if literal in fixed:
            continue
        fixed.add(literal)
        for place in against.get(literal, ()):
            left[place] -= 1
            if left[place] == 0:
                return fixed, None
            if left[place] == 1:
                waiting += [each for each in distinct[place] if -each not in fixed]
    unsatisfied = (clause for clause in distinct if fixed.isdisjoint(clause))
    reduced = (tuple(literal for literal in clause if -literal not in fixed) for clause in unsatisfied)
    return fixed, list(dict.fromkeys(reduced))


def open_sums(sums: Iterable[Sum], fixed: Container[Literal]) -> tuple[OpenSum, ...]:
    """Return the sums whose value or literals are open, given the literals that are true."""
    reduced = (reduce_sum(each, fixed) for each in sums)
    return tuple(each for each in reduced if not each.missing.is_closed)


def reduce_sum(given: Sum, fixed: Container[Literal]) -> OpenSum:
    """Return a sum over the literals that are open, given those that are true."""
    bound = given.bound
    weights: dict[Literal, int] = {}
    for literal, weight in zip(given.literals, given.weights, strict=True):
        if literal in fixed:
            bound -= weight
        elif -literal not in fixed:
            weights[literal] = weights.get(literal, 0) + weight
    for literal in [each for each in weights if each > 0 and -each in weights]:
        least = min(weights[literal], weights[-literal])  # one of the two is true
        bound -= least
        weights[literal] -= least
        weights[-literal] -= least
    weights = {literal: weight for literal, weight in weights.items() if weight}
    value = 1 if given.output in fixed else -1 if -given.output in fixed else 0
    return OpenSum(given.output, weights, Missing(bound, sum(weights.values()), value))
