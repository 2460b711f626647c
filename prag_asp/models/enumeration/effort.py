"""How long each engine counts before the next one starts, by a rule derived from a hundred diverse programs.

The measurements are in ``benchmarks/model_engines.py``. The rule depends on the predicted time of an
enumeration and on the width of the clauses.
"""

from __future__ import annotations

from enum import Enum
from typing import NamedTuple

from prag_asp.logic.formula.counter import D4, GANAK, Counter
from prag_asp.models.enumeration.bounded_enumeration import Effort
from prag_asp.models.ground_program import GroundModels

FIRST = Effort(models=30_000, conflicts=5_000)
"""The work of the first round, which takes at most about 0.1 s, less than a counter needs to start and to preprocess.
"""

ASSIGNMENTS = 3_000_000
"""The total number of atoms in the models of the first round, because the time for a model grows with the number of its
atoms."""

NARROW = 24
"""The width of a tree decomposition up to which counting by cases is fast for any number of models."""

QUICK = 0.4
"""The predicted time, in seconds, up to which an enumeration begins at once, before clauses are written."""

SOON = 0.7
"""The predicted time, in seconds, up to which an enumeration begins before a diagram is compiled."""

BUSY = 2
"""The factor by which a prediction may be too high because the machine is busy."""

LATER = 4.0
"""The predicted time, in seconds, up to which an enumeration begins before counters, which seldom take that long."""

LAST = 40.0
"""The predicted time, in seconds, above which clingo does not enumerate."""

FEW = 2.0
"""The time, in seconds, of an enumeration if too few models are known for a prediction; there may be no answer set."""


def first_effort(ground: GroundModels) -> Effort:
    """Return the work limit of the first round, which small programs seldom exceed."""
    return Effort(max(min(FIRST.models, ASSIGNMENTS // max(len(ground.names), 1)), 100), FIRST.conflicts)


SLIM = 8
"""The width up to which a diagram takes at most about 2**8 nodes for each variable."""

PATIENCE = 500
"""The number of calls of `look` by the compiler, each after 64 node visits, before a counter joins in; they take about
1 s."""


COMPILATION, LONGER_COMPILATION = 0.5, 1.5
"""The time limits, in seconds, of a compilation that is likely to be short: in general, and if an enumeration takes
longer than `LATER`."""

SWEPT = 32
"""The width up to which the compiler sweeps over a formula faster than clingo enumerates it, unless the enumeration
takes at most `QUICK`."""


SURE_TABLE, LONG_TABLE = 5.0, 20.0
"""The time limits, in seconds, of a table of partial sums: before other engines begin, if the table certainly takes no
longer; and after the turns of the other engines."""

TABLE, HOPELESS_TABLE, HOPELESS = 1.0, 0.2, 1e10
"""The time limits, in seconds, of any other table before other engines begin: `HOPELESS_TABLE` if the bound on the time
of the table is above `HOPELESS`, and `TABLE` otherwise.

Most bounds are far too high.
"""


class OwnEngine(Enum):
    """The engines that run in this process."""

    CLINGO = "clingo"
    DIAGRAM = "the diagram compiler"


class Turn(NamedTuple):
    """An engine, its turn in processor seconds, and the number of calls of `look` after which it runs in parallel.

    With 0 seconds, it runs only in parallel; engines in this process never run in parallel.
    """

    engine: Counter | OwnEngine
    seconds: float
    looks: int = 0


def seconds_of_enumeration(predicted: float) -> float:
    """Return the number of seconds after which the predicted time of an enumeration is evidently wrong."""
    return max(0.8, 3 * predicted)


def seconds_of_table(most: float, predicted: float | None) -> float:
    """Return the time limit of a table before other engines begin, given bounds on its time and an enumeration's."""
    if most <= SURE_TABLE and (predicted is None or predicted > most):
        return SURE_TABLE
    return HOPELESS_TABLE if most > HOPELESS else TABLE if predicted is None or predicted > LATER else TABLE / 4


def turns_of_engines(predicted: float | None, width: int, *, tight: bool, whole: bool, swept: bool) -> tuple[Turn, ...]:
    """Return the turns of engines before a diagram is compiled without a limit.

    `predicted` is the time of an enumeration in seconds, if known. A formula that is `swept` from one end to the
    other suits the diagram compiler.
    """
    counters = _turns_of_counters(width, tight=tight, whole=whole)
    seconds = COMPILATION if predicted is None or predicted <= LATER else LONGER_COMPILATION
    compilation = (Turn(OwnEngine.DIAGRAM, seconds),) if swept and (tight or width > NARROW) else ()
    narrow = width <= NARROW
    if predicted is None and not narrow:
        return (*compilation, Turn(OwnEngine.CLINGO, FEW), *counters, Turn(OwnEngine.CLINGO, 5 * FEW))
    if predicted is None or predicted > (BUSY * SOON if narrow else LAST):
        return (*compilation, *counters)
    enumeration = (Turn(OwnEngine.CLINGO, seconds_of_enumeration(predicted)),)
    if narrow and predicted > SOON:
        shorter = (turn._replace(seconds=min(turn.seconds, predicted)) for turn in counters)
        return (*compilation, *shorter, *enumeration)
    if narrow:
        short = tuple(turn._replace(seconds=predicted / 2) for turn in compilation)
        return (*short, *enumeration, *counters)
    if predicted <= LATER:
        first = (compilation, enumeration) if predicted > SOON or width <= SWEPT else (enumeration, compilation)
        return (*first[0], *first[1], *counters)
    longer = (turn._replace(seconds=max(turn.seconds, predicted / 8)) for turn in counters)
    return (*compilation, *longer, *enumeration)


def _turns_of_counters(width: int, *, tight: bool, whole: bool) -> tuple[Turn, ...]:
    """Return the turns of the counters.

    d4 splits clauses into parts, and counts most narrow formulas immediately; it accepts only formulas without
    projection.
    """
    if not tight:
        return (Turn(GANAK, 0, PATIENCE),)
    if not whole:
        return (Turn(GANAK, 1),)
    if width <= NARROW:
        return (Turn(D4, 0.3 if width <= SLIM else 2), Turn(GANAK, 0, PATIENCE))
    return (Turn(D4, 0.7), Turn(GANAK, 1))
