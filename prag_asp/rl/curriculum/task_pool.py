"""The tasks from which a curriculum samples: all tasks of a space or of a part of a space."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from fractions import Fraction
from functools import partial
from hashlib import sha256
from math import lcm
from typing import TYPE_CHECKING, NamedTuple, Protocol

from prag_asp.batches import growing_batches
from prag_asp.errors import NotFound, QueryError
from prag_asp.exact_numbers import Number, parse_number
from prag_asp.random_bits import SeededBits
from prag_asp.space.distinct_sampling import MISSES
from prag_asp.space.engines import Draw
from prag_asp.space.sampling.streams import log_probability
from prag_asp.space.task_space import TaskSpace
from prag_asp.space.weights.weights import Weights
from prag_asp.task import Task

if TYPE_CHECKING:
    from prag_asp.space.parts.ranked_tasks import RankedTasks

Word = tuple[str, ...]

BATCH, CACHED, NOTED = 32, 256, 4096
"""The maximum numbers of plans converted to tasks at once, of cached tasks, and of plans whose batch is stored."""


class Proposal(NamedTuple):
    """A sampled task, given by its actions as strings, with its exact probability.

    `passed` counts the samples just before this one that were rejected because they are not in the pool.
    """

    word: Word
    probability: Fraction
    passed: int = 0


class PoolPart(Protocol):
    """A part of the tasks of a space: a `SpacePart` or a `RankedPart`."""

    @property
    def size(self) -> int:
        """The number of tasks."""
        ...

    def __contains__(self, word: Word) -> bool: ...

    def word(self, number: int) -> Word:
        """Return the task with a given number, from 0 to size - 1."""
        ...


@dataclass(frozen=True)
class RankedPart:
    """The tasks with given ranks in a space whose tasks have the same length."""

    tasks: RankedTasks
    space: TaskSpace

    @property
    def size(self) -> int:
        """The number of tasks."""
        return self.tasks.count()

    def __contains__(self, word: Word) -> bool:
        return self.tasks.ranks.place(self.space.index(word)) is not None

    def word(self, number: int) -> Word:
        """Return the task with a given number."""
        return self.space.plan_at(self.tasks.ranks[number])


@dataclass(frozen=True)
class TaskPool:
    """The tasks of a space that have at least one action; with a `part`, only those in the part.

    Raises:
        QueryError: the pool would be empty.
    """

    space: TaskSpace
    part: PoolPart | None = None
    _batches: dict[Word, list[Draw]] = field(default_factory=dict, repr=False, compare=False)
    _tasks: dict[Word, Task] = field(default_factory=dict, repr=False, compare=False)

    def __post_init__(self) -> None:
        if not any(self.space.lengths):
            raise QueryError("tasks without actions have no subgoals; give a space of another length")
        if self.part is not None and not self.part.size:
            raise QueryError("the part has no task; give another one")

    @property
    def lengths(self) -> Sequence[int]:
        """The lengths of the tasks in the pool, in ascending order.

        Raises:
            QueryError: the pool has no task.
        """
        lengths = sorted(length for length in self.space.lengths if length and self.at(length).count())
        if not lengths:
            raise QueryError("there is no task to draw; give a space with other lengths or fewer conditions")
        return lengths

    def at(self, length: int) -> TaskSpace:
        """Return the space of the tasks of one length."""
        return self.space.at(length)

    def has(self, word: Word) -> bool:
        """Return whether a task of the space is in the pool."""
        if not word or self.part is None:
            return bool(word)
        return word in self.part

    def proposals(self, *, seed: int, length: int | None = None) -> Iterator[Proposal]:
        """Yield independent samples endlessly, with the weights of the domain; `length` restricts them to one length.

        The probability of a task is its probability among all tasks of the space or, with a `length`, of this length.

        Raises:
            QueryError: the pool has no task.
            NotFound: `MISSES` tasks in a row are not in the pool.
        """
        draws = self.draws(seed=seed, length=length)
        while True:
            yield self.next_in_pool(partial(next, draws))

    def draws(
        self, *, seed: int, weights: Mapping[str, Number] | Weights | None = None, length: int | None = None
    ) -> Iterator[Proposal]:
        """Yield independent samples endlessly, including tasks outside the pool; `TaskSpace.draw` explains `weights`.

        Raises:
            QueryError: there is no task, or a weight matches nothing.
        """
        space = self.space if length is None else self.at(length)
        for draw in self.batched(space.sampling(weights=weights).draws(seed=seed)):
            yield Proposal(draw.word, draw.probability)

    def next_in_pool(self, draw: Callable[[], Proposal], misses: int = MISSES) -> Proposal:
        """Return the first sample that is in the pool, with the number of samples that were skipped.

        Raises:
            NotFound: `misses` samples in a row are not in the pool.
        """
        for passed in range(misses):
            sample = draw()
            if self.has(sample.word):
                return sample._replace(passed=passed)
        raise NotFound(f"none of {misses} sampled tasks in a row is in the part; give a larger part")

    def batched(self, draws: Iterator[Draw]) -> Iterator[Draw]:
        """Yield draws, and record the batch of each one, so that `task` can create all tasks of a batch together."""
        for batch in growing_batches(draws, BATCH):
            if len(self._batches) > NOTED:
                self._batches.clear()
            self._batches.update((draw.word, batch) for draw in batch)
            yield from batch

    def task(self, proposal: Proposal) -> Task:
        """Return the task of a proposal."""
        word = proposal.word
        if word not in self._tasks:
            if len(self._tasks) > CACHED:
                self._tasks.clear()
            coming = (draw for draw in self._batches.pop(word, ()) if draw.word not in self._tasks)
            alike = [draw for draw in coming if len(draw.word) == len(word)]
            alike = alike or [Draw(word, proposal.probability)]
            tasks = self.at(len(word)).tasks_of_draws(alike)
            self._tasks.update((draw.word, task) for draw, task in zip(alike, tasks, strict=True))
        return replace(self._tasks[word], log_probability=log_probability(proposal.probability))


def derive_seed(seed: int, *numbers: int | str) -> int:
    """Return a seed derived from another seed and labels; its samples are independent of those from all other seeds."""
    return int.from_bytes(sha256(" ".join(map(str, (seed, *numbers))).encode()).digest()[:16], "big")


def sample_index(shares: Sequence[Fraction], seed: int, *numbers: int | str) -> int:
    """Return an index sampled with exactly the probabilities in `shares`, which add up to 1."""
    scale = lcm(*(share.denominator for share in shares))
    number = SeededBits(derive_seed(seed, *numbers)).randrange(scale)
    for place, share in enumerate(shares):
        number -= int(share * scale)
        if number < 0:
            return place
    raise AssertionError("shares add up to 1")


def parse_share(what: str, number: Number | float, *, positive: bool = False) -> Fraction:
    """Return a share from 0 to 1 as a fraction; a float means its decimal digits. `positive` excludes 0.

    Raises:
        QueryError: the number is not in this range.
    """
    share = parse_number(what, str(number))
    if not 0 <= share <= 1 or (positive and not share):
        raise QueryError(
            f"{what}: {number} is not a share; give a number {'above 0' if positive else 'from 0'} up to 1"
        )
    return share


def parse_count(what: str, number: object) -> int:
    """Return a whole number of at least 1.

    Raises:
        QueryError: the number is not a whole number of at least 1.
    """
    if isinstance(number, bool) or not isinstance(number, int) or number < 1:
        raise QueryError(f"{what}: {number!r}; give a whole number of at least 1")
    return number
