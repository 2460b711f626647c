"""Orders for sampling without replacement, with random access to the k-th task."""

from __future__ import annotations

from bisect import bisect_left, bisect_right
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import accumulate
from typing import Protocol

from prag_asp.space.parts.ranked_tasks import ShuffledRanks


class RankOrder(Protocol):
    """Distinct tasks from several stretches of ranks, in an order that does not depend on the number of samples."""

    @property
    def size(self) -> int:
        """The number of tasks."""
        ...

    def __getitem__(self, number: int) -> tuple[int, int]:
        """Return the stretch, and the rank in it, of the task with a given number, from 0 to size - 1."""
        ...

    def number(self, stretch: int, rank: int) -> int | None:
        """Return the number of a task, or None if it is not in the order."""
        ...


@dataclass(frozen=True)
class ShareOrder:
    """Concatenated stretches of the given `sizes`, shuffled as a whole, so that each has its exact share."""

    sizes: tuple[int, ...]
    shuffled: ShuffledRanks

    @property
    def size(self) -> int:
        """The number of tasks."""
        return self.shuffled.size

    @cached_property
    def _ends(self) -> Sequence[int]:
        return tuple(accumulate(self.sizes))

    def __getitem__(self, number: int) -> tuple[int, int]:
        """Return the stretch, and the rank in it, of the task with a given number."""
        place = self.shuffled[number]
        stretch = bisect_right(self._ends, place)
        return stretch, place - self._ends[stretch] + self.sizes[stretch]

    def number(self, stretch: int, rank: int) -> int | None:
        """Return the number of a task, or None if it is not in the order."""
        return self.shuffled.place(rank + self._ends[stretch] - self.sizes[stretch])


@dataclass(frozen=True)
class EvenOrder:
    """Tasks taken in turn from shuffled stretches; exhausted stretches are skipped."""

    shuffled: tuple[ShuffledRanks, ...]

    @property
    def size(self) -> int:
        """The number of tasks."""
        return sum(ranks.size for ranks in self.shuffled)

    def __getitem__(self, number: int) -> tuple[int, int]:
        """Return the stretch, and the rank in it, of the task with a given number."""
        rounds = 0
        for bound in sorted({ranks.size for ranks in self.shuffled}):
            left = [stretch for stretch, ranks in enumerate(self.shuffled) if ranks.size >= bound]
            here = len(left) * (bound - rounds)
            if number < here:
                stretch = left[number % len(left)]
                return stretch, self.shuffled[stretch][rounds + number // len(left)]
            number, rounds = number - here, bound
        raise IndexError(f"no task has the number {number}")

    def number(self, stretch: int, rank: int) -> int | None:
        """Return the number of a task, or None if it is not in the order."""
        place = self.shuffled[stretch].place(rank)
        if place is None:
            return None
        before = sum(min(ranks.size, place) for ranks in self.shuffled)
        return before + sum(1 for ranks in self.shuffled[:stretch] if ranks.size > place)


@dataclass(frozen=True)
class RemainingOrder:
    """The remaining tasks of an order, renumbered; `excluded` holds the numbers of the others in ascending order."""

    order: RankOrder
    excluded: tuple[int, ...]

    @property
    def size(self) -> int:
        """The number of tasks."""
        return self.order.size - len(self.excluded)

    def __getitem__(self, number: int) -> tuple[int, int]:
        """Return the stretch, and the rank in it, of the task with a given number."""
        return self.order[number + bisect_right(self._remaining_before, number)]

    def number(self, stretch: int, rank: int) -> int | None:
        """Return the number of a task, or None if it is not in the order."""
        number = self.order.number(stretch, rank)
        if number is None:
            return None
        before = bisect_left(self.excluded, number)
        return None if self.excluded[before : before + 1] == (number,) else number - before

    @cached_property
    def _remaining_before(self) -> Sequence[int]:
        """The number of remaining tasks before each excluded task."""
        return [number - place for place, number in enumerate(self.excluded)]
