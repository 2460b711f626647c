"""Sampling without replacement: distinct tasks in an order whose prefixes are the samples of each size.

The order depends only on the request and the seed. Uniform sampling shuffles ranks, so that the k-th task can be
computed without the tasks before it. Sampling by weight, or over skeletons or goals, chooses each task with its
probability among the remaining tasks (successive sampling).
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import partial
from itertools import accumulate, count
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
from prag_asp.space.sampling.remaining_words import RemainingWords, walks_of
from prag_asp.space.sampling.samplers import GoalSampler, SkeletonSampler
from prag_asp.space.task_sampling import TaskSampling
from prag_asp.space.word_set import RankedWords, WordSet

BATCH = 512
"""Maximum number of tasks whose states are computed together."""

MISSES = 50_000
"""Number of consecutive draws without a new task after which rejection sampling ends."""

MOST_GROUPS = 20_000
"""Maximum number of skeletons or goals whose remaining tasks are sampled; each needs running totals of up to about 50
kB."""


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

    `order` contains ranks of words in `sets`, which has one set for each length; the returned ranks are the ranks of
    these words in `whole`.
    """

    whole: Sequence[WordSet]
    sets: Sequence[RankedWords]
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


class _Source(NamedTuple):
    """The remaining words of one length, with the index of the length, the whole set, and a factor for the weights."""

    place: int
    own: WordSet
    words: RemainingWords
    unit: Fraction


@dataclass(frozen=True)
class WeightedOrder:
    """Tasks of the given lengths, each sampled with its probability among the remaining ones.

    Repeated draws are rejected; after `MISSES` misses in a row, tasks are sampled exactly from the remaining words.
    Both give the same distribution. Tasks of weight 0 are never sampled.

    `whole` has the words of each nonempty length of `sampling`, and `sets` the subset to order. `accepts` decides
    whether a word belongs to the order, given the index of its set and the word; None accepts all words.

    Raises:
        QueryError: no task weighs more than 0, or weights distinguish interchangeable entities; or, from `pick`,
            `MISSES` draws in a row yielded no new task and there are more than `MOST_GROUPS` skeletons or goals.
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
        """Yield the tasks with the given ascending numbers; all tasks before the last of them are sampled as well."""
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
        """Yield the tasks that have not been sampled yet.

        A word that was seen before or is not accepted is removed when it is sampled, so it is sampled at most once.
        """
        sources = self._grouped_sources() if self.sampling.over else self._sources()
        total = sum((each.unit * each.words.weight for each in sources), start=Fraction(0))
        if not self.sampling.over:
            total = self.sampling.total_weight()
        scale = lcm(*(each.unit.denominator for each in sources))
        factors = [int(each.unit * scale) for each in sources]
        lengths, choices = SeededBits(self.seed, " remaining lengths"), SeededBits(self.seed, " remaining words")
        for number in count():
            running = list(
                accumulate(factor * each.words.weight for factor, each in zip(factors, sources, strict=True))
            )
            if not running[-1]:
                return
            bits = int(lengths.words(number, 1, 1)[0, 0])
            source = sources[exact_choice(running, bits, partial(lengths.further, number, 0))]
            letters, weight = source.words.take(choices, number)
            own, whole = source.own, self.whole[source.place]
            word = tuple([own.engine.letters[letter] for letter in letters])
            if own is not whole:
                word = whole.word(whole.require_rank(word))
            if word not in seen and (self.accepts is None or self.accepts(source.place, word)):
                yield source.place, Draw(word, weight * source.unit / total)

    def _sources(self) -> list[_Source]:
        """Return the words of each length of the order."""
        weighed = [words.engine.weighed(words.length, self.sampling.weights) for words in self.sets]
        return [
            _Source(place, words, RemainingWords(walks_of(weights, words.length), words.length), weights.unit)
            for place, (words, weights) in enumerate(zip(self.sets, weighed, strict=True))
        ]

    def _grouped_sources(self) -> list[_Source]:
        """Return the words of each skeleton or goal of each length; all of them have the same probability."""
        sources: list[_Source] = []
        for place, words in enumerate(self.whole):
            if not words.engine.weighed(words.length, self.sampling.weights).total(words.length):
                continue
            sampler = self.sampling.sampler(words.length)
            if not isinstance(sampler, GoalSampler | SkeletonSampler):
                walks = [walks_of(words.engine.weighed(words.length, self.sampling.weights), words.length)]
            elif sampler.count + len(sources) > MOST_GROUPS:
                raise QueryError(
                    f"over {self.sampling.over}, {MISSES} draws in a row gave no new task, and there are more than "
                    f"{MOST_GROUPS} {self.sampling.over}; ask for fewer tasks, or sample without over"
                )
            else:
                walks = list(sampler.groups())
            for each in walks:
                sources.append(_Source(place, words, RemainingWords(each, words.length), Fraction(1, each.total)))
        return sources


def distinct_order(sampling: TaskSampling, seed: int) -> UniformOrder | WeightedOrder:
    """Return the distinct plans or tasks of a distribution, in the order of sampling without replacement.

    Raises:
        QueryError: there is nothing to sample.
    """
    sets = nonempty_sets(sampling)
    sizes = [words.count() for words in sets]
    if sampling.weights or sampling.over:
        return WeightedOrder(sampling, sets, sets, seed, sum(sizes))
    ranks = ShareOrder(tuple(sizes), ShuffledRanks(Shuffle(sum(sizes), seed), RankRange(range(sum(sizes)))))
    return UniformOrder(sets, sets, ranks, [Fraction(1, sum(sizes))] * len(sizes))


def nonempty_sets(sampling: TaskSampling) -> tuple[WordSet, ...]:
    """Return the words of each nonempty length.

    Raises:
        QueryError: all lengths are empty.
    """
    engines, by = sampling.engines, sampling.by
    for length in sorted(sampling.lengths, reverse=True):  # the exploration for the greatest length covers all lengths
        engines.count(by, length)
    sets = tuple(WordSet(engines, by, length) for length in sampling.lengths if engines.count(by, length))
    if not sets:
        raise QueryError(f"there are no {by}s to sample")
    return sets
