"""Tasks drawn without replacement, in an order: whoever asks for more gets the same ones first."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import partial
from itertools import count, islice
from typing import TYPE_CHECKING, Any, NamedTuple, Protocol

from prag_asp.errors import QueryError
from prag_asp.space.engines import Draw
from prag_asp.space.parts.ranked_tasks import Interval, Shuffled
from prag_asp.space.parts.shares import divided, parse_shares
from prag_asp.space.parts.shuffle import Shuffle
from prag_asp.space.sampling.permutation import ByShare, Evenly, Order
from prag_asp.space.sampling.sharding import ALL, Deal
from prag_asp.space.task_space import TaskSpace
from prag_asp.space.task_spaces import TaskSpaces
from prag_asp.space.weights.weights import Number
from prag_asp.task import Task

if TYPE_CHECKING:
    from prag_asp.space.weights.temperature import Temperature

MISSES = 50_000
"""Draws in a row that bring nothing new, after which those by weight end."""

TOLD_TOGETHER = 512
"""Tasks of which the states are worked out together, at most."""

WHOLE = "train"
"""The name of the only part of tasks that are not split: loaders of data sets expect this one."""

Word = tuple[str, ...]


class Placed(NamedTuple):
    """A task as a word, its rank among all tasks of its length, and the probability that one draw gives it."""

    word: Word
    rank: int
    probability: Fraction


class Ordered(Protocol):
    """Different tasks in the order of a draw without replacement."""

    @property
    def size(self) -> int:
        """How many there are."""
        ...

    def draws(self, first: int = 0) -> Iterator[Placed]:
        """Yield them from a number on."""
        ...

    def picked(self, numbers: Iterable[int]) -> Iterator[Placed]:
        """Yield those of some ascending numbers, until there are no more."""
        ...


@dataclass(frozen=True)
class Uniform:
    """Tasks of some spaces, one for each length, each as likely as any other: the k-th is known without others.

    `spaces` are those that the order speaks of, `whole` those among whose tasks they have their ranks.
    """

    whole: tuple[TaskSpace, ...]
    spaces: tuple[TaskSpace, ...]
    order: Order
    probabilities: tuple[Fraction, ...]

    @property
    def size(self) -> int:
        """How many there are."""
        return self.order.size

    def draws(self, first: int = 0) -> Iterator[Placed]:
        """Yield them from a number on."""
        return self.picked(count(first))

    def picked(self, numbers: Iterable[int]) -> Iterator[Placed]:
        """Yield those of some ascending numbers, until there are no more."""
        size = self.size
        for number in numbers:
            if number >= size:
                return
            stretch, rank = self.order[number]
            yield self._placed(stretch, rank)

    def _placed(self, stretch: int, rank: int) -> Placed:
        whole, space = self.whole[stretch], self.spaces[stretch]
        word, probability = space.word(rank), self.probabilities[stretch]
        if space is whole:
            return Placed(word, rank, probability)
        found = whole.rank_of(word)
        return Placed(whole.word(found), found, probability)


@dataclass(frozen=True)
class ByWeight:
    """Tasks drawn by weight, one after another, of those that are left: what was drawn before is passed over.

    That is drawing without replacement by weight, exactly. `has` tells, by length and rank and word, whether a task
    is one of these, and `size` how many there are, those that weigh nothing included.
    """

    space: TaskSpace | TaskSpaces
    seed: int
    weights: Mapping[str, Number]
    temperature: Temperature
    size: int
    has: Callable[[int, int, Word], bool]

    def draws(self, first: int = 0) -> Iterator[Placed]:
        """Yield them from a number on; they end where `MISSES` draws in a row bring nothing new."""
        return self.picked(count(first))

    def picked(self, numbers: Iterable[int]) -> Iterator[Placed]:
        """Yield those of some ascending numbers; all that come before the last of them are drawn."""
        wanted = iter(numbers)
        next_one = next(wanted, None)
        seen: set[tuple[int, int]] = set()
        misses = 0
        for draw in self.space.draw_words(seed=self.seed, weights=self.weights, temperature=self.temperature):
            length = len(draw.word)
            rank = at(self.space, length).rank_of(draw.word)
            if (length, rank) in seen or not self.has(length, rank, draw.word):
                misses += 1
                if misses >= MISSES:
                    return
                continue
            misses = 0
            seen.add((length, rank))
            if len(seen) - 1 == next_one:
                yield Placed(draw.word, rank, draw.probability)
                next_one = next(wanted, None)
            if next_one is None or len(seen) == self.size:
                return


@dataclass(frozen=True)
class Dealt:
    """The tasks that are dealt to one of several who make a data set together, numbered from 0 among themselves."""

    ordered: Ordered
    deal: Deal

    @property
    def size(self) -> int:
        """How many there are."""
        return self.deal.share(self.ordered.size)

    def draws(self, first: int = 0) -> Iterator[Placed]:
        """Yield them from a number on."""
        return self.picked(count(first))

    def picked(self, numbers: Iterable[int]) -> Iterator[Placed]:
        """Yield those of some ascending numbers, until there are no more."""
        return self.ordered.picked(map(self.deal.whole, numbers))


@dataclass(frozen=True)
class Division:
    """How tasks are divided into parts: by `shares`, of tasks or of whole skeletons, or by what only a part has."""

    shares: Mapping[str, Fraction]
    skeletons: bool = False
    hold_out: str | None = None

    @classmethod
    def parse(
        cls, shares: Mapping[str, Number | float] | None, *, skeletons: bool = False, hold_out: str | None = None
    ) -> Division:
        """Return the division that is asked for: one part without any, four fifths for training with `hold_out`.

        Raises:
            QueryError: the shares do not add up to 1, or do not fit the rest.
        """
        if hold_out is not None and skeletons:
            raise QueryError("tasks are split by whole skeletons, or by what is held out; leave one of them out")
        if shares is None and skeletons:
            raise QueryError("whole skeletons need shares, such as train=0.8,test=0.2")
        given = parse_shares(shares or ({WHOLE: 1} if hold_out is None else {WHOLE: "4/5", "test": "1/5"}))
        if hold_out is not None and set(given) != {WHOLE, "test"}:
            raise QueryError(f"shares of {', '.join(given)}: with something held out, the parts are train and test")
        for name in given:
            if not name.isidentifier():
                raise QueryError(f"part {name!r}: write a name of letters and digits, such as train")
        return cls(given, skeletons, hold_out)

    @property
    def by_tasks(self) -> bool:
        """Whether any two tasks may be in different parts."""
        return not self.skeletons and self.hold_out is None


def ordered_parts(
    space: TaskSpace | TaskSpaces,
    division: Division,
    *,
    seed: int,
    weights: Mapping[str, Number] | None = None,
    temperature: Temperature = 1,
    evenly: bool = False,
    deal: Deal = ALL,
) -> dict[str, Ordered]:
    """Return the tasks of each part of some spaces, drawn without replacement: those that are dealt to one of several.

    Without weights that tell tasks apart, lengths have their exact shares, or with `evenly` come by turns. `weights` of
    None are those of the domain.

    Raises:
        QueryError: a part is empty, weights fit nothing, or they are to be obeyed `evenly`.
    """
    longest_first = sorted(lengths_of(space), reverse=True)  # what is explored for the longest holds for all
    sizes = {length: at(space, length).count() for length in longest_first}
    whole = tuple(at(space, length) for length in lengths_of(space) if sizes[length])
    if not whole:
        raise QueryError("there are no tasks to draw")
    given = space.domain.settings.weights if weights is None else weights
    parts: Mapping[str, Ordered]
    weighed = bool(given) and str(temperature).strip() != "inf"
    if weighed and evenly:
        raise QueryError("lengths come evenly where tasks are drawn uniformly; give --uniform (weights={}) as well")
    if given:
        space.draw_words(seed=seed, weights=given, temperature=temperature)
    spaces = _spaces(whole, division, seed)
    orders = {
        name: order_of([each.count() for each in spaces[name]], division, name, seed, evenly=evenly)
        for name in division.shares
    }
    for name, order in orders.items():
        if not order.size:
            raise QueryError(f"there are no tasks to draw for the part {name}")
    if not weighed:
        probabilities = _probabilities([each.count() for each in whole], evenly=evenly)
        parts = {name: Uniform(whole, spaces[name], order, probabilities) for name, order in orders.items()}
    else:
        numbers = {each.length: number for number, each in enumerate(whole)}
        parts = {
            name: ByWeight(
                space, seed, given, temperature, order.size, partial(_has, division, numbers, spaces[name], order)
            )
            for name, order in orders.items()
        }
    return {name: part if deal == ALL else Dealt(part, deal) for name, part in parts.items()}


def tell(
    space: TaskSpace | TaskSpaces, placed: Iterator[Placed], *, together: int = 1
) -> Iterator[tuple[Placed, Task]]:
    """Yield the task of each of some draws, lazily; those of one length are told together, first so many."""
    size = together
    while batch := list(islice(placed, size)):
        alike: dict[int, list[Draw]] = {}
        for each in batch:
            alike.setdefault(len(each.word), []).append(Draw(each.word, each.probability))
        told = {length: iter(at(space, length).tasks_of(draws)) for length, draws in alike.items()}
        for each in batch:
            yield each, next(told[len(each.word)])
        size = min(2 * size, TOLD_TOGETHER)


def distinct_tasks(
    space: TaskSpace | TaskSpaces,
    *,
    seed: int,
    weights: Mapping[str, Number] | None = None,
    temperature: Temperature = 1,
) -> Iterator[Task]:
    """Yield different tasks, drawn by weight among those that are left, until none is.

    Raises:
        QueryError: there is nothing to draw, or a weight fits nothing.
    """
    parts = ordered_parts(space, Division.parse(None), seed=seed, weights=weights, temperature=temperature)
    return (task for _, task in tell(space, parts[WHOLE].draws()))


def drawn_tasks(space: TaskSpace | TaskSpaces, *, seed: int, distinct: bool = False, **drawing: Any) -> Iterator[Task]:
    """Yield tasks as `TaskSpace.draw` does; with `distinct`, each among those that are left, until none is.

    Raises:
        QueryError: there is nothing to draw, or the draw is asked for in a wrong way.
    """
    return distinct_tasks(space, seed=seed, **drawing) if distinct else space.draw(seed=seed, **drawing)


def lengths_of(space: TaskSpace | TaskSpaces) -> Sequence[int]:
    """Return the lengths of a space."""
    return (space.length,) if isinstance(space, TaskSpace) else space.lengths


def at(space: TaskSpace | TaskSpaces, length: int) -> TaskSpace:
    """Return the space of one of its lengths, with the conditions of the whole."""
    return space if isinstance(space, TaskSpace) else space.at(length)


def _spaces(whole: tuple[TaskSpace, ...], division: Division, seed: int) -> dict[str, tuple[TaskSpace, ...]]:
    """Return the spaces of each part, one for each length."""
    if division.by_tasks:
        return dict.fromkeys(division.shares, whole)
    if division.hold_out is not None:
        train, test = max(whole, key=lambda each: each.length).hold_out(division.hold_out)
        parts = {WHOLE: train, "test": test}
        return {name: tuple(parts[name].at(each.length) for each in whole) for name in division.shares}
    shares = {name: str(share) for name, share in division.shares.items()}
    split = [each.split_skeletons(shares, seed=seed) for each in whole]
    return {name: tuple(each[name] for each in split) for name in division.shares}


def order_of(sizes: Sequence[int], division: Division, name: str, seed: int, *, evenly: bool) -> Order:
    """Return the order of the tasks of a part, given how many tasks each length has in all that is divided."""

    def places(total: int) -> Shuffled:
        found = divided(total, division.shares)[name] if division.by_tasks else range(total)
        return Shuffled(Shuffle(total, seed), Interval(found))

    return Evenly(tuple(map(places, sizes))) if evenly else ByShare(tuple(sizes), places(sum(sizes)))


def _probabilities(sizes: Sequence[int], *, evenly: bool) -> tuple[Fraction, ...]:
    """Return with which probability one draw gives a task of each length."""
    return tuple(Fraction(1, len(sizes) * size if evenly else sum(sizes)) for size in sizes)


def _has(
    division: Division, numbers: Mapping[int, int], spaces: Sequence[TaskSpace], order: Order, length: int, rank: int,
    word: Word,
) -> bool:  # fmt: skip
    """Tell whether a task is one of a part."""
    if division.by_tasks:
        return order.number(numbers[length], rank) is not None
    space = spaces[numbers[length]]
    try:
        space.rank_of(word)
    except QueryError:
        return False
    return True
