"""About how many models a formula has, with bounds that hold with a probability that is told, and no exact number.

Random parities over the shown variables cut the models into cells, until one is small enough to be counted; the median
over several such cuts is near to the number of models as a rule (Chakraborty, Meel and Vardi 2016; the program is
ApproxMC, of Soos, Gocht and Meel 2020).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from prag_asp.errors import QueryError
from prag_asp.integers import digits_of
from prag_asp.logic.formula.clause_builder import Literal
from prag_asp.logic.formula.cnf import Cnf
from prag_asp.logic.formula.counter import APPROXMC, counted

LEAST_EPSILON, MOST_EPSILON = 0.01, 100.0
LEAST_DELTA, MOST_DELTA = 0.0001, 0.9999
LARGEST_SEED = 2**32 - 1
"""What ApproxMC has a seed below or equal to."""

ASKED = "--approximate"


@dataclass(frozen=True)
class Tolerance:
    """With probability 1 - `delta` at least, an estimate is off by no more than a factor of 1 + `epsilon`.

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
        return f"within a factor {1 + self.epsilon:.10g} with probability at least {1 - self.delta:.10g}"


@dataclass(frozen=True)
class Estimate:
    """A number that is about right, never an exact one: `about`, and how near to it the right one is."""

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
    """Return about how many assignments of the shown variables a model with the literals assumed has.

    Raises:
        QueryError: the seed is out of range.
        EngineError: ApproxMC is missing, cannot take the formula, or fails.
        LimitReached: it has not finished after `seconds`.
    """
    if not 0 <= seed <= LARGEST_SEED:
        raise QueryError(f"seed {seed}: {ASKED} takes one from 0 to {LARGEST_SEED}")
    told = (tolerance.epsilon, tolerance.delta, seed)
    return Estimate(int(counted(APPROXMC, cnf, assumptions, seconds, ASKED, *told)), tolerance)
