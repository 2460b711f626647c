"""Approximate projected model counting with guaranteed bounds.

Random parities over the shown variables divide the models into cells until a cell is small enough to count. The median
over several such divisions is close to the number of models with high probability (Chakraborty, Meel and Vardi 2016).
The counter is ApproxMC (Soos, Gocht and Meel 2020).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from prag_asp.errors import QueryError
from prag_asp.integers import digits_of
from prag_asp.logic.formula.clause_builder import Literal
from prag_asp.logic.formula.cnf import Cnf
from prag_asp.logic.formula.counter import APPROXMC, run_counter

LEAST_EPSILON, MOST_EPSILON = 0.01, 100.0
LEAST_DELTA, MOST_DELTA = 0.0001, 0.9999
LARGEST_SEED = 2**32 - 1
"""The largest seed that ApproxMC accepts."""

OPTION = "--approximate"


@dataclass(frozen=True)
class Tolerance:
    """The guarantee of an estimate: off by at most a factor of 1 + `epsilon`, with probability at least 1 - `delta`.

    Raises:
        QueryError: a number is out of range.
    """

    epsilon: float = 0.8
    delta: float = 0.2

    def __post_init__(self) -> None:
        ranges = {"epsilon": (LEAST_EPSILON, MOST_EPSILON), "delta": (LEAST_DELTA, MOST_DELTA)}
        for name, (least, most) in ranges.items():
            number = getattr(self, name)
            if not least <= number <= most:
                raise QueryError(f"{name} {number:g}: write a number from {least:g} to {most:g}")

    def __str__(self) -> str:
        return f"within a factor of {1 + self.epsilon:.10g} with probability at least {1 - self.delta:.10g}"


@dataclass(frozen=True)
class Estimate:
    """An approximate number, `about`, with its tolerance; it is never treated as exact."""

    about: int
    tolerance: Tolerance

    def __str__(self) -> str:
        return f"about {digits_of(self.about)} ({self.tolerance})"


def estimate_models(
    cnf: Cnf,
    tolerance: Tolerance,
    seed: int = 0,
    assumptions: Sequence[Literal] = (),
    seconds: float | None = None,
) -> Estimate:
    """Return an estimate of the number of assignments of the shown variables that extend to a model.

    Raises:
        QueryError: the seed is out of range.
        EngineError: ApproxMC is missing, cannot accept the formula, or fails.
        LimitReached: ApproxMC has not finished after `seconds`.
    """
    if not 0 <= seed <= LARGEST_SEED:
        raise QueryError(f"seed {seed}: {OPTION} takes one from 0 to {LARGEST_SEED}")
    more = (tolerance.epsilon, tolerance.delta, seed)
    return Estimate(int(run_counter(APPROXMC, cnf, assumptions, seconds, OPTION, *more)), tolerance)
