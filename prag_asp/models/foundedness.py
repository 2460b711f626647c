"""The search for one or all models of a completion that are answer sets, with a SAT solver and loop formulas.

If a model of the completion has an unfounded set, the loop formula of this set, which all answer sets satisfy, is added
to the solver, and the search is repeated (Lin and Zhao 2004).
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import closing

from prag_asp.logic.formula.clark_completion import Completion, body_literal
from prag_asp.logic.formula.clause_builder import TRUE, Literal
from prag_asp.logic.formula.solver import Solver
from prag_asp.logic.ground.rules import Rule
from prag_asp.models.answer_set_formula import ModelFormula

Loop = Mapping[int, tuple[Rule, ...]]


class FoundednessOracle:
    """A search for answer sets under assumptions, which keeps its loop formulas between calls."""

    def __init__(self, completion: Completion) -> None:
        self._completion = completion
        self._clauses = completion.clauses
        self._sent = len(self._clauses.clauses)
        self._solver = Solver(self._clauses.variables, self._clauses.clauses)

    def close(self) -> None:
        """Free the memory of the solver."""
        self._solver.close()

    def model(self, assumptions: Sequence[Literal] = ()) -> list[Literal] | None:
        """Return an answer set under the assumptions, as a model of the completion, or None if there is none.

        The literal of variable v is at index v - 1.
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

        def supports(rule: Rule) -> bool:
            """Return whether the body is true without the atoms in `left`."""
            if not rule.weights:
                return all(literal not in left and true(literal) for literal in rule.body)
            pairs = zip(rule.body, rule.weights, strict=True)
            return sum(weight for literal, weight in pairs if literal not in left and true(literal)) >= rule.bound

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
            if atom in left and any(map(supports, loop[atom])):
                left.discard(atom)
                waiting += [reader for reader in readers.get(atom, ()) if reader in left]
        return left

    def _forbid(self, loop: Loop, atoms: set[int]) -> None:
        """Add the loop formula of a set: if one of its atoms is true, some rule supports the set from outside."""

        def outside(literal: int) -> Literal:
            return -TRUE if literal in atoms else self._completion.value(literal)

        support = {body_literal(self._clauses, rule, outside) for atom in sorted(atoms) for rule in loop[atom]}
        for atom in sorted(atoms):
            self._clauses.add(-self._completion.value(atom), *sorted(support))
        for clause in self._clauses.clauses[self._sent :]:
            self._solver.add(clause)
        self._sent = len(self._clauses.clauses)


def list_models(formula: ModelFormula, order: Sequence[Literal]) -> Iterator[list[Literal]]:
    """Yield the combinations of values that the literals in `order` have in models, each once, true before false.

    For each literal of a model, one solver call decides whether another model differs first at this literal.
    """
    # Keep only one of a literal and its negation, because a symbol may be shown if and only if another is not.
    first = {abs(literal): literal for literal in reversed(order) if abs(literal) != TRUE}
    order = [literal for literal in dict.fromkeys(order) if first.get(abs(literal)) == literal]
    with closing(FoundednessOracle(formula.completion)) as oracle:
        model = oracle.model()
        if model is None:
            return
        chosen: list[Literal] = []
        while True:
            while len(chosen) < len(order):  # find the first model with this prefix
                literal = order[len(chosen)]
                if (model[abs(literal) - 1] > 0) != (literal > 0):
                    model = oracle.model([*chosen, literal]) or model
                true = (model[abs(literal) - 1] > 0) == (literal > 0)
                chosen.append(literal if true else -literal)
            yield [*chosen]
            following = None
            while chosen and following is None:
                literal = chosen.pop()
                if literal == order[len(chosen)]:
                    following = oracle.model([*chosen, -literal])
                    if following is not None:
                        chosen.append(-literal)
            if following is None:
                return
            model = following
