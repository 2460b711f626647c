"""Some of the tasks of a space, by their ranks: ranges, and the parts of a split."""

from __future__ import annotations

import random
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import Protocol, overload

from prag_asp.errors import QueryError
from prag_asp.space.parts.shuffle import Shuffle
from prag_asp.task import Task
from prag_asp.wording import plural


class Ranks(Protocol):
    """Different ranks in an order, however many."""

    @property
    def size(self) -> int:
        """How many ranks there are."""
        ...

    def __getitem__(self, place: int) -> int:
        """Return the rank at a place from 0 to size - 1."""
        ...

    def place(self, rank: int) -> int | None:
        """Return the place of a rank, None where it is not one of them."""
        ...

    def cut(self, places: range) -> Ranks:
        """Return the ranks at some places."""
        ...


class Space(Protocol):
    """What the ranks are those of: a `TaskSpace`."""

    def word(self, rank: int) -> tuple[str, ...]:
        """Return the task of a rank as the texts of its actions."""
        ...

    def narrate(self, plans: Iterator[tuple[str, ...]]) -> Iterator[Task]:
        """Yield the tasks of such texts."""
        ...

    def index(self, task: Task) -> int:
        """Return the rank of a task."""
        ...


@dataclass(frozen=True)
class Interval:
    """The ranks of a range."""

    ranks: range

    @property
    def size(self) -> int:
        """How many ranks there are."""
        return size_of(self.ranks)

    def __getitem__(self, place: int) -> int:
        return self.ranks[place]

    def place(self, rank: int) -> int | None:
        """Return the place of a rank, None where it is not one of them."""
        return (rank - self.ranks.start) // self.ranks.step if rank in self.ranks else None

    def cut(self, places: range) -> Interval:
        """Return the ranks at some places."""
        step = self.ranks.step * places.step
        start = self.ranks.start + self.ranks.step * places.start
        return Interval(range(start, start + step * size_of(places), step))


@dataclass(frozen=True)
class Shuffled:
    """The ranks that a shuffle has at some places."""

    order: Shuffle
    places: Interval

    @property
    def size(self) -> int:
        """How many ranks there are."""
        return self.places.size

    def __getitem__(self, place: int) -> int:
        return self.order[self.places[place]]

    def place(self, rank: int) -> int | None:
        """Return the place of a rank, None where it is not one of them."""
        return self.places.place(self.order.place(rank)) if 0 <= rank < self.order.size else None

    def cut(self, places: range) -> Shuffled:
        """Return the ranks at some places."""
        return Shuffled(self.order, self.places.cut(places))


@dataclass(frozen=True)
class RankedTasks:
    """Some of the tasks of a space in an order: counted, indexed, sliced, tested and drawn without a list of them."""

    ranks: Ranks
    space: Space

    def __repr__(self) -> str:
        return f"<{plural(self.count(), 'task')}>"

    def count(self) -> int:
        """Return how many tasks there are."""
        return self.ranks.size

    @overload
    def __getitem__(self, place: int) -> Task: ...
    @overload
    def __getitem__(self, place: slice) -> RankedTasks: ...
    def __getitem__(self, place: int | slice) -> Task | RankedTasks:
        size = self.count()
        if isinstance(place, slice):
            return RankedTasks(self.ranks.cut(range(*place.indices(size))), self.space)
        return next(self._told([self.ranks[checked_place(place, size)]]))

    def __iter__(self) -> Iterator[Task]:
        return self._told(self._all())

    def _told(self, ranks: Iterable[int]) -> Iterator[Task]:
        return self.space.narrate(map(self.space.word, ranks))

    def _all(self) -> Iterator[int]:
        place, size = 0, self.count()
        while place < size:
            yield self.ranks[place]
            place += 1

    def __contains__(self, task: object) -> bool:
        if not isinstance(task, Task):
            return False
        try:
            return self.ranks.place(self.space.index(task)) is not None
        except QueryError:
            return False

    def index(self, task: Task) -> int:
        """Return the place of a task.

        Raises:
            QueryError: it is none of these tasks.
        """
        place = self.ranks.place(self.space.index(task))
        if place is None:
            raise QueryError(
                f"not one of {'this' if self.count() == 1 else 'these'} {plural(self.count(), 'task')}: {task}"
            )
        return place

    def sample(self, count: int, *, seed: int, distinct: bool = False) -> list[Task]:
        """Return tasks drawn uniformly and independently, or with `distinct` without replacement.

        Raises:
            QueryError: there are too few.
        """
        size, generator = self.count(), random.Random(seed)
        if count < 0 or (count and not size) or (distinct and count > size):
            raise QueryError(f"cannot draw {count} of {size} tasks")
        if distinct:
            places = distinct_ranks(generator, size, count)
        else:
            places = [generator.randrange(size) for _ in range(count)]
        return list(self._told(self.ranks[place] for place in places))


def checked_place(place: int, size: int) -> int:
    """Return a place from 0 to size - 1; a negative one counts from the end.

    Raises:
        IndexError: there is no such place.
    """
    if not -size <= place < size:
        raise IndexError(f"rank {place} of {size} tasks")
    return place % size


def size_of(numbers: range) -> int:
    """Return how many numbers a range has; `len` fails above 2^63."""
    return max(0, -((numbers.start - numbers.stop) // numbers.step))


class Generator(Protocol):
    """A source of random numbers."""

    def randrange(self, below: int, /) -> int:
        """Return a number from 0 to `below` - 1, each with the same probability."""
        ...


def distinct_ranks(generator: Generator, total: int, count: int) -> list[int]:
    """Return `count` different numbers below `total`, every set of them equally likely, in random order.

    Needs room for the numbers returned alone, however large `total` is (Floyd's algorithm, Bentley 1987).
    """
    chosen: set[int] = set()
    ranks: list[int] = []
    for last in range(total - count, total):
        rank = generator.randrange(last + 1)
        if rank in chosen:
            rank = last
        chosen.add(rank)
        ranks.append(rank)
    for last in range(count - 1, 0, -1):
        other = generator.randrange(last + 1)
        ranks[last], ranks[other] = ranks[other], ranks[last]
    return ranks
