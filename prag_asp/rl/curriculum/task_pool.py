"""What a curriculum draws from: the tasks of a space, or of a part of it, and no others."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from fractions import Fraction
from functools import partial
from hashlib import sha256
from math import lcm
from typing import TYPE_CHECKING, NamedTuple

from prag_asp.batches import growing_batches
from prag_asp.errors import NotFound, QueryError
from prag_asp.random_bits import SeededBits
from prag_asp.space.distinct_sampling import MISSES
from prag_asp.space.engines import Draw
from prag_asp.space.sampling.streams import log_probability
from prag_asp.space.task_space import TaskSpace
from prag_asp.space.weights.weights import Number, Weights, parse_number
from prag_asp.task import Task

if TYPE_CHECKING:
    from prag_asp.space.parts.ranked_tasks import Ranks

Word = tuple[str, ...]

TOGETHER, KEPT, NOTED = 32, 256, 4096
"""So many draws are told together at most, so many tasks are kept, and of so many it is noted which come together."""


class Offer(NamedTuple):
    """A task that was drawn, as the texts of its actions, with the exact probability that the draw gave it.

    `passed` is how many draws before it were passed over, because no task of the pool came of them.
    """

    word: Word
    probability: Fraction
    passed: int = 0


@dataclass(frozen=True)
class Pool:
    """The tasks of a space that have an action; with a `part`, those of them alone that it has the ranks of.

    Raises:
        QueryError: there are none, or a part is given of a space of several lengths.
    """

    space: TaskSpace
    part: Ranks | None = None
    _coming: dict[Word, list[Draw]] = field(default_factory=dict, repr=False, compare=False)
    _told: dict[Word, Task] = field(default_factory=dict, repr=False, compare=False)

    def __post_init__(self) -> None:
        if not any(self.space.lengths):
            raise QueryError("tasks of no action have no subgoal; give a space of another length")
        if self.part is not None and len(self.space.lengths) > 1:
            raise QueryError("a part is one of a space of one length; give that, or spaces without a part")
        if self.part is not None and not self.part.size:
            raise QueryError("the part has no task; give another one")

    @property
    def lengths(self) -> Sequence[int]:
        """The lengths of its tasks, ascending.

        Raises:
            QueryError: there is no task.
        """
        found = sorted(length for length in self.space.lengths if length and self.at(length).count())
        if not found:
            raise QueryError("there is no task to draw; give a space of other lengths, or of fewer conditions")
        return found

    def at(self, length: int) -> TaskSpace:
        """Return the space of one length."""
        return self.space.at(length)

    def has(self, word: Word) -> bool:
        """Tell whether a task of the space is one of the pool."""
        if not word or self.part is None:
            return bool(word)
        return self.part.place(self.at(len(word)).index(word)) is not None

    def offers(self, *, seed: int, length: int | None = None) -> Iterator[Offer]:
        """Yield tasks drawn by the weights of the domain, independently and without end; of one length where given.

        The probability is that among all tasks of the space, or of those of the length.

        Raises:
            QueryError: there is nothing to draw.
            NotFound: so many in a row are none of the pool.
        """
        draws = self.draws(seed=seed, length=length)
        while True:
            yield self.kept(partial(next, draws))

    def draws(
        self, *, seed: int, weights: Mapping[str, Number] | Weights | None = None, length: int | None = None
    ) -> Iterator[Offer]:
        """Yield tasks of the space as `offers` does, those of the pool and all others, by some weights.

        Raises:
            QueryError: there is nothing to draw, or a weight fits nothing.
        """
        space = self.space if length is None else self.at(length)
        for draw in self.together(space.sampling(weights=weights).draws(seed=seed)):
            yield Offer(draw.word, draw.probability)

    def kept(self, draw: Callable[[], Offer], misses: int = MISSES) -> Offer:
        """Draw until a task of the pool comes, and return that: it notes how many were passed over.

        Raises:
            NotFound: so many in a row are none.
        """
        for passed in range(misses):
            found = draw()
            if self.has(found.word):
                return found._replace(passed=passed)
        raise NotFound(f"none of {misses} tasks drawn in a row is one of those to be learned; give a larger part")

    def together(self, draws: Iterator[Draw]) -> Iterator[Draw]:
        """Yield draws, and note which come together: their tasks are told together, where one is asked for."""
        for batch in growing_batches(draws, TOGETHER):
            if len(self._coming) > NOTED:
                self._coming.clear()
            self._coming.update((draw.word, batch) for draw in batch)
            yield from batch

    def task(self, offer: Offer) -> Task:
        """Return the task that is offered."""
        word = offer.word
        if word not in self._told:
            if len(self._told) > KEPT:
                self._told.clear()
            coming = (draw for draw in self._coming.pop(word, ()) if draw.word not in self._told)
            alike = [draw for draw in coming if len(draw.word) == len(word)]
            alike = alike or [Draw(word, offer.probability)]
            tasks = self.at(len(word)).tasks_of_draws(alike)
            self._told.update((draw.word, task) for draw, task in zip(alike, tasks, strict=True))
        return replace(self._told[word], log_probability=log_probability(offer.probability))


def derived(seed: int, *numbers: int | str) -> int:
    """Return a seed that follows from another one and some numbers: draws by it are independent of all others."""
    return int.from_bytes(sha256(" ".join(map(str, (seed, *numbers))).encode()).digest()[:16], "big")


def chosen(shares: Sequence[Fraction], seed: int, *numbers: int | str) -> int:
    """Return a place with exactly the probability that it has among some shares, which add up to 1."""
    scale = lcm(*(share.denominator for share in shares))
    number = SeededBits(derived(seed, *numbers)).randrange(scale)
    for place, share in enumerate(shares):
        number -= int(share * scale)
        if number < 0:
            return place
    raise AssertionError("shares add up to 1")


def share_of(what: str, number: Number | float, *, least: bool = False) -> Fraction:
    """Return a share from 0 to 1 as a fraction; a float is what its digits say. With `least` it is above 0.

    Raises:
        QueryError: it is none.
    """
    share = parse_number(what, str(number))
    if not 0 <= share <= 1 or (least and not share):
        raise QueryError(f"{what}: {number} is no share; give a number {'above 0' if least else 'from 0'} up to 1")
    return share


def whole_of(what: str, number: object) -> int:
    """Return a whole number of at least 1.

    Raises:
        QueryError: it is none.
    """
    if isinstance(number, bool) or not isinstance(number, int) or number < 1:
        raise QueryError(f"{what}: {number!r}; give a whole number of at least 1")
    return number
