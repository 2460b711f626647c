"""The optimum of a program: the best value at each priority, and rules that allow only the optimal answer sets."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import clingo

from prag_asp.errors import DomainError
from prag_asp.logic.ground.rules import Rule
from prag_asp.models.ground_program import GroundModels
from prag_asp.models.program_reader import GivenProgram, places_of_costs
from prag_asp.processes.progress_events import stage

POLL = 0.05
"""The time between two checks for interrupts, in seconds."""

LARGEST = 2**31 - 1
"""The largest sum of weights, because clasp adds the weights of equivalent literals in 32 bits."""


@dataclass(frozen=True)
class Optimum:
    """The best values that answer sets reach, each with its priority, highest priority first.

    Values are minimized, as clingo prints them; the weights of ``#maximize`` are subtracted.
    """

    values: tuple[tuple[int, int], ...]

    def __str__(self) -> str:
        if not self.values:
            return "no atom has a weight to optimise, so that all answer sets are optimal"
        if len(self.values) == 1:
            return f"the best value is {self.values[0][1]}"
        return f"the best values are {', '.join(f'{value} at priority {priority}' for priority, value in self.values)}"


def find_optimum(given: GivenProgram, ground: GroundModels) -> Optimum | None:
    """Return the optimum that clingo proves, or None if there is no answer set.

    Raises:
        DomainError: the weights of a priority add up to more than 32 bits, so clingo computes their sum wrongly.
    """
    for priority, literals in ground.minimized:
        if sum(abs(weight) for _, weight in literals) > LARGEST:
            place = next(places_of_costs(given.program))
            raise DomainError(
                f"{place} the weights of priority {priority} sum to more than {LARGEST}, which clingo does not add "
                "exactly; state smaller weights"
            )
    stage("searching for the optimum")
    grounder = given.grounder("--opt-mode=opt")
    grounder.ground([("base", [])])
    costs: Sequence[int] | None = None

    def evaluate(model: clingo.Model) -> None:
        nonlocal costs
        costs = model.cost

    with grounder.control.solve(async_=True, on_model=evaluate) as handle:
        try:
            while not handle.wait(POLL):
                pass
        finally:
            handle.cancel()
    if costs is None:
        return None
    return Optimum(tuple((priority, value) for (priority, _), value in zip(ground.minimized, costs, strict=True)))


def only_optimal(ground: GroundModels, optimum: Optimum) -> GroundModels:
    """Return a ground program with only the optimal answer sets; add the same constraints to its control."""
    rules = tuple(_optimal_rules(ground, optimum))
    with ground.grounder.control.backend() as backend:
        for rule in rules:
            backend.add_weight_rule([], rule.bound, list(zip(rule.body, rule.weights, strict=True)))
    return replace(ground, rules=(*ground.rules, *rules))


def _optimal_rules(ground: GroundModels, optimum: Optimum) -> Iterator[Rule]:
    """Yield constraints that only the optimal answer sets satisfy.

    An answer set with no value above the optimum is optimal, because the optimum is minimal in the lexicographic order.
    """
    for (_, literals), (_, value) in zip(ground.minimized, optimum.values, strict=True):
        weights: dict[int, int] = {}
        bound = value + 1
        for literal, weight in literals:
            if weight < 0:  # w*x = w + |w|*(1-x)
                bound -= weight
            signed = literal if weight > 0 else -literal
            weights[signed] = weights.get(signed, 0) + abs(weight)
        weights = {literal: weight for literal, weight in weights.items() if weight}
        if bound <= sum(weights.values()):
            yield Rule((), tuple(weights), bound=bound, weights=tuple(weights.values()))
