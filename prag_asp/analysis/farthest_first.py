"""Choose tasks that are far apart, and measure how far new tasks are from given ones."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from prag_asp.analysis.all_pairs import PairDistances, pair_distances
from prag_asp.analysis.distance_matrix import SimilarityMatrix
from prag_asp.errors import QueryError
from prag_asp.similarity.background import Trace, UpTo
from prag_asp.similarity.metrics import Metric
from prag_asp.wording import plural

if TYPE_CHECKING:
    from prag_asp.task import KnownDomain

METRIC = "levenshtein-classes"
"""The metric by which commands choose tasks that are far apart: edits of actions, which cost less between similar
objects."""

CHOSEN = -1.0
"""The distance assigned to a task once it is chosen, so that it is not chosen again."""


@dataclass(frozen=True)
class DiverseChoice:
    """Tasks that are far apart, in the order in which they were chosen.

    The distance between any two of `tasks` is at least `separation` (0 for a single task), and the distance of each
    other task from the nearest chosen one is at most `radius`.
    """

    tasks: tuple[int, ...]
    separation: float
    radius: float


def diverse_choice(given: SimilarityMatrix | PairDistances, count: int) -> DiverseChoice:
    """Return `count` tasks that are far apart: task 0, and then repeatedly the task farthest from all chosen ones.

    For metrics, no choice of `count` tasks has a `radius` below half of this one, or a `separation` above twice this
    one (Gonzalez 1985; Ravi, Rosenkrantz and Tayi 1994). Among tasks at equal distances, the one with the smallest
    index is chosen.

    Raises:
        QueryError: there are fewer than `count` tasks, or `count` is not positive.
    """
    tasks = given.count
    if not 1 <= count <= tasks:
        raise QueryError(f"cannot choose {count} of {plural(tasks, 'task')}; choose at least 1 and at most {tasks}")
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


@dataclass(frozen=True)
class Novelty:
    """The distance of each new task from the nearest given task, shape (new tasks,), and the index of that task."""

    distances: NDArray[np.float64]
    nearest: NDArray[np.int64]


def novelty(
    tasks: Sequence[Trace],
    given: Sequence[Trace],
    metric: str | Metric = "combined",
    within: KnownDomain | None = None,
    up_to: UpTo = "names",
) -> Novelty:
    """Return the distance of each task from the nearest given task; other arguments are those of `Task.distance`.

    Among given tasks at equal distances, the one with the smallest index is returned. For the distance from a whole
    space, use `nearest_task`, which does not list the tasks.

    Raises:
        QueryError: no task is given, or `pair_distances` raises this error.
        SimilarityMissingError: the metric needs rapidfuzz, which is not installed.
    """
    if not given:
        raise QueryError("there is no given task to measure distances from; give at least one")
    pairs = pair_distances([*given, *tasks], metric, within, up_to)
    unit = float(pairs.denominator or 1)
    distances, nearest = np.zeros(len(tasks)), np.zeros(len(tasks), dtype=np.int64)
    for place in range(len(tasks)):
        row = pairs.row(len(given) + place)[: len(given)]
        nearest[place] = np.argmin(row)
        distances[place] = row[nearest[place]] / unit
    return Novelty(distances, nearest)
