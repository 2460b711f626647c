"""Ganak in a child process, which its native code may abort."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from prag_asp.errors import EngineError
from prag_asp.logic.formula.solver import Solver


def answers(messages: Iterator[Any]) -> Iterator[int]:
    """Yield the number of models of each formula, given as the number of variables, shown variables and clauses.

    A SAT solver first searches for a model, because without one, Ganak may take seconds even for a dozen variables.

    Raises:
        EngineError: Ganak fails.
    """
    for variables, shown, clauses in messages:
        with Solver(variables, clauses) as solver:
            if not solver.satisfiable():
                yield 0
                continue
        try:
            import pyganak  # noqa: PLC0415

            counter = pyganak.Counter()
            counter.new_vars(variables)
            counter.add_clauses(clauses)
            counter.set_sampling_set(shown)
            counted = int(counter.count())
        except Exception as error:
            what = f"{type(error).__name__}: {error}"
            raise EngineError(f"engine sharp: Ganak failed ({what}); choose another engine") from error
        yield counted
