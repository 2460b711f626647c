"""Edit distances with costs given by the user, which are checked against the axioms of a metric."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from fractions import Fraction

import numpy as np

from prag_asp.atom import Atom
from prag_asp.errors import QueryError
from prag_asp.similarity import features
from prag_asp.similarity.background import Background
from prag_asp.similarity.edit_costs import CostTable
from prag_asp.similarity.measures import EditMeasure
from prag_asp.similarity.metrics import Metric
from prag_asp.similarity.symbols import renamer

ActionCost = Callable[[Atom | None, Atom | None], Fraction | int]
"""The cost of replacing one action with another; None in place of an action stands for an insertion or a deletion."""


def metric_with_costs(cost: ActionCost, actions: Iterable[Atom], background: Background | None = None) -> Metric:
    """Return the edit distance between tasks over the given actions, with the given costs.

    If the costs are not a metric, the result is a dissimilarity: `axioms` is False, and `summary` says why.
    `background` specifies which entities are interchangeable; the costs must not distinguish them.

    Raises:
        QueryError: the costs distinguish interchangeable entities, or their common denominator is too large.
    """
    known = Background() if background is None else background
    symbols = list(dict.fromkeys(actions))
    table = CostTable.of(symbols, lambda one, other: Fraction(cost(one, other)))
    seen: set[str] = set()
    for entity in (each for each in sorted(known.interchange.entities) if each not in seen):
        orbit = known.interchange.orbit(entity)
        seen |= {*orbit}
        for names in (each for each in orbit.values() if each):  # together these generate all renamings
            moved = [renamer(names)(symbol) for symbol in symbols]
            other = CostTable.of(moved, lambda one, other: Fraction(cost(one, other)))
            wrong = np.argwhere(other.costs * table.denominator != table.costs * other.denominator)
            if len(wrong):
                one, two = ([*map(str, symbols), "nothing"][at] for at in wrong[0])
                raise QueryError(
                    f"replacing {one} by {two} has another cost with {entity} as {names[entity]}, though they are "
                    "interchangeable; give both the same cost"
                )
    reason = table.violation()
    return Metric(
        "custom costs",
        f"Dissimilarity, because {reason}" if reason else "Edit distance with given costs",
        "Wagner and Fischer 1974",
        features.actions,
        lambda _: EditMeasure(lambda one, other: Fraction(cost(one, other))),
        axioms=not reason,
    )
