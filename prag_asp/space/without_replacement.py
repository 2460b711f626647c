"""The parts of a task space, each in the order of sampling without replacement."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction

from prag_asp.batches import growing_batches
from prag_asp.errors import QueryError
from prag_asp.exact_numbers import Number
from prag_asp.space.distinct_sampling import (
    BATCH,
    RankedDraw,
    TaskOrder,
    UniformOrder,
    WeightedOrder,
    nonempty_sets,
)
from prag_asp.space.parts.ranked_tasks import RankRange, ShuffledRanks
from prag_asp.space.parts.shares import divided, parse_shares
from prag_asp.space.parts.shuffle import Shuffle
from prag_asp.space.sampling.rank_order import EvenOrder, RankOrder, RemainingOrder, ShareOrder
from prag_asp.space.sampling.samplers import Over
from prag_asp.space.sampling.sharding import ALL, Deal
from prag_asp.space.strata.allocation import StratifiedBy
from prag_asp.space.strata.stratum import strata_of
from prag_asp.space.task_space import TaskSpace
from prag_asp.space.weights.weights import Weights
from prag_asp.space.word_set import RankedWords, WordSet
from prag_asp.task import Task
from prag_asp.wording import unknown

WHOLE = "train"
"""The name of the only part of tasks that are not split, as dataset loaders expect it."""


@dataclass(frozen=True)
class DealtOrder:
    """The tasks that one of several workers contributes to a dataset, renumbered from 0."""

    order: TaskOrder
    deal: Deal

    @property
    def size(self) -> int:
        """The number of tasks."""
        return self.deal.share(self.order.size)

    def pick(self, numbers: Iterable[int]) -> Iterator[RankedDraw]:
        """Yield the tasks with the given ascending numbers, until there are no more."""
        return self.order.pick(map(self.deal.whole, numbers))


@dataclass(frozen=True)
class Division:
    """A division of tasks: into `shares` of tasks or of whole skeletons, by a held-out feature, or into strata.

    The shares of `strata` are those of a sample.
    """

    shares: Mapping[str, Fraction]
    skeletons: bool = False
    hold_out: str | None = None
    strata: StratifiedBy | None = None

    @classmethod
    def parse(
        cls,
        shares: Mapping[str, Number | float] | None,
        *,
        skeletons: bool = False,
        hold_out: str | None = None,
        strata: StratifiedBy | None = None,
    ) -> Division:
        """Return the division with the given shares: by default, a single part or, with `hold_out`, 4/5 for training.

        Raises:
            QueryError: the shares do not add up to 1, or do not fit the other options.
        """
        if hold_out is not None and skeletons:
            raise QueryError("tasks are split by whole skeletons or by a held-out feature; leave one of them out")
        if strata is not None and (skeletons or hold_out is not None):
            raise QueryError("strata cannot be combined with whole skeletons or held-out features; choose one of them")
        if shares is None and skeletons:
            raise QueryError("whole skeletons need shares, such as train=0.8,test=0.2")
        parsed = parse_shares(shares or ({WHOLE: 1} if hold_out is None else {WHOLE: "4/5", "test": "1/5"}))
        if hold_out is not None and set(parsed) != {WHOLE, "test"}:
            raise QueryError(f"shares of {', '.join(parsed)}: with something held out, the parts are train and test")
        for name in parsed:
            if not name.isidentifier():
                raise QueryError(f"part {name!r}: write a name of letters and digits, such as train")
        return cls(parsed, skeletons, hold_out, strata)

    @property
    def by_tasks(self) -> bool:
        """Whether any two tasks may be in different parts."""
        return not self.skeletons and self.hold_out is None and self.strata is None


@dataclass(frozen=True)
class SpacePart:
    """The tasks of one part of a divided space; `order` contains ranks of words in `sets`, one set for each length."""

    sets: Sequence[WordSet]
    order: RankOrder

    @property
    def size(self) -> int:
        """The number of tasks."""
        return self.order.size

    def __contains__(self, word: tuple[str, ...]) -> bool:
        for place, words in enumerate(self.sets):
            if words.length == len(word):
                rank = words.rank(word)
                return rank is not None and self.order.number(place, rank) is not None
        return False

    def word(self, number: int) -> tuple[str, ...]:
        """Return the task with a given number, from 0 to size - 1, as the texts of its actions."""
        place, rank = self.order[number]
        return self.sets[place].word(rank)


def space_part(space: TaskSpace, division: Division, name: str, *, seed: int) -> SpacePart:
    """Return the tasks of the part `name`, as in a dataset with the same division and seed, in no particular order.

    Raises:
        QueryError: there is no such part, or there is nothing to sample.
    """
    if name not in division.shares:
        raise QueryError(unknown(name, division.shares, "part"))
    sets = _sets(space, nonempty_sets(space.sampling()), division, seed)[name]
    return SpacePart(sets, order_of([words.count() for words in sets], division, name, seed, evenly=False))


def ordered_parts(
    space: TaskSpace,
    division: Division,
    *,
    seed: int,
    weights: Weights,
    over: Over | None = None,
    evenly: bool = False,
    deal: Deal = ALL,
    excluded: Collection[tuple[int, int]] = (),
    among: Sequence[RankedWords] | None = None,
) -> dict[str, TaskOrder]:
    """Return the tasks of each part of a space, in the order of sampling without replacement.

    Without weights, lengths have their exact shares or, with `evenly`, alternate. With `over`, a skeleton or a goal of
    the space is sampled uniformly first; draws that are in other parts, or not new, are repeated. A `deal` selects the
    tasks of one of several workers. The `excluded` tasks, given as pairs of a length and a rank, are left out; parts
    keep their other tasks. With `among`, only these tasks are used, and the shares refer to them.

    Raises:
        QueryError: a part is empty, there is nothing to sample, an excluded rank has no task, or weights or `over` are
            combined with `evenly`.
    """
    sampling = space.sampling(weights=weights, over=over)
    whole = nonempty_sets(sampling)
    if division.strata is not None:
        return _stratified_parts(space, division, division.strata, seed, deal)
    if weights and evenly:
        raise QueryError("lengths come evenly only with uniform sampling; add --uniform (weights={})")
    if over and evenly:
        raise QueryError(
            f"lengths come evenly only with uniform sampling of tasks; leave out --over {over} or --evenly"
        )
    own = _sets(space, whole, division, seed)
    sets: Mapping[str, Sequence[RankedWords]] = own
    if among is not None:
        if not division.by_tasks:
            raise QueryError(
                "tasks that are far from others are divided by shares only; leave skeletons and hold_out out"
            )
        by_length = {words.length: words for words in among}
        sets = {name: [by_length[words.length] for words in whole] for name in division.shares}
    orders = {
        name: order_of([words.count() for words in sets[name]], division, name, seed, evenly=evenly)
        for name in division.shares
    }
    if excluded:
        words = _excluded_words(whole, excluded)
        orders = {name: _without(order, sets[name], words) for name, order in orders.items()}
    for name, order in orders.items():
        if not order.size:
            raise QueryError(f"there are no tasks to sample for the part {name}")
    parts: dict[str, TaskOrder] = {}
    for name, order in orders.items():
        if weights or over:
            some = bool(excluded) or among is not None
            accepts = _acceptance(division, sets[name], order, with_exclusions=some)
            parts[name] = WeightedOrder(sampling, whole, own[name], seed, order.size, accepts)
        else:
            sizes = [words.count() for words in whole]
            probabilities = [Fraction(1, len(sizes) * size if evenly else sum(sizes)) for size in sizes]
            parts[name] = UniformOrder(whole, sets[name], order, probabilities)
    return {name: part if deal == ALL else DealtOrder(part, deal) for name, part in parts.items()}


def _stratified_parts(
    space: TaskSpace, division: Division, by: StratifiedBy, seed: int, deal: Deal
) -> dict[str, TaskOrder]:
    """Return the tasks of each stratum, in the order of sampling without replacement.

    Raises:
        QueryError: the strata of the space differ from those of the division.
    """
    orders = {each.name: each.order for each in strata_of(space, by, seed=seed, most=len(division.shares))}
    if orders.keys() != division.shares.keys():
        raise QueryError(f"the {by} strata of {space.title} are not those of the sample; generate it again")
    return {name: orders[name] if deal == ALL else DealtOrder(orders[name], deal) for name in division.shares}


def with_tasks(
    space: TaskSpace, draws: Iterable[RankedDraw], *, together: int = 1
) -> Iterator[tuple[RankedDraw, Task]]:
    """Yield each draw with its task, lazily, in batches that start with `together` draws and grow."""
    for batch in growing_batches(draws, BATCH, first=together):
        yield from zip(batch, space.tasks_of_draws(batch), strict=True)


def _sets(space: TaskSpace, whole: Sequence[WordSet], division: Division, seed: int) -> dict[str, Sequence[WordSet]]:
    """Return the words of each part, one set per length of `whole`."""
    lengths = [words.length for words in whole]
    if division.by_tasks:
        return dict.fromkeys(division.shares, whole)
    if division.hold_out is not None:
        train, test = space.at(max(lengths)).hold_out(division.hold_out)
        parts = {WHOLE: train, "test": test}
        return {name: [WordSet(parts[name].engines, "task", length) for length in lengths] for name in division.shares}
    shares = {name: str(share) for name, share in division.shares.items()}
    split = [space.at(length).split_skeletons(shares, seed=seed) for length in lengths]
    return {
        name: [WordSet(spaces[name].engines, "task", length) for spaces, length in zip(split, lengths, strict=True)]
        for name in division.shares
    }


def order_of(sizes: Sequence[int], division: Division, name: str, seed: int, *, evenly: bool) -> RankOrder:
    """Return the order of the ranks in a part, given the number of tasks of each length in the whole."""

    def ranks(total: int) -> ShuffledRanks:
        places = divided(total, division.shares)[name] if division.by_tasks else range(total)
        return ShuffledRanks(Shuffle(total, seed), RankRange(places))

    return EvenOrder(tuple(map(ranks, sizes))) if evenly else ShareOrder(tuple(sizes), ranks(sum(sizes)))


def _acceptance(
    division: Division, sets: Sequence[RankedWords], order: RankOrder, *, with_exclusions: bool
) -> Callable[[int, tuple[str, ...]], bool] | None:
    """Return the membership test of a part, or None if it contains all words."""
    if len(division.shares) == 1 and not with_exclusions:
        return None
    if with_exclusions or division.by_tasks:
        return lambda place, word: _is_in(order, place, sets[place].rank(word))
    return lambda place, word: sets[place].rank(word) is not None


def _is_in(order: RankOrder, place: int, rank: int | None) -> bool:
    """Return whether the order contains the word with a given rank, if any, in the set with index `place`."""
    return rank is not None and order.number(place, rank) is not None


def _excluded_words(
    whole: Sequence[WordSet], excluded: Collection[tuple[int, int]]
) -> list[tuple[int, tuple[str, ...]]]:
    """Return the index in `whole` and the word of each excluded task whose length occurs in `whole`.

    Raises:
        QueryError: there is no task with a given rank.
    """
    places = {words.length: place for place, words in enumerate(whole)}
    found = []
    for length, rank in excluded:
        if length in places:
            words = whole[places[length]]
            if rank >= words.count():
                raise QueryError(f"there are only {words.count()} tasks of length {length}, so none of rank {rank}")
            found.append((places[length], words.word(rank)))
    return found


def _without(order: RankOrder, sets: Sequence[RankedWords], words: Iterable[tuple[int, tuple[str, ...]]]) -> RankOrder:
    """Return the order of a part without certain words, which may belong to other parts."""
    ranks = ((place, sets[place].rank(word)) for place, word in words)
    numbers = {order.number(place, rank) for place, rank in ranks if rank is not None}
    return RemainingOrder(order, tuple(sorted(number for number in numbers if number is not None)))
