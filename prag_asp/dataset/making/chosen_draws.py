"""Draws that are chosen rather than sampled: they cover combinations of factors, or are far apart.

A choice depends on which earlier draws were feasible. Draws are therefore chosen in rounds: those in a round depend
only on the results of earlier rounds, and are validated together. The same results give the same draws, so that a run
can be resumed and verified.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Sequence
from dataclasses import dataclass
from itertools import count, islice, takewhile
from typing import TYPE_CHECKING, Protocol

import numpy as np
from numpy.typing import NDArray

from prag_asp.analysis.all_pairs import PairDistances, pair_distances
from prag_asp.analysis.covering.combinations import combination_text
from prag_asp.analysis.covering.replacing_tasks import CoveringRounds
from prag_asp.analysis.farthest_first import CHOSEN, METRIC
from prag_asp.dataset.store.chosen_figures import CoverFigures, DiverseFigures
from prag_asp.errors import QueryError
from prag_asp.space.distinct_sampling import RankedDraw, TaskOrder
from prag_asp.space.without_replacement import ordered_parts, with_tasks

if TYPE_CHECKING:
    from prag_asp.dataset.dataset_spec import DatasetSpec
    from prag_asp.dataset.store.manifest import Manifest
    from prag_asp.dataset.store.tables import Row
    from prag_asp.space.task_space import TaskSpace

TOGETHER = 16
"""The number of draws in a round of tasks that are far apart: enough to occupy the workers of a machine, and few enough
to waste little work.
"""


class DrawChoice(Protocol):
    """The draws chosen so far, and the rules for further ones."""

    draws: list[RankedDraw]

    @property
    def rest(self) -> TaskOrder | None:
        """The sampled tasks after the chosen ones, or None if there are none."""
        ...

    def extend(self, passed: Collection[int]) -> bool:
        """Choose another round, given the numbers of the feasible draws so far; return False if there is none."""
        ...

    def figures(self, rows: Iterable[Row]) -> CoverFigures | DiverseFigures:
        """Return the coverage or distances of the tasks of a part, given rows with the columns `draw` and `plan`."""
        ...


def choice_of(space: TaskSpace, spec: DatasetSpec, order: TaskOrder, share: int) -> DrawChoice | None:
    """Return the choice of tasks for a part of a dataset with an `order`, or None if its tasks are only sampled.

    `share` is the number of candidates for the part.

    Raises:
        QueryError: the space has several lengths, or its states are too many to be listed.
        LimitReached: a limit was reached.
    """
    if spec.cover:
        return CoverChoice(space, spec, order)
    return DiverseChoices(space, spec, order, share) if spec.candidates else None


def chosen_order(choice: DrawChoice, passed: Collection[int]) -> Iterator[RankedDraw]:
    """Yield all draws of a choice in order, given the numbers of the feasible ones."""
    for number in count():
        if number == len(choice.draws) and not choice.extend(passed):
            break
        yield choice.draws[number]
    if choice.rest is not None:
        yield from choice.rest.pick(count())


class CoverChoice:
    """A choice of draws that cover all reachable combinations of factors; sampled tasks follow."""

    def __init__(self, space: TaskSpace, spec: DatasetSpec, order: TaskOrder) -> None:
        self._space, self._spec, self._size = space, spec, order.size
        excluded = {rank for length, rank in spec.excluded_ranks if length == space.length}
        self._rounds = CoveringRounds(space, int(spec.cover or 0), spec.seed, excluded, trivial=spec.trivial)
        self.draws: list[RankedDraw] = []

    @property
    def rest(self) -> TaskOrder | None:
        """The sampled tasks after the chosen ones."""
        chosen = [(self._space.length, draw.rank) for draw in self.draws]
        if len(chosen) == self._size:
            return None
        spec = self._spec
        (order,) = ordered_parts(
            self._space, spec.division, seed=spec.seed, weights=self._space.weights({}),
            excluded=[*spec.excluded_ranks, *chosen],
        ).values()  # fmt: skip
        return order

    def extend(self, passed: Collection[int]) -> bool:
        """Choose tasks for the combinations that no feasible draw covers."""
        known = [draw.word for number, draw in enumerate(self.draws) if number in passed]
        ranks = self._rounds.following(known)
        self.draws += [RankedDraw(self._space.plan_at(rank), rank, self._rounds.probability) for rank in ranks]
        return bool(ranks)

    def figures(self, rows: Iterable[Row]) -> CoverFigures:
        """Return the coverage of combinations by all tasks, both chosen and sampled ones."""
        missing, reachable = self._rounds.missing([row["plan"] for row in rows]), len(self._rounds.reachable)
        texts = sorted(map(combination_text, missing))
        return CoverFigures(int(self._spec.cover or 0), reachable, reachable - len(missing), texts)


class DiverseChoices:
    """A choice of candidates, the first sampled tasks, by farthest-first traversal (Gonzalez 1985)."""

    rest = None

    def __init__(self, space: TaskSpace, spec: DatasetSpec, order: TaskOrder, share: int) -> None:
        drawn = list(islice(order.pick(range(share)), share))
        pairs = [(draw, task) for draw, task in with_tasks(space, drawn) if spec.trivial or not task.trivial]
        if not pairs:
            raise QueryError(f"all {len(drawn)} candidates are trivial; raise --candidates, or keep them by --trivial")
        self._candidates = [draw for draw, _ in pairs]
        self._distances: PairDistances = pair_distances([task for _, task in pairs], METRIC, space)
        self._chosen: list[int] = []
        self.draws: list[RankedDraw] = []

    def _nearest(self, chosen: Collection[int]) -> NDArray[np.float64]:
        """Return the distance of each candidate from the nearest chosen one, or infinity if none is chosen."""
        nearest = np.full(len(self._candidates), np.inf)
        for number in chosen:
            nearest = np.minimum(nearest, self._distances.row(number) / float(self._distances.denominator or 1))
        return nearest

    def _passed(self, passed: Collection[int]) -> list[int]:
        return [candidate for number, candidate in enumerate(self._chosen) if number in passed]

    def extend(self, passed: Collection[int]) -> bool:
        """Choose the candidates that are farthest from the feasible draws and from each other."""
        nearest = self._nearest(self._passed(passed))
        nearest[self._chosen] = CHOSEN
        begun = len(self._chosen)
        while len(self._chosen) < min(begun + TOGETHER, len(self._candidates)):
            farthest = int(np.argmax(nearest))
            self._chosen.append(farthest)
            self.draws.append(self._candidates[farthest])
            nearest = np.minimum(nearest, self._nearest([farthest]))
            nearest[farthest] = CHOSEN
        return len(self._chosen) > begun

    def figures(self, rows: Iterable[Row]) -> DiverseFigures:
        """Return the smallest distance between tasks, and the largest distance of a candidate from its nearest task."""
        chosen = self._passed({row["draw"] for row in rows})
        separation = 0.0
        for place, number in enumerate(chosen[1:], 1):
            nearest = float(self._nearest([number])[chosen[:place]].min())
            separation = nearest if place == 1 else min(separation, nearest)
        radius = float(self._nearest(chosen).max()) if chosen else 0.0
        return DiverseFigures(METRIC, len(self._candidates), separation, radius)


@dataclass(frozen=True)
class ListedOrder:
    """Tasks in the order given by a list."""

    draws: Sequence[RankedDraw]

    @property
    def size(self) -> int:
        """The number of tasks."""
        return len(self.draws)

    def pick(self, numbers: Iterable[int]) -> Iterator[RankedDraw]:
        """Yield the tasks with the given ascending numbers, until there are no more."""
        return (self.draws[number] for number in takewhile(lambda number: number < len(self.draws), numbers))


@dataclass(frozen=True)
class FollowingOrder:
    """The tasks of an order, numbered from `first`."""

    order: TaskOrder
    first: int

    @property
    def size(self) -> int:
        """The number of the last task, plus one."""
        return self.first + self.order.size

    def pick(self, numbers: Iterable[int]) -> Iterator[RankedDraw]:
        """Yield the tasks with the given ascending numbers, until there are no more."""
        return self.order.pick(number - self.first for number in numbers)


def record_figures(manifest: Manifest, part: str, figures: CoverFigures | DiverseFigures) -> None:
    """Set the coverage or the distances of a part's tasks in a manifest."""
    if isinstance(figures, CoverFigures):
        manifest.cover = figures
    else:
        manifest.diverse = {**(manifest.diverse or {}), part: figures}
