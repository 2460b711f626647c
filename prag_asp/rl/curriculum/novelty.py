"""What was not drawn yet first, by exact coverage."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import count, pairwise
from typing import Literal, get_args

from prag_asp.errors import NotFound, QueryError
from prag_asp.random_bits import SeededBits
from prag_asp.rl.curriculum.course import Course, Episode, Keys, State
from prag_asp.rl.curriculum.stream import Stream, times
from prag_asp.rl.curriculum.task_pool import Offer, Pool, Word, derived
from prag_asp.space.distinct_sampling import MISSES
from prag_asp.space.engines import Draw
from prag_asp.space.parts.shuffle import Shuffle
from prag_asp.space.sampling.samplers import SkeletonSampler
from prag_asp.wording import unknown

What = Literal["tasks", "skeletons", "names", "pairs"]
WHAT: tuple[What, ...] = get_args(What)

TRIES = 20
"""How many infeasible tasks may have a name or a pair until it counts as drawn: physics may forbid it altogether."""

MISSED = 1000
"""How many draws of what is due may be of no task of the pool until a new pass begins: the part may have none."""

RARE = Fraction(1, 16)
"""Of all draws a smaller share than this has something that is due: then that is weighed up."""

LOUDER, HALF = 64, Fraction(1, 2)
"""By which factor it is, again and again, until so large a share of the draws has some of it."""


@dataclass(frozen=True)
class Novelty:
    """What was not drawn yet first: `what` is "tasks", "skeletons", or the "names" of actions or "pairs" of them.

    Tasks come without replacement, all orders alike; so do skeletons, each with a task that it has, drawn by weight.
    With names or pairs, each task has one that is due, as long as one is: one that no feasible task had yet, nor
    `TRIES` infeasible ones. When all were drawn, or no task of the part is found that has any, a new pass begins.

    Raises:
        QueryError: there is nothing of that kind.
    """

    what: What = "pairs"

    def __post_init__(self) -> None:
        if self.what not in WHAT:
            raise QueryError(unknown(str(self.what), WHAT, "kind of novelty"))

    def course(self, pool: Pool) -> Course:
        """Return a course through the tasks of a pool.

        Raises:
            QueryError: the pool has no pairs of actions.
        """
        if self.what == "tasks":
            return Passes(_Tasks(pool), pool)
        if self.what == "skeletons":
            return Passes(_Skeletons(pool), pool)
        return Coverage(pool, self.what)


class _Tasks:
    """The tasks of a pool by number."""

    def __init__(self, pool: Pool):
        self._pool = pool
        self._stretches = _stretches(pool, [pool.at(length).count() for length in pool.lengths])
        self.size = pool.part.size if pool.part is not None else sum(size for _, size in self._stretches)

    def word(self, number: int, seed: int) -> tuple[Word, Fraction]:
        """Return the task of a number."""
        part = self._pool.part
        length, rank = _found(self._stretches, number if part is None else part[number])
        return self._pool.at(length).plan_at(rank), Fraction(1)


class _Skeletons:
    """The skeletons of a pool by number."""

    def __init__(self, pool: Pool):
        self._pool = pool
        self._samplers: dict[int, SkeletonSampler] = {}
        for length in reversed(pool.lengths):  # what is explored for the longest holds for all
            sampler = pool.at(length).sampling(over="skeletons").sampler()
            assert isinstance(sampler, SkeletonSampler)
            self._samplers[length] = sampler
        self._stretches = _stretches(pool, [self._samplers[length].count for length in pool.lengths])
        self.size = sum(size for _, size in self._stretches)

    def word(self, number: int, seed: int) -> tuple[Word, Fraction]:
        """Return a task with the skeleton of a number, drawn by a seed, and its probability among all that have it."""
        length, rank = _found(self._stretches, number)
        letters, probability = self._samplers[length].of_rank(rank, SeededBits(seed), number)
        names = self._pool.at(length).action_texts()
        return tuple([names[letter] for letter in letters]), probability


def _stretches(pool: Pool, sizes: Sequence[int]) -> list[tuple[int, int]]:
    """Return each length with how many there are of it."""
    return list(zip(pool.lengths, sizes, strict=True))


def _found(stretches: Sequence[tuple[int, int]], number: int) -> tuple[int, int]:
    """Return the length of a number, and its number there."""
    for length, size in stretches:
        if number < size:
            return length, number
        number -= size
    raise AssertionError("a number is below the sum of all sizes")


class Passes:
    """A course in which each of some things comes once, in random order, before any comes again."""

    def __init__(self, things: _Tasks | _Skeletons, pool: Pool):
        self._things, self._pool = things, pool
        self.seed(0)

    def seed(self, seed: int) -> None:
        """Begin anew."""
        self._go_on(seed, 0)

    def offer(self) -> Offer:
        """Return a task of what comes next, with its probability given all that came before."""
        return self._pool.kept(self._next)

    def settle(self, word: Word, feasible: bool) -> None:
        """Nothing depends on it."""

    def report(self, episode: Episode) -> None:
        """Nothing depends on it."""

    def told(self) -> Mapping[str, int | str]:
        """Return how many were drawn in this pass, and of how many."""
        times, place = divmod(self._drawn, self._things.size)
        return {"pass": times + 1, "drawn": str(place), "of": str(self._things.size)}

    def state_dict(self) -> State:
        """Return what it has come to."""
        return {"seed": self._seed, "drawn": self._drawn}

    def load_state_dict(self, state: State) -> None:
        """Go on from what `state_dict` returned."""
        self._go_on(state["seed"], state["drawn"])

    def _go_on(self, seed: int, drawn: int) -> None:
        self._seed, self._drawn = seed, drawn
        self._draws = self._pool.together(self._coming(seed, drawn))

    def _next(self) -> Offer:
        """Return a task of what comes next, of the pool or none of it."""
        self._drawn += 1
        draw = next(self._draws)
        return Offer(draw.word, draw.probability)

    def _coming(self, seed: int, drawn: int) -> Iterator[Draw]:
        """Yield what comes after so many draws."""
        for number in count(drawn):
            times, place = divmod(number, self._things.size)
            own = derived(seed, "pass", times)
            word, probability = self._things.word(Shuffle(self._things.size, own)[place], own)
            yield Draw(word, probability / (self._things.size - place))


class Coverage:
    """A course in which each task has a name or a pair that is due."""

    def __init__(self, pool: Pool, what: What):
        self._pool, self._what = pool, what
        self._keys = Keys(pool.space.domain.facts)
        found: set[str] = set()
        for length in pool.lengths:
            figures = pool.at(length).statistics()
            found |= set(figures.expected_names) if what == "names" else set(map(">".join, figures.expected_pairs))
        if not found:
            raise QueryError(f"no task of the space has {what}; give one of another length, or another novelty")
        self._all = tuple(sorted(found))
        self._base = dict(pool.space.domain.settings.weights)
        self.seed(0)

    def seed(self, seed: int) -> None:
        """Begin anew."""
        self._seed, self._times = seed, 0
        self._usual = Stream(self._pool, self._base, derived(seed, "usual"))
        self._begin(self._all, {})

    def offer(self) -> Offer:
        """Return a task that has something that is due, with its probability among all that do."""
        try:
            return self._pool.kept(self._drawn, MISSED)
        except NotFound:
            if len(self._due) == len(self._all):
                return self._pool.kept(self._drawn)
        self._begin(self._all, {})
        found = self._pool.kept(self._drawn)
        return found._replace(passed=MISSED + found.passed)

    def settle(self, word: Word, feasible: bool) -> None:
        """Note what was drawn."""
        had = self._has(word) & self._due
        for key in had:
            self._tries[key] = TRIES if feasible else self._tries.get(key, 0) + 1
        over = {key for key in had if self._tries[key] >= TRIES}
        if over:
            left = [key for key in self._all if key in self._due and key not in over]
            self._begin(left or self._all, self._tries if left else {})

    def report(self, episode: Episode) -> None:
        """Nothing depends on it."""

    def told(self) -> Mapping[str, int | str]:
        """Return how many are due, and of how many."""
        return {"due": len(self._due), "of": len(self._all)}

    def state_dict(self) -> State:
        """Return what it has come to."""
        return {
            "seed": self._seed,
            "times": self._times,
            "taken": [self._usual.taken, self._louder.taken if self._louder else 0],
            "due": sorted(self._due),
            "tries": {key: tries for key, tries in sorted(self._tries.items()) if key in self._due},
        }

    def load_state_dict(self, state: State) -> None:
        """Go on from what `state_dict` returned."""
        self.seed(state["seed"])
        self._times = state["times"] - 1
        self._begin(state["due"], state["tries"])
        for stream, taken in zip((self._usual, self._louder), state["taken"], strict=True):
            if stream is not None:
                stream.skip(taken)

    def _drawn(self) -> Offer:
        """Return a task that has something that is due, of the pool or none of it."""
        stream = self._louder or self._usual
        for _ in range(MISSES):
            found = stream.take()
            if not self._has(found.word).isdisjoint(self._due):
                return found._replace(probability=found.probability / self._share)
        raise NotFound(f"none of {MISSES} tasks drawn in a row has {self._what} that are due; give a larger space")

    def _has(self, word: Word) -> frozenset[str]:
        """Return the names of a task, or its pairs."""
        names = self._keys.names(word)
        return frozenset(names if self._what == "names" else map(">".join, pairwise(names)))

    def _begin(self, due: Sequence[str], tries: Mapping[str, int]) -> None:
        """Draw what is due from now on, where that is rare by other weights; the share of tasks that have it is exact.

        The weight of all tasks is a polynomial in that of what is due whose constant term is the weight of those
        without it; so the share of the others comes as near to 1 as is asked for. A name that is also that of a class
        or an entity cannot be weighed up: what is due with it alone is waited for.
        """
        self._due, self._tries, self._louder = frozenset(due), dict(tries), None
        spaces = map(self._pool.at, self._pool.space.lengths)
        without = sum((space.sampling(weights=self._base).weight_without(due) for space in spaces), start=Fraction(0))
        self._share = 1 - without / self._usual.total
        loud = [key for key in due if self._what == "pairs" or key in self._keys.weighable]
        factor = 1
        while loud and self._share < (RARE if factor == 1 else HALF):
            factor *= LOUDER
            weights = times(self._base, dict.fromkeys(loud, Fraction(factor)))
            self._louder = Stream(self._pool, weights, derived(self._seed, "due", self._times))
            self._share = 1 - without / self._louder.total
        self._times += 1
