"""Stratified samples: the draws from each stratum, and the exact weights of its tasks."""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable, Iterator, Sequence
from fractions import Fraction
from typing import Annotated, Generic, TypeVar

import msgspec

from prag_asp.errors import QueryError
from prag_asp.integers import digits_of, number_of
from prag_asp.space.strata.allocation import FEWEST
from prag_asp.tables.json_fields import Whole

Item = TypeVar("Item")

DRAWS_FOR_EACH = 1000
"""The limit on draws from a stratum, per requested task."""


class StratumFigures(msgspec.Struct, frozen=True):
    """The figures of a stratum in a sample without replacement.

    `size` is the number of tasks of the stratum in the space, as digits. `draws` tasks were drawn, of which `tasks`
    count (because they are feasible, for example). Sampling ended when `requested` tasks counted or no tasks were left
    to draw.
    """

    name: str
    size: Annotated[str, msgspec.Meta(pattern="^[1-9][0-9]*$")]
    requested: Whole
    draws: Whole
    tasks: Whole

    @property
    def share(self) -> Fraction:
        """An unbiased estimate of the share of the stratum's tasks that count.

        For n such tasks in d draws, of which the last one counts, it is (n - 1) / (d - 1): see Haldane (1945) for draws
        with replacement, and Mikulski and Smith (1976) for draws without replacement. If the draws ended because no
        task was left, the share is known exactly.
        """
        if self.tasks < self.requested:
            return Fraction(self.tasks, number_of(self.size))
        return Fraction(1) if self.tasks == self.draws else Fraction(self.tasks - 1, self.draws - 1)

    @property
    def variance(self) -> Fraction:
        """An unbiased estimate of the variance of `share` (Salehi and Seber 2001); it is 0 if the share is known."""
        if self.tasks < self.requested or self.tasks == self.draws or self.draws <= FEWEST:
            return Fraction(0)
        left = 1 - Fraction(self.draws - 1, number_of(self.size))
        return left * self.share * (1 - self.share) / (self.draws - 2)

    @property
    def population(self) -> Fraction:
        """The number of the stratum's tasks that count, or an estimate of this number."""
        return number_of(self.size) * self.share


def stratum_weights(strata: Sequence[StratumFigures]) -> dict[str, Fraction]:
    """Return the weight of each stratum: its share of all tasks in the space that count; the weights sum to 1.

    The weights are exact if all draws count. The weight of a task in a sample is the weight of its stratum, divided by
    the number of sampled tasks of this stratum.

    Raises:
        QueryError: no task of any stratum counts.
    """
    total = sum((stratum.population for stratum in strata), start=Fraction(0))
    if not total:
        raise QueryError("no task of any stratum was found, so there are no weights")
    return {stratum.name: stratum.population / total for stratum in strata}


class StratumFeed(Generic[Item]):
    """Numbered draws from strata, one stratum after the other, until each quota is filled.

    Draws may be taken from the iterator before the results of earlier ones are known. The results are later given to
    `take`, in the same order; results for a stratum that is full are ignored, so that the sample does not depend on the
    number of draws taken ahead.
    """

    def __init__(self, strata: Sequence[tuple[str, int, int]], draws: Sequence[Iterable[tuple[int, Item]]]) -> None:
        """Take the name, size and quota of each stratum, and its numbered draws in order."""
        self._strata, self._draws = strata, draws
        self._pending: deque[tuple[int, int]] = deque()
        self._found, self._drawn = [0] * len(strata), [0] * len(strata)
        self._ended: set[int] = set()

    def __iter__(self) -> Iterator[tuple[int, Item]]:
        for place, ((_, _, quota), draws) in enumerate(zip(self._strata, self._draws, strict=True)):
            for number, item in draws:
                if self._found[place] >= quota or number >= DRAWS_FOR_EACH * quota:
                    break
                self._pending.append((place, number))
                yield number, item
            else:
                self._ended.add(place)

    def take(self, *, counts: bool) -> str | None:
        """Return the name of the stratum to which the next result belongs, or None if this result is ignored."""
        place, number = self._pending.popleft()
        name, _, quota = self._strata[place]
        if self._found[place] >= quota:
            return None
        self._found[place] += counts
        self._drawn[place] = number + 1
        return name

    @property
    def found(self) -> int:
        """The number of tasks found so far."""
        return sum(self._found)

    @property
    def full(self) -> bool:
        """Whether all strata have as many tasks as requested."""
        return all(found >= quota for found, (_, _, quota) in zip(self._found, self._strata, strict=True))

    @property
    def exhausted(self) -> bool:
        """Whether each stratum is full or has no tasks left to draw."""
        return all(
            found >= quota or place in self._ended
            for place, (found, (_, _, quota)) in enumerate(zip(self._found, self._strata, strict=True))
        )

    def figures(self) -> list[StratumFigures]:
        """Return the figures of all strata."""
        return [
            StratumFigures(name, digits_of(size), quota, size if found < quota else drawn, found)
            for (name, size, quota), found, drawn in zip(self._strata, self._found, self._drawn, strict=True)
        ]
