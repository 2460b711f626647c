"""The smallest set of literals that clauses do not allow together."""

from __future__ import annotations

from collections.abc import Sequence

from prag_asp.logic.formula.clauses import Literal
from prag_asp.logic.formula.solver import Solver


def smallest_conflict(solver: Solver, given: Sequence[Literal], literals: Sequence[Literal]) -> list[Literal]:
    """Return a smallest set of `literals` that no model with all literals `given` satisfies; no model satisfies all.

    A set is in conflict if it meets every set of literals that a largest satisfiable one leaves out: the
    smallest that meets all those found is asked again until it is in conflict itself (Ignatiev, Previti, Liffiton and
    Marques-Silva 2015).
    """
    from pysat.examples.hitman import Hitman  # noqa: PLC0415

    chosen: list[Literal] = []
    with Hitman(solver="g4") as hitting:
        while solver.satisfiable([*given, *chosen]):
            left_out = _left_out(solver, given, literals)
            hitting.hit(left_out)
            chosen = sorted(hitting.get(), key=abs)
    return chosen


def _left_out(solver: Solver, given: Sequence[Literal], literals: Sequence[Literal]) -> list[Literal]:
    """Return what a largest satisfiable set around the model found last leaves out."""
    kept, left = _split(solver.model(), literals)
    missing = []
    while left:
        literal = left.pop(0)
        if solver.satisfiable([*given, *kept, literal]):
            kept, left = _split(solver.model(), [*kept, literal, *left])
        else:
            missing.append(literal)
    return missing


def _split(model: Sequence[Literal], literals: Sequence[Literal]) -> tuple[list[Literal], list[Literal]]:
    true = [literal for literal in literals if (model[abs(literal) - 1] > 0) == (literal > 0)]
    return true, [literal for literal in literals if literal not in true]
