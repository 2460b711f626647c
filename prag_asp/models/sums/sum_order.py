"""The order in which a table of partial sums decides variables."""

from __future__ import annotations

from collections.abc import Container, Iterator, Mapping, Sequence
from itertools import accumulate
from math import gcd, log2

from prag_asp.logic.formula.clause_builder import Literal
from prag_asp.models.prepared_formula import OpenSum
from prag_asp.models.sums.sum_formula import SumPart
from prag_asp.models.variable_order import LONG, LONGEST, sweep_order


def table_order(part: SumPart, projection: Container[int]) -> tuple[list[int], float]:
    """Return an order of a part's variables, and the base-2 logarithm of a bound on the states of its table.

    Of several orders, the one with the least bound is returned. Projection variables come first.
    """
    groups = [tuple(sorted(set(map(abs, clause)))) for clause in part.clauses]
    groups += [each.variables for each in part.sums]
    heaviest: dict[int, int] = {}
    for each in part.sums:
        for literal, weight in each.weights.items():
            heaviest[abs(literal)] = max(heaviest.get(abs(literal), 0), weight)
    orders = [sweep_order(groups, LONG), sweep_order(groups, LONGEST)]
    orders.append(sorted(part.variables, key=lambda variable: (-heaviest.get(variable, 0), variable)))
    chosen = [_outputs_late(part, order) for order in orders]
    chosen = [[*(v for v in order if v in projection), *(v for v in order if v not in projection)] for order in chosen]
    bounds = [_bound(part, order) for order in chosen]
    best = min(range(len(bounds)), key=bounds.__getitem__)
    return chosen[best], bounds[best]


def _outputs_late(part: SumPart, order: Sequence[int]) -> list[int]:
    """Return the order with the output of each sum after the last of its literals."""
    place = {variable: float(number) for number, variable in enumerate(order)}
    for each in sorted(part.sums, key=lambda each: max(place[abs(literal)] for literal in each.weights)):
        if each.output:
            last = max(place[abs(literal)] for literal in each.weights)
            place[abs(each.output)] = max(place[abs(each.output)], last + 0.5)
    return sorted(order, key=lambda variable: (place[variable], variable))


def _bound(part: SumPart, order: Sequence[int]) -> float:
    """Return the base-2 logarithm of a bound on the number of states in all levels of a table."""
    place = {variable: number for number, variable in enumerate(order)}
    changes = [0.0] * (len(order) + 1)
    for clause in part.clauses:
        places = [place[abs(literal)] for literal in clause]
        changes[min(places)] += 1
        changes[max(places)] -= 1
    levels = list(accumulate(changes[:-1]))
    alike: dict[frozenset[tuple[Literal, int]], list[OpenSum]] = {}
    for each in part.sums:  # sums with the same weights have the same partial sum
        alike.setdefault(frozenset(each.weights.items()), []).append(each)
    for sums in alike.values():
        for level, number in _open_bounds(sums, place):
            levels[level] += log2(number)
    total = max(levels, default=0.0)
    return total + log2(sum(2.0 ** max(level - total, -100) for level in levels) or 1)


def _open_bounds(sums: Sequence[OpenSum], place: Mapping[int, int]) -> Iterator[tuple[int, int]]:
    """Yield the levels at which sums with the same weights are open, with a bound on the number of their states."""
    weights = sorted((place[abs(literal)], weight) for literal, weight in sums[0].weights.items())
    step = gcd(*sums[0].weights.values())
    end = max(weights[-1][0], *(place[each.output] for each in sums if each.output), 0)
    passed, left, number = 0, sum(weight for _, weight in weights), 0
    for level in range(weights[0][0], end):
        while number < len(weights) and weights[number][0] <= level:
            passed, left, number = passed + weights[number][1], left - weights[number][1], number + 1
        bounds = [each.missing.bound for each in sums]
        different = sum(max(min(bound, left) - max(bound - passed, 0), 0) // step + 2 for bound in bounds)
        undecided = sum(not each.missing.value for each in sums)
        yield level, min(different, 1 << min(number, 64)) << undecided
