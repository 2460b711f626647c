"""Search for models of a completion that are answer sets, by a SAT solver that learns why atoms are unfounded.

The solver is asked for a model of the completion. Where some of its atoms support each other and nothing else does,
the formula of that set, which all answer sets satisfy, is added, and the solver is asked again (Lin and Zhao 2004).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

from prag_asp.logic.formula.clark_completion import Completion, body_literal
from prag_asp.logic.formula.clause_builder import TRUE, Literal
from prag_asp.logic.formula.solver import Solver
from prag_asp.logic.ground.rules import Rule

Loop = Mapping[int, tuple[Rule, ...]]


class FoundednessOracle:
    """Finds answer sets under assumptions, and keeps what it learns on the way."""

    def __init__(self, completion: Completion) -> None:
        self._completion = completion
        self._clauses = completion.clauses
        self._sent = len(self._clauses.clauses)
        self._solver = Solver(self._clauses.variables, self._clauses.clauses)

    def close(self) -> None:
        """Free the memory of the solver."""
        self._solver.close()

    def model(self, assumptions: Sequence[Literal] = ()) -> list[Literal] | None:
        """Return a model with the literals assumed that is an answer set, None where there is none.

        The literal of variable v is at place v - 1.
        """
        while self._solver.satisfiable(assumptions):
            found = self._solver.model()
            unfounded = [(loop, atoms) for loop in self._completion.loops if (atoms := self._unfounded(loop, found))]
            if not unfounded:
                return found
            for loop, atoms in unfounded:
                self._forbid(loop, atoms)
        return None

    def _unfounded(self, loop: Loop, model: Sequence[Literal]) -> set[int]:
        """Return the true atoms of a component that no rules derive from atoms outside of it."""

        def true(literal: int) -> bool:
            found = self._completion.value(literal)
            return (model[abs(found) - 1] > 0) == (found > 0)

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
                waiting += [each for each in readers.get(atom, ()) if each in left]
        return left

    def _forbid(self, loop: Loop, atoms: set[int]) -> None:
        """State that a set of atoms has support from outside of it where one of them is true."""

        def outside(literal: int) -> Literal:
            return -TRUE if literal in atoms else self._completion.value(literal)

        support = {body_literal(self._clauses, rule, outside) for atom in sorted(atoms) for rule in loop[atom]}
        for atom in sorted(atoms):
            self._clauses.add(-self._completion.value(atom), *sorted(support))
        for clause in self._clauses.clauses[self._sent :]:
            self._solver.add(clause)
        self._sent = len(self._clauses.clauses)


def _holds(rule: Rule, unfounded: set[int], true: Callable[[int], bool]) -> bool:
    """Return whether the body of a rule is true without atoms that are not derived."""
    if not rule.weights:
        return all(literal not in unfounded and true(literal) for literal in rule.body)
    held = (
        weight
        for literal, weight in zip(rule.body, rule.weights, strict=True)
        if literal not in unfounded and true(literal)
    )
    return sum(held) >= rule.bound
