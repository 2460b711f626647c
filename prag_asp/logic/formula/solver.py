"""A SAT solver that can be interrupted by Ctrl-C and frees its memory."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from types import TracebackType
from typing import Any

from prag_asp.logic.formula.clause_builder import Literal

CONFLICTS = 2000
"""The number of conflicts between two checks for signals; they take a few milliseconds."""


class Solver:
    """An incremental solver for clauses under assumptions (Glucose 4.1 from python-sat)."""

    def __init__(self, variables: int, clauses: Iterable[Sequence[Literal]]) -> None:
        from pysat.solvers import Glucose4  # noqa: PLC0415

        self._solver: Any = Glucose4()
        self._solver.add_clause([-variables, variables])  # a model has all variables, even unused ones
        for clause in clauses:
            self._solver.add_clause(clause)

    def __enter__(self) -> Solver:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, at: TracebackType | None) -> None:
        self.close()

    def close(self) -> None:
        """Free the memory of the solver, which cannot be used afterwards."""
        self._solver.delete()

    def add(self, clause: Sequence[Literal]) -> None:
        """Add a clause for all later queries."""
        self._solver.add_clause(clause)

    def satisfiable(self, assumptions: Sequence[Literal] = ()) -> bool:
        """Return whether some model satisfies the assumptions."""
        while True:
            self._solver.conf_budget(CONFLICTS)
            # With this flag, python-sat does not handle signals; Python handles them between two calls.
            answer = self._solver.solve_limited(assumptions=list(assumptions), expect_interrupt=True)
            if answer is not None:
                return bool(answer)

    def propagated(self, assumptions: Sequence[Literal]) -> list[Literal] | None:
        """Return the assumptions and the literals that unit propagation derives, or None if it derives a conflict.

        The result depends only on the clauses and the assumptions until `satisfiable` is first called, because no
        clause is learned before that call.
        """
        consistent, implied = self._solver.propagate(assumptions=list(assumptions))
        return list(implied) if consistent else None

    def model(self) -> list[Literal]:
        """Return the latest model: the literal of variable v is at index v - 1."""
        model: list[Literal] = self._solver.get_model()
        return model

    def core(self) -> list[Literal]:
        """Return assumptions of the latest query that together contradict the clauses; the set need not be minimal."""
        return list(self._solver.get_core() or ())


def smallest_conflict(solver: Solver, assumed: Sequence[Literal], literals: Sequence[Literal]) -> list[Literal]:
    """Return a smallest subset of `literals` that contradicts `assumed`; all `literals` together must contradict it.

    A set is in conflict if it hits the complement of every maximal satisfiable set. The smallest hitting set of the
    complements found so far is tested until it is itself in conflict (Ignatiev, Previti, Liffiton and Marques-Silva
    2015).
    """
    from pysat.examples.hitman import Hitman  # noqa: PLC0415

    chosen: list[Literal] = []
    with Hitman(solver="g4") as hitting:
        while solver.satisfiable([*assumed, *chosen]):
            # A maximal satisfiable set contains the true literals of the model.
            satisfied, violated = _split(solver.model(), literals)
            complement = []
            while violated:
                literal = violated.pop(0)
                if solver.satisfiable([*assumed, *satisfied, literal]):
                    satisfied, violated = _split(solver.model(), [*satisfied, literal, *violated])
                else:
                    complement.append(literal)
            hitting.hit(complement)
            chosen = sorted(hitting.get(), key=abs)
    return chosen


def _split(model: Sequence[Literal], literals: Sequence[Literal]) -> tuple[list[Literal], list[Literal]]:
    true = [literal for literal in literals if (model[abs(literal) - 1] > 0) == (literal > 0)]
    return true, [literal for literal in literals if literal not in true]
