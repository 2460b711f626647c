"""ApproxMC in a child process, which its native code may abort."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import count
from typing import Any

from prag_asp.errors import EngineError


def answers(messages: Iterator[Any]) -> Iterator[int]:
    """Yield the approximate number of models of each formula.

    A message consists of the number of variables, the shown variables, the clauses, epsilon, delta and the seed.

    Raises:
        EngineError: ApproxMC fails.
    """
    for variables, shown, clauses, epsilon, delta, seed in messages:
        try:
            import pyapproxmc  # noqa: PLC0415

            counter = pyapproxmc.Counter(seed=seed, epsilon=epsilon, delta=delta)
            # The package drops a variable that occurs in no clause, even after unit propagation, and thus loses a
            # factor of 2. A clause by which each shown variable implies a fresh variable outside the projection
            # prevents this, and does not change the count.
            mentioning = ([-variable, fresh] for variable, fresh in zip(shown, count(variables + 1), strict=False))
            counter.add_clauses([*map(list, clauses), *mentioning])
            cells, parities = counter.count(list(shown))
        except Exception as error:
            what = f"{type(error).__name__}: {error}"
            raise EngineError(f"--approximate: ApproxMC failed ({what}); leave it out") from error
        yield int(cells) << int(parities)
