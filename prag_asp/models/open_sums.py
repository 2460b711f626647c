"""Sums of weighted literals, some of them open: the data that a compiler uses instead of the clauses of a sum."""

from __future__ import annotations

from collections.abc import Container, Iterable, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

from prag_asp.logic.formula.clause_builder import Literal, Sum


class Missing(NamedTuple):
    """The missing weight of a sum up to its bound, the weight of its open literals, and its value: 0 while open."""

    bound: int
    rest: int
    value: int

    @property
    def is_closed(self) -> bool:
        """Whether the sum no longer constrains its open literals."""
        return bool(self.value) and (self.bound <= 0 or self.bound > self.rest)


@dataclass(frozen=True)
class OpenSum:
    """A sum whose open literals have different variables; `output` is true if their weights reach a bound."""

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
        """Return the missing weights and the value after one more literal is true."""
        bound, rest, value = missing
        weight = self.weights.get(literal, 0)
        if abs(literal) == self.output:
            value = 1 if literal > 0 else -1
        return Missing(bound - weight, rest - weight - self.weights.get(-literal, 0), value)


def open_sums(sums: Iterable[Sum], fixed: Container[Literal]) -> tuple[OpenSum, ...]:
    """Return the sums whose value or literals are open, given the literals that are true."""
    found: list[OpenSum] = []
    for output, whole_bound, literals, given in sums:
        bound = whole_bound
        weights: dict[Literal, int] = {}
        for literal, weight in zip(literals, given, strict=True):
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
        value = 1 if output in fixed else -1 if -output in fixed else 0
        each = OpenSum(output, weights, Missing(bound, sum(weights.values()), value))
        if not each.missing.is_closed:
            found.append(each)
    return tuple(found)
