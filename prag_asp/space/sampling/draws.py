"""What a task space draws: arrays of letters, words with their probability, logarithms of probabilities."""

from __future__ import annotations

from collections.abc import Iterator
from decimal import Context, Decimal, localcontext
from fractions import Fraction
from functools import lru_cache

import numpy as np

from prag_asp.errors import QueryError
from prag_asp.processes.progress_events import stage
from prag_asp.program.entity_names import action_name
from prag_asp.program.facts import Facts
from prag_asp.random_bits import Bits
from prag_asp.space.engines.engine import Draw, Engine, Level
from prag_asp.space.sampling.samplers import OVER, ByWalk, ByWeight, Drawer, Over, OverGoals, OverSkeletons
from prag_asp.space.weights.weights import Weighed, Weights

BATCH = 2048
"""Words that are drawn together."""


def make_drawer(
    engine: Engine, facts: Facts, by: Level, length: int, weights: Weights, over: Over | None = None
) -> Drawer:
    """Return the way to draw words of a level and a length, over skeletons or goals first where `over` says so.

    Raises:
        QueryError: there is nothing to draw, or it cannot be drawn so.
    """
    if over is not None and over not in OVER:
        raise QueryError(f"cannot draw over {over!r}; there are {', '.join(OVER)}")
    if over and by == "skeleton":
        raise QueryError(f"{over} are drawn first for tasks and plans alone; choose task or plan")
    weighed = weighed_words(engine, by, length, weights, goals=over == "goals" and length > 0, plain=over is not None)
    if over == "skeletons":
        names = {str(action): action_name(action) for action in facts.actions}
        numbers = {name: number for number, name in enumerate(sorted(set(names.values())))}
        return OverSkeletons(weighed, length, np.array([numbers[names[letter]] for letter in engine.letters]))
    if over == "goals" and length:
        return OverGoals(weighed, length)
    return ByWalk(weighed.ranking, length) if weighed.ranking else ByWeight(weighed, length)


def weighed_words(
    engine: Engine, by: Level, length: int, weights: Weights, *, goals: bool = False, plain: bool = False
) -> Weighed:
    """Return the words of a level and a length with their weights, as the engine does, if any weighs more than 0.

    Raises:
        QueryError: there is nothing to draw.
    """
    weighed = engine.weighed(length, weights, goals=goals, plain=plain)
    if not weighed.total(length):
        count = engine.count(length)
        why = f": all {count} weigh 0; raise a weight that is 0" if count else ""
        raise QueryError(f"there is no {by} of length {length} to draw{why}")
    return weighed


def drawn_words(drawer: Drawer, engine: Engine, bits: Bits) -> Iterator[Draw]:
    """Yield words with their probability, without end; batches grow, so that the first comes at once."""
    first, size = 0, 1
    stage("drawing")
    while True:
        drawn = drawer.draw(bits, first, size, tell=True)
        for word, probability in zip(drawn.letters.tolist(), drawn.probabilities, strict=True):
            yield Draw(tuple([engine.letters[letter] for letter in word]), probability)
        first, size = first + size, min(2 * size, BATCH)


@lru_cache(maxsize=1 << 16)
def log_probability(probability: Fraction) -> float:
    """Return the natural logarithm, rounded correctly, so that it is the same float on every machine."""
    with localcontext(Context(prec=40, Emax=10**9, Emin=-(10**9))):
        return float((Decimal(probability.numerator) / Decimal(probability.denominator)).ln())
