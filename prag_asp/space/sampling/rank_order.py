"""The order of a draw without replacement: the k-th of its numbers is known without those before it."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import accumulate
from typing import Protocol

from prag_asp.space.parts.ranked_tasks import ShuffledRanks


class RankOrder(Protocol):
    """Different tasks of several stretches of ranks, in an order that does not depend on how many are asked for."""

    @property
    def size(self) -> int:
        """How many tasks there are."""
        ...

    def __getitem__(self, number: int) -> tuple[int, int]:
        """Return the stretch, and the rank in it, of the task of a number from 0 to size - 1."""
        ...

    def number(self, stretch: int, rank: int) -> int | None:
        """Return the number of a task, None where it is not among them."""
        ...


@dataclass(frozen=True)
class ShareOrder:
    """Stretches of some `sizes`, one after another, shuffled as one: each is met by its exact share."""

    sizes: tuple[int, ...]
    shuffled: ShuffledRanks

    @property
    def size(self) -> int:
        """How many tasks there are."""
        return self.shuffled.size

    @cached_property
    def _ends(self) -> Sequence[int]:
        return tuple(accumulate(self.sizes))

    def __getitem__(self, number: int) -> tuple[int, int]:
        """Return the stretch, and the rank in it, of the task of a number."""
        place = self.shuffled[number]
        stretch = bisect_right(self._ends, place)
        return stretch, place - self._ends[stretch] + self.sizes[stretch]

    def number(self, stretch: int, rank: int) -> int | None:
        """Return the number of a task, None where it is not among them."""
        return self.shuffled.place(rank + self._ends[stretch] - self.sizes[stretch])


@dataclass(frozen=True)
class EvenOrder:
    """Stretches taken by turns, each shuffled; one that is used up is left out from then on."""

    shuffled: tuple[ShuffledRanks, ...]

    @property
    def size(self) -> int:
        """How many tasks there are."""
        return sum(each.size for each in self.shuffled)

    def __getitem__(self, number: int) -> tuple[int, int]:
        """Return the stretch, and the rank in it, of the task of a number."""
        rounds = 0
        for bound in sorted({each.size for each in self.shuffled}):
            left = [stretch for stretch, each in enumerate(self.shuffled) if each.size >= bound]
            here = len(left) * (bound - rounds)
            if number < here:
                stretch = left[number % len(left)]
                return stretch, self.shuffled[stretch][rounds + number // len(left)]
            number, rounds = number - here, bound
        raise IndexError(f"no task has the number {number}")

    def number(self, stretch: int, rank: int) -> int | None:
        """Return the number of a task, None where it is not among them."""
        place = self.shuffled[stretch].place(rank)
        if place is None:
            return None
        before = sum(min(each.size, place) for each in self.shuffled)
        return before + sum(1 for each in self.shuffled[:stretch] if each.size > place)
