"""Sampling without replacement: distinct tasks in an order whose prefixes are the samples of each size.

The order depends only on the request and the seed. Uniform sampling shuffles ranks, so that the k-th task can be
computed without the tasks before it. Sampling by weight chooses each task by its weight among the remaining tasks
(successive sampling).
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import partial
from itertools import accumulate
from math import lcm
from typing import NamedTuple, Protocol

from prag_asp.errors import QueryError
from prag_asp.random_bits import SeededBits
from prag_asp.space.engines import Draw
from prag_asp.space.engines.engine import Letters
from prag_asp.space.parts.ranked_tasks import RankRange, ShuffledRanks
from prag_asp.space.parts.shuffle import Shuffle
from prag_asp.space.sampling.choice_table import exact_choice
from prag_asp.space.sampling.rank_order import RankOrder, ShareOrder
from prag_asp.space.sampling.remaining_words import RemainingWords
from prag_asp.space.task_sampling import TaskSampling
from prag_asp.space.word_set import WordSet

BATCH = 512
"""Maximum number of tasks whose states are computed together."""

MISSES = 50_000
"""Consecutive draws without a new task after which rejection sampling ends."""


class RankedDraw(NamedTuple):
    """A task: the texts of its actions, its rank among tasks of its length, and its probability in a single draw."""

    word: Letters
    rank: int
    probability: Fraction


class TaskOrder(Protocol):
    """Distinct tasks in the order of sampling without replacement."""

    @property
    def size(self) -> int:
        """The number of tasks, including those of weight 0, which are never sampled."""
        ...

    def pick(self, numbers: Iterable[int]) -> Iterator[RankedDraw]:
        """Yield the tasks with the given ascending numbers, until there are no more."""
        ...


@dataclass(frozen=True)
class UniformOrder:
    """Tasks in uniformly random order with random access.

    `order` numbers the words of `sets`, one set for each length; ranks are the ranks of these words in `whole`.
    """

    whole: Sequence[WordSet]
    sets: Sequence[WordSet]
    order: RankOrder
    probabilities: Sequence[Fraction]

    @property
    def size(self) -> int:
        """The number of tasks."""
        return self.order.size

    def pick(self, numbers: Iterable[int]) -> Iterator[RankedDraw]:
        """Yield the tasks with the given ascending numbers, until there are no more."""
        size = self.size
        for number in numbers:
            if number >= size:
                return
            place, rank = self.order[number]
            whole, part = self.whole[place], self.sets[place]
            word = part.word(rank)
            if part is not whole:
                rank = whole.require_rank(word)
                word = whole.word(rank)
            yield RankedDraw(word, rank, self.probabilities[place])


@dataclass(frozen=True)
class WeightedOrder:
    """Tasks of some lengths, each sampled by its weight among the remaining ones.

    Repeated draws are rejected; after `MISSES` misses in a row, tasks are sampled exactly from the remaining words.
    Both give the same distribution. Tasks of weight 0 are never sampled.

    `whole` has the words of each nonempty length of `sampling`, and `sets` the subset to order. `accepts` decides
    whether a word belongs to the order, given the index of its set and the word; None accepts all words.

    Raises:
        QueryError: no task weighs more than 0, or weights distinguish interchangeable entities.
    """

    sampling: TaskSampling
    whole: Sequence[WordSet]
    sets: Sequence[WordSet]
    seed: int
    size: int
    accepts: Callable[[int, Letters], bool] | None = None

    def __post_init__(self) -> None:
        self.sampling.batches(seed=self.seed)

    def pick(self, numbers: Iterable[int]) -> Iterator[RankedDraw]:
        """Yield the tasks with the given ascending numbers; all tasks before the last one are sampled on the way."""
        requested = iter(numbers)
        following = next(requested, None)
        if following is None:
            return
        for number, (place, draw) in enumerate(self._draws()):
            if number == following:
                yield RankedDraw(draw.word, self.whole[place].require_rank(draw.word), draw.probability)
                following = next(requested, None)
                if following is None:
                    return

    def _draws(self) -> Iterator[tuple[int, Draw]]:
        """Yield all tasks of positive weight, with the index of their set."""
        seen: set[Letters] = set()
        weight_seen, unit, misses = 0, 1, 0  # probabilities add up to weight_seen / unit
        places = {words.length: place for place, words in enumerate(self.whole)}
        for draw in self.sampling.draws(seed=self.seed):
            place = places[len(draw.word)]
            if draw.word in seen or not (self.accepts is None or self.accepts(place, draw.word)):
                misses += 1
                if misses < MISSES:
                    continue
                yield from self._remaining(seen)
                return
            misses = 0
            seen.add(draw.word)
            if unit % draw.probability.denominator:
                larger = lcm(unit, draw.probability.denominator)
                weight_seen, unit = weight_seen * (larger // unit), larger
            weight_seen += draw.probability.numerator * (unit // draw.probability.denominator)
            yield place, draw
            if weight_seen == unit or len(seen) == self.size:
                return

    def _remaining(self, seen: set[Letters]) -> Iterator[tuple[int, Draw]]:
        """Yield the tasks that have not been seen.

        Words that were seen or are not accepted are removed when they are sampled, at most once.
        """
        total = self.sampling.total_weight()
        weighed = [words.engine.weighed(words.length, self.sampling.weights) for words in self.sets]
        left = [RemainingWords(weights, words.length) for weights, words in zip(weighed, self.sets, strict=True)]
        scale = lcm(*(weights.unit.denominator for weights in weighed))
        factors = [int(weights.unit * scale) for weights in weighed]
        lengths, choices = SeededBits(self.seed, " remaining lengths"), SeededBits(self.seed, " remaining words")
        while any(words.weight for words in left):
            number = sum(words.taken for words in left)
            running = list(accumulate(factor * words.weight for factor, words in zip(factors, left, strict=True)))
            bits = int(lengths.words(number, 1, 1)[0, 0])
            place = exact_choice(running, bits, partial(lengths.further, number, 0))
            letters, weight = left[place].take(choices, number)
            names, whole = self.sets[place].engine.letters, self.whole[place]
            word = tuple([names[letter] for letter in letters])
            if self.sets[place] is not whole:
                word = whole.word(whole.require_rank(word))
            if word not in seen and (self.accepts is None or self.accepts(place, word)):
                yield place, Draw(word, weight * weighed[place].unit / total)


def distinct_order(sampling: TaskSampling, seed: int) -> UniformOrder | WeightedOrder:
    """Return the distinct plans or tasks of a distribution, in the order of sampling without replacement.

    Raises:
        QueryError: there is nothing to sample, or skeletons or goals are to be sampled first.
    """
    if sampling.over:
        raise QueryError(f"distinct tasks are sampled among those that are left; leave over={sampling.over!r} out")
    sets = nonempty_sets(sampling)
    sizes = [words.count() for words in sets]
    if sampling.weights:
        return WeightedOrder(sampling, sets, sets, seed, sum(sizes))
    ranks = ShareOrder(tuple(sizes), ShuffledRanks(Shuffle(sum(sizes), seed), RankRange(range(sum(sizes)))))
    return UniformOrder(sets, sets, ranks, [Fraction(1, sum(sizes))] * len(sizes))


def nonempty_sets(sampling: TaskSampling) -> tuple[WordSet, ...]:
    """Return the words of each nonempty length.

    Raises:
        QueryError: all lengths are empty.
    """
    engines, by = sampling.engines, sampling.by
    for length in sorted(sampling.lengths, reverse=True):  # the exploration for the longest length covers all lengths
        engines.count(by, length)
    sets = tuple(WordSet(engines, by, length) for length in sampling.lengths if engines.count(by, length))
    if not sets:
        raise QueryError(f"there are no {by}s to sample")
    return sets
