"""The Vendi score (Friedman and Dieng 2023): the effective number of different tasks in a space or a dataset.

It is the exponential of the entropy of the eigenvalues of K / N, where K is the matrix of the similarities of N tasks.
For a similarity that is a scalar product of features, the second moments of the features have the same eigenvalues
above 0, so the score of a whole space needs no list of its tasks. By default, the similarity is the share of positions
with the same value, so that each task has similarity 1 to itself.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from math import exp

import numpy as np

from prag_asp.analysis.moments import Feature, Moments, space_moments, task_moments
from prag_asp.space.engines import Level
from prag_asp.space.task_space import TaskSpace
from prag_asp.task import Task

NEGLIGIBLE = 1e-15
"""Eigenvalues below this bound are 0 up to rounding errors."""

DIGITS = 11
"""The significant digits of results computed from eigenvalues; further digits depend on the order of summation."""


@dataclass(frozen=True)
class VendiScore:
    """The effective number of different tasks among `words` tasks, between 1 and `words`.

    `score` has 11 significant digits; `order_2` is the exact score of order 2, the reciprocal of the sum of the squared
    eigenvalues (Pasarkar and Dieng 2024), which gives rare tasks less weight. `largest` is the largest eigenvalue.
    """

    feature: Feature
    bag: bool
    words: int
    score: float
    order_2: Fraction
    largest: float


def vendi_score(
    space: TaskSpace,
    tasks: Iterable[Task | Sequence[str]] | None = None,
    *,
    feature: Feature = "actions",
    by: Level = "task",
    bag: bool = False,
) -> VendiScore:
    """Return the Vendi score of all tasks of a space, or of some `tasks` of its length.

    `feature` is what is compared at each position: ``actions``, ``names``, ``classes`` (the name of an action with the
    classes of its arguments) or ``pairs`` (of consecutive names). Interchangeable entities have canonical names, which
    affect only ``actions``. With `bag`, the similarity is the scalar product of the numbers of occurrences. The
    similarity of a task to itself is then not 1, so K is divided by its trace instead of N: a task counts in proportion
    to its similarity to itself, which is larger if values repeat.

    Raises:
        QueryError: the space has several lengths, no tasks or no positions, or a task has a different length.
        LimitReached: a limit ended the exploration.
    """
    moments = space_moments(space, feature, by) if tasks is None else task_moments(space, tasks, feature)
    return score_of(moments, bag=bag)


def score_of(moments: Moments, *, bag: bool = False) -> VendiScore:
    """Return the Vendi score, computed from second moments."""
    matrix = moments.products if bag else moments.joint
    trace = int(np.trace(matrix))
    order_2 = Fraction(trace**2, int((matrix * matrix).sum()))
    eigenvalues = np.linalg.eigvalsh((matrix / trace).astype(np.float64))
    positive = eigenvalues[eigenvalues > NEGLIGIBLE]
    score = exp(-float(positive @ np.log(positive)))
    return VendiScore(moments.feature, bag, moments.words, rounded(score), order_2, rounded(float(eigenvalues[-1])))


def rounded(number: float) -> float:
    """Return a number, rounded to the digits that do not depend on the machine or the number of threads."""
    return float(f"{number:.{DIGITS}g}")
