"""Ganak for many questions of a test: to start a process for each takes a hundred times as long as to count.

What the process does, and what it is given, is as ever.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager

import pytest

from prag_asp.logic.formula.clause_builder import Literal
from prag_asp.logic.formula.cnf import Cnf
from prag_asp.logic.formula.counter import GANAK
from prag_asp.processes.workers import WorkerGroup

CountModels = Callable[..., int]


@contextmanager
def one_process() -> Iterator[CountModels]:
    """Yield a function that counts models as that of the library does, by one process for all questions."""
    with WorkerGroup(GANAK.module) as children:
        ganak = children.start()

        def count_models(cnf: Cnf, assumptions: Sequence[Literal] = (), seconds: float | None = None) -> int:
            ganak.send((cnf.variables, cnf.shown, [*cnf.clauses, *((literal,) for literal in assumptions)]))
            return int(ganak.receive(seconds))

        yield count_models


@contextmanager
def counting_by(count_models: CountModels) -> Iterator[None]:
    """Have the engine sharp count by a function."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("prag_asp.space.engines.sharp_engine.count_models", count_models)
        yield
