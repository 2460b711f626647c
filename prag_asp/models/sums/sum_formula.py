"""A formula whose sums are not written as clauses, in parts that share no variable."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from itertools import chain

from prag_asp.logic.formula.clause_builder import Literal
from prag_asp.models.answer_set_formula import ModelFormula
from prag_asp.models.prepared_formula import OpenSum, propagate_units, reduce_sum


@dataclass(frozen=True)
class SumPart:
    """Clauses and sums that are connected by common variables, which are sorted."""

    variables: tuple[int, ...]
    clauses: tuple[tuple[Literal, ...], ...]
    sums: tuple[OpenSum, ...]


@dataclass(frozen=True)
class SumFormula:
    """The parts of a formula, its projection variables, and the number of those that nothing restricts.

    If the formula is `contradictory`, the other fields are meaningless.
    """

    parts: tuple[SumPart, ...]
    projection: frozenset[int]
    free: int
    contradictory: bool = False


def sum_formula(formula: ModelFormula) -> SumFormula:
    """Return the parts of a formula with sums apart, after its units and the bounds of its sums are propagated."""
    clauses: list[tuple[Literal, ...]] | None = list(formula.cnf.clauses)
    fixed: set[Literal] = set()
    sums: tuple[OpenSum, ...] = ()
    implied: set[Literal] = set()
    while clauses is not None:
        new, clauses = propagate_units(chain(clauses, ((literal,) for literal in implied)))
        fixed |= new
        reduced = [reduce_sum(each, fixed) for each in formula.completion.clauses.sums.values()]
        if any(map(_is_violated, reduced)):
            clauses = None
            break
        sums = tuple(replace(each, output=0) if each.missing.value else each for each in reduced)
        sums = tuple(each for each in sums if not each.missing.is_closed)
        implied = set(chain.from_iterable(map(_implied, sums)))
        if not implied:
            break
    if clauses is None or any(-literal in fixed for literal in fixed):
        return SumFormula((), frozenset(), 0, contradictory=True)
    every = range(1, formula.cnf.variables + 1) if formula.whole else formula.cnf.shown
    fixed_variables = set(map(abs, fixed))
    projection = frozenset(variable for variable in every if variable not in fixed_variables)
    parts = tuple(_parts(clauses, sums))
    restricted = set(chain.from_iterable(part.variables for part in parts))
    return SumFormula(parts, projection, len(projection - restricted))


def _is_violated(each: OpenSum) -> bool:
    """Return whether a sum has a value that it cannot have."""
    bound, rest, value = each.missing
    return (value > 0 and bound > rest) or (value < 0 and bound <= 0)


def _implied(each: OpenSum) -> Iterator[Literal]:
    """Yield the literals that an open sum implies."""
    bound, rest, value = each.missing
    if value > 0:
        yield from (literal for literal, weight in each.weights.items() if weight > rest - bound)
    elif value < 0:
        yield from (-literal for literal, weight in each.weights.items() if weight >= bound)
    elif bound <= 0 or bound > rest:
        yield each.output if bound <= 0 else -each.output


def _parts(clauses: Iterable[tuple[Literal, ...]], sums: Iterable[OpenSum]) -> Iterator[SumPart]:
    """Yield the connected parts, by their smallest variables."""
    leader: dict[int, int] = {}

    def find(variable: int) -> int:
        leader.setdefault(variable, variable)
        while leader[variable] != variable:
            leader[variable] = leader[leader[variable]]
            variable = leader[variable]
        return variable

    members = [(each, tuple(map(abs, each))) for each in clauses]
    summed = [(each, each.variables) for each in sums]
    for variables in chain((group for _, group in members), (group for _, group in summed)):
        first = find(variables[0])
        for variable in variables[1:]:
            other = find(variable)
            first, other = min(first, other), max(first, other)
            leader[other] = first
    groups: dict[int, tuple[list[int], list[tuple[Literal, ...]], list[OpenSum]]] = {}
    for variable in sorted(leader):
        groups.setdefault(find(variable), ([], [], []))[0].append(variable)
    for clause, variables in members:
        groups[find(variables[0])][1].append(clause)
    for each, variables in summed:
        groups[find(variables[0])][2].append(each)
    return (SumPart(tuple(one), tuple(two), tuple(three)) for one, two, three in groups.values())
