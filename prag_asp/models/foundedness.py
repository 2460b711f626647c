"""Search for models of a completion that are answer sets, by a SAT solver with loop formulas.

If a model of the completion has an unfounded set, the loop formula of this set, which all answer sets satisfy, is added
to the solver, and the search is repeated (Lin and Zhao 2004).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

from prag_asp.logic.formula.clark_completion import Completion, body_literal
from prag_asp.logic.formula.clause_builder import TRUE, Literal
from prag_asp.logic.formula.solver import Solver
from prag_asp.logic.ground.rules import Rule

Loop = Mapping[int, tuple[Rule, ...]]


class FoundednessOracle:
    """A search for answer sets under assumptions that keeps its loop formulas."""

    def __init__(self, completion: Completion) -> None:
        self._completion = completion
        self._clauses = completion.clauses
        self._sent = len(self._clauses.clauses)
        self._solver = Solver(self._clauses.variables, self._clauses.clauses)

    def close(self) -> None:
        """Free the memory of the solver."""
        self._solver.close()

    def model(self, assumptions: Sequence[Literal] = ()) -> list[Literal] | None:
        """Return an answer set that satisfies the assumptions as a model, or None if there is none.

        The literal of variable v is at place v - 1.
        """
        while self._solver.satisfiable(assumptions):
            model = self._solver.model()
            unfounded = [(loop, atoms) for loop in self._completion.loops if (atoms := self._unfounded(loop, model))]
            if not unfounded:
                return model
            for loop, atoms in unfounded:
                self._forbid(loop, atoms)
        return None

    def _unfounded(self, loop: Loop, model: Sequence[Literal]) -> set[int]:
        """Return the unfounded true atoms of a component."""

        def true(literal: int) -> bool:
            value = self._completion.value(literal)
            return (model[abs(value) - 1] > 0) == (value > 0)

        left = {atom for atom in loop if true(atom)}
        readers: dict[int, list[int]] = {}
        for atom in left:
            for rule in loop[atom]:
                for literal in rule.body:
                    if literal in left:
                        readers.setdefault(literal, []).append(atom)
        waiting = sorted(left)
        while waiting:
            atom = waiting.pop()
            if atom in left and any(_holds(rule, left, true) for rule in loop[atom]):
                left.discard(atom)
                waiting += [reader for reader in readers.get(atom, ()) if reader in left]
        return left

    def _forbid(self, loop: Loop, atoms: set[int]) -> None:
        """Add the loop formula of a set: if one of its atoms is true, a rule supports the set from outside."""

        def outside(literal: int) -> Literal:
            return -TRUE if literal in atoms else self._completion.value(literal)

        support = {body_literal(self._clauses, rule, outside) for atom in sorted(atoms) for rule in loop[atom]}
        for atom in sorted(atoms):
            self._clauses.add(-self._completion.value(atom), *sorted(support))
        for clause in self._clauses.clauses[self._sent :]:
            self._solver.add(clause)
        self._sent = len(self._clauses.clauses)


def _holds(rule: Rule, unfounded: set[int], true: Callable[[int], bool]) -> bool:
    """Return whether the body of a rule is true without unfounded atoms."""
    if not rule.weights:
        return all(literal not in unfounded and true(literal) for literal in rule.body)
    true_weights = (
        weight
        for literal, weight in zip(rule.body, rule.weights, strict=True)
        if literal not in unfounded and true(literal)
    )
    return sum(true_weights) >= rule.bound
