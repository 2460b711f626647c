"""Subsets of the tasks of a space, given by their ranks: ranges, and the parts of a split."""

from __future__ import annotations

import random
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import count as numbers_from
from itertools import takewhile
from typing import Protocol, overload

from prag_asp.errors import QueryError
from prag_asp.exact_numbers import Number
from prag_asp.space.parts.shares import divided, parse_shares
from prag_asp.space.parts.shuffle import Shuffle
from prag_asp.task import Task
from prag_asp.wording import plural


class Ranks(Protocol):
    """A sequence of distinct ranks, possibly longer than `len` allows."""

    @property
    def size(self) -> int:
        """The number of ranks."""
        ...

    def __getitem__(self, place: int) -> int:
        """Return the rank at an index from 0 to size - 1."""
        ...

    def place(self, rank: int) -> int | None:
        """Return the index of a rank, or None if the rank is not included."""
        ...

    def cut(self, places: range) -> Ranks:
        """Return the ranks at the given indices."""
        ...


class Space(Protocol):
    """A space with ranked tasks: a `TaskSpace`."""

    def plan_at(self, rank: int) -> tuple[str, ...]:
        """Return the plan of the task with a given rank as the texts of its actions."""
        ...

    def tasks_of_plans(self, plans: Iterable[Sequence[str]]) -> Iterator[Task]:
        """Yield the tasks of plans that are given as texts of actions."""
        ...

    def index(self, task: Task) -> int:
        """Return the rank of a task."""
        ...


@dataclass(frozen=True)
class RankRange:
    """The ranks in a range."""

    ranks: range

    @property
    def size(self) -> int:
        """The number of ranks."""
        return size_of(self.ranks)

    def __getitem__(self, place: int) -> int:
        return self.ranks[place]

    def place(self, rank: int) -> int | None:
        """Return the index of a rank, or None if the rank is not included."""
        return (rank - self.ranks.start) // self.ranks.step if rank in self.ranks else None

    def cut(self, places: range) -> RankRange:
        """Return the ranks at the given indices."""
        step = self.ranks.step * places.step
        start = self.ranks.start + self.ranks.step * places.start
        return RankRange(range(start, start + step * size_of(places), step))


@dataclass(frozen=True)
class ShuffledRanks:
    """The ranks at certain indices of a shuffle."""

    order: Shuffle
    places: RankRange

    @property
    def size(self) -> int:
        """The number of ranks."""
        return self.places.size

    def __getitem__(self, place: int) -> int:
        return self.order[self.places[place]]

    def place(self, rank: int) -> int | None:
        """Return the index of a rank, or None if the rank is not included."""
        return self.places.place(self.order.place(rank)) if 0 <= rank < self.order.size else None

    def cut(self, places: range) -> ShuffledRanks:
        """Return the ranks at the given indices."""
        return ShuffledRanks(self.order, self.places.cut(places))


def divided_ranks(count: int, shares: Mapping[str, Number | float], seed: int) -> dict[str, ShuffledRanks]:
    """Return disjoint random parts of the ranks below `count`, with the given shares, rounded by less than one rank.

    Raises:
        QueryError: the shares are not numbers above 0 that add up to 1.
    """
    order, parts = Shuffle(count, seed), divided(count, parse_shares(shares))
    return {name: ShuffledRanks(order, RankRange(places)) for name, places in parts.items()}


@dataclass(frozen=True)
class RankedTasks:
    """An ordered subset of the tasks of a space, which is counted, indexed, sliced and sampled without being listed."""

    ranks: Ranks
    space: Space

    def __repr__(self) -> str:
        return f"<{plural(self.count(), 'task')}>"

    def count(self) -> int:
        """Return the number of tasks."""
        return self.ranks.size

    @overload
    def __getitem__(self, place: int) -> Task: ...
    @overload
    def __getitem__(self, place: slice) -> RankedTasks: ...
    def __getitem__(self, place: int | slice) -> Task | RankedTasks:
        size = self.count()
        if isinstance(place, slice):
            return RankedTasks(self.ranks.cut(range(*place.indices(size))), self.space)
        return next(self._tasks([self.ranks[checked_place(place, size)]]))

    def __iter__(self) -> Iterator[Task]:
        size = self.count()  # `range(size)` may exceed the range of the C code of `map`
        return self._tasks(self.ranks[place] for place in takewhile(size.__gt__, numbers_from(0)))

    def _tasks(self, ranks: Iterable[int]) -> Iterator[Task]:
        return self.space.tasks_of_plans(map(self.space.plan_at, ranks))

    def __contains__(self, task: object) -> bool:
        if not isinstance(task, Task):
            return False
        try:
            return self.ranks.place(self.space.index(task)) is not None
        except QueryError:
            return False

    def index(self, task: Task) -> int:
        """Return the index of a task in the subset.

        Raises:
            QueryError: the task is not in the subset.
        """
        place = self.ranks.place(self.space.index(task))
        if place is None:
            raise QueryError(
                f"not one of {'this' if self.count() == 1 else 'these'} {plural(self.count(), 'task')}: {task}"
            )
        return place

    def sample(self, count: int, *, seed: int, distinct: bool = False) -> list[Task]:
        """Return tasks sampled uniformly and independently, or, with `distinct`, without replacement.

        A smaller sample of distinct tasks is a prefix of a larger one with the same seed.

        Raises:
            QueryError: more distinct tasks are requested than exist.
        """
        size = self.count()
        if count < 0 or (count and not size) or (distinct and count > size):
            raise QueryError(f"cannot sample {count} of {size} tasks")
        if distinct:
            order = Shuffle(size, seed)
            places = [order[number] for number in range(count)]
        else:
            generator = random.Random(seed)
            places = [generator.randrange(size) for _ in range(count)]
        return list(self._tasks(self.ranks[place] for place in places))


def checked_place(place: int, size: int) -> int:
    """Return an index from 0 to size - 1; a negative index counts from the end.

    Raises:
        IndexError: the index is out of range.
    """
    if not -size <= place < size:
        raise IndexError(f"rank {place} of {size} tasks")
    return place % size


def size_of(numbers: range) -> int:
    """Return the size of a range; `len` fails above 2^63."""
    return max(0, -((numbers.start - numbers.stop) // numbers.step))
