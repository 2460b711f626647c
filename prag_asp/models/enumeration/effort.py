"""The time that each engine counts before the next one: a rule derived from measurements of eighty diverse programs.

The measurements are in ``benchmarks/model_engines.py``. The rule reads the size of the program, the depth of random
searches and the width of the clauses, so that it does not depend on the machine.
"""

from __future__ import annotations

from typing import NamedTuple

from prag_asp.logic.formula.counter import D4, GANAK, Counter
from prag_asp.models.enumeration.bounded_enumeration import Effort
from prag_asp.models.ground_program import GroundModels

FIRST = Effort(models=30_000, conflicts=5_000)
"""The work of the first round: at most about 0.1 s, less than a counter needs to start and to preprocess."""

ASSIGNMENTS = 3_000_000
"""The total number of atoms in the models of the first round, because the time for a model grows with its atoms."""

SECOND = Effort(models=4_000_000, conflicts=400_000)
"""The work of the second round: ten to twenty seconds."""

NARROW = 24
"""The width of a tree decomposition up to which counting by cases is fast for any number of models."""

DEEPEST = 21.0
"""The depth of random searches beyond which enumeration is too slow: about 2**21 models."""


def first_effort(ground: GroundModels) -> Effort:
    """Return the work limit of the first round, which small programs seldom exceed."""
    return Effort(max(min(FIRST.models, ASSIGNMENTS // max(len(ground.names), 1)), 100), FIRST.conflicts)


def is_worth_enumerating(depth: float, width: int) -> bool:
    """Return whether clingo is likely to list all answer sets before a counter counts them."""
    return width > NARROW and depth <= DEEPEST


SLIM = 8
"""The width up to which a diagram takes at most about 2**8 nodes for each variable."""

PATIENCE = 500
"""The number of calls of `look` by the compiler, each after 64 node visits, before a counter joins: about 1 s."""


class Turn(NamedTuple):
    """A counter, the processor seconds of its turn, and the number of compiler looks after which it runs in parallel.

    Without seconds, it only runs in parallel.
    """

    counter: Counter
    seconds: float
    looks: int = 0


def turns_of_counters(width: int, *, tight: bool, whole: bool) -> tuple[Turn, ...]:
    """Return the turns of counters before and during the compilation of a diagram.

    d4 splits clauses into parts, and counts most narrow formulas immediately; it only accepts formulas without
    projection.
    """
    if not tight:
        return (Turn(GANAK, 0, PATIENCE),)
    if not whole:
        return (Turn(GANAK, 1),)
    if width <= NARROW:
        return (Turn(D4, 0.3 if width <= SLIM else 2), Turn(GANAK, 0, PATIENCE))
    return (Turn(D4, 0.5), Turn(GANAK, 1))
