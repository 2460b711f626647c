"""Choice of tasks that are far apart."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from prag_asp.analysis.all_pairs import PairDistances
from prag_asp.analysis.distance_matrix import SimilarityMatrix
from prag_asp.errors import QueryError

CHOSEN = -1.0
"""Stands for the distance of a chosen task from the chosen ones, so that it is not chosen twice."""


@dataclass(frozen=True)
class DiverseChoice:
    """Tasks that are far apart, in the order of their choice.

    Any two of `tasks` have at least the distance `separation` (0 for a single task), and each task that is not chosen
    has at most the distance `radius` from a chosen one.
    """

    tasks: tuple[int, ...]
    separation: float
    radius: float


def diverse_choice(given: SimilarityMatrix | PairDistances, count: int) -> DiverseChoice:
    """Return `count` tasks that are far apart: task 0, and repeatedly the task farthest from all chosen ones.

    For metrics, no choice of `count` tasks has a `radius` below half of this one, or a `separation` above twice this
    one (Gonzalez 1985; Ravi, Rosenkrantz and Tayi 1994). Among equally far tasks, the smallest number is chosen.

    Raises:
        QueryError: there are fewer than `count` tasks, or `count` is not positive.
    """
    tasks = given.count
    if not 1 <= count <= tasks:
        raise QueryError(f"cannot choose {count} of {tasks} tasks; choose at least 1 and at most {tasks}")
    unit = float(given.denominator or 1)
    chosen, separation = [0], 0.0
    nearest = given.row(0) / unit
    nearest[0] = CHOSEN
    while len(chosen) < count:
        farthest = int(np.argmax(nearest))
        separation = float(nearest[farthest])
        chosen.append(farthest)
        nearest = np.minimum(nearest, given.row(farthest) / unit)
        nearest[farthest] = CHOSEN
    return DiverseChoice(tuple(chosen), separation, max(float(nearest.max()), 0.0))
