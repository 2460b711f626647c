"""d4 in a child process, which its native code may abort."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from prag_asp.errors import EngineError


def answers(messages: Iterator[Any]) -> Iterator[int]:
    """Yield the number of models of each formula, given as the number of variables, shown variables and clauses.

    Models are counted over all variables, because the package does not support projection.

    Raises:
        EngineError: d4 fails.
    """
    for variables, _, clauses in messages:
        try:
            import py_d4  # noqa: PLC0415

            counted = int(py_d4.Solver([[*clause] for clause in clauses], variables).count().getResult())
        except Exception as error:
            what = f"{type(error).__name__}: {error}"
            raise EngineError(f"engine d4: d4 failed ({what}); choose another engine") from error
        yield counted
