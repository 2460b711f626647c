"""A curriculum based on novelty: tasks, skeletons, names or pairs that have not been sampled come first."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import count, pairwise
from typing import Literal, get_args

from prag_asp.errors import NotFound, QueryError
from prag_asp.random_bits import SeededBits
from prag_asp.rl.curriculum.proposal_stream import ProposalStream, scale_weights
from prag_asp.rl.curriculum.task_pool import Proposal, TaskPool, Word, derive_seed
from prag_asp.rl.curriculum.task_sampler import ActionKeys, EpisodeResult, State, TaskSampler
from prag_asp.space.distinct_sampling import MISSES
from prag_asp.space.engines import Draw
from prag_asp.space.parts.shuffle import Shuffle
from prag_asp.space.sampling.samplers import SkeletonSampler
from prag_asp.wording import unknown

What = Literal["tasks", "skeletons", "names", "pairs"]
WHAT: tuple[What, ...] = get_args(What)

TRIES = 20
"""The number of infeasible tasks with a name or pair after which the name or pair counts as covered, because it may
always be infeasible.
"""

MISSED = 1000
"""The number of samples outside the pool after which a new pass begins, because the part may have no task with a due
name or pair.
"""

RARE = Fraction(1, 16)
"""The share of samples with a due name or pair below which the weights of due names or pairs are increased."""

EMPHASIS, HALF = 64, Fraction(1, 2)
"""The factor that increases the weights of due names or pairs; it is applied repeatedly until at least the share `HALF`
of the samples have one of them.
"""


@dataclass(frozen=True)
class NoveltyCurriculum:
    """Sample new items first; `what` selects the items: "tasks", "skeletons", action "names", or "pairs" of names.

    Tasks and skeletons are sampled without replacement, in uniformly random order; for each skeleton, one of its tasks
    is sampled by weight. With names or pairs, each task has a due name or pair, that is, one that has occurred neither
    in a feasible task nor in `TRIES` infeasible tasks. When nothing is due, or the part seems to have no task with a
    due name or pair, a new pass begins.

    Raises:
        QueryError: `what` is none of these.
    """

    what: What = "pairs"

    def __post_init__(self) -> None:
        if self.what not in WHAT:
            raise QueryError(unknown(str(self.what), WHAT, "kind of novelty"))

    def task_sampler(self, pool: TaskPool) -> TaskSampler:
        """Return a sampler of the tasks of a pool.

        Raises:
            QueryError: the pool has no pairs of actions.
        """
        if self.what == "tasks":
            return PassSampler(_Tasks(pool), pool)
        if self.what == "skeletons":
            return PassSampler(_Skeletons(pool), pool)
        return CoverageSampler(pool, self.what)


class _Tasks:
    """The tasks of a pool, numbered."""

    def __init__(self, pool: TaskPool):
        self._pool = pool
        self._stretches = _stretches(pool, [pool.at(length).count() for length in pool.lengths])
        self.size = pool.part.size if pool.part is not None else sum(size for _, size in self._stretches)

    def word(self, number: int, seed: int) -> tuple[Word, Fraction]:
        """Return the task with a given number."""
        if self._pool.part is not None:
            return self._pool.part.word(number), Fraction(1)
        length, rank = _found(self._stretches, number)
        return self._pool.at(length).plan_at(rank), Fraction(1)


class _Skeletons:
    """The skeletons of a pool, numbered."""

    def __init__(self, pool: TaskPool):
        self._pool = pool
        self._samplers: dict[int, SkeletonSampler] = {}
        for length in reversed(pool.lengths):  # the exploration for the greatest length covers all lengths
            sampler = pool.at(length).sampling(over="skeletons").sampler()
            assert isinstance(sampler, SkeletonSampler)
            self._samplers[length] = sampler
        self._stretches = _stretches(pool, [self._samplers[length].count for length in pool.lengths])
        self.size = sum(size for _, size in self._stretches)

    def word(self, number: int, seed: int) -> tuple[Word, Fraction]:
        """Return a sampled task whose skeleton has a given number, and its probability given this skeleton."""
        length, rank = _found(self._stretches, number)
        letters, probability = self._samplers[length].of_rank(rank, SeededBits(seed), number)
        names = self._pool.at(length).action_texts()
        return tuple([names[letter] for letter in letters]), probability


def _stretches(pool: TaskPool, sizes: Sequence[int]) -> list[tuple[int, int]]:
    """Return each length with its number of tasks or skeletons."""
    return list(zip(pool.lengths, sizes, strict=True))


def _found(stretches: Sequence[tuple[int, int]], number: int) -> tuple[int, int]:
    """Return the length of the item with a given number, and the number of this item among those of that length."""
    for length, size in stretches:
        if number < size:
            return length, number
        number -= size
    raise AssertionError("a number is below the sum of all sizes")


class PassSampler:
    """A sampler of tasks or skeletons in passes: each one once, in random order, before any is repeated."""

    def __init__(self, things: _Tasks | _Skeletons, pool: TaskPool):
        self._things, self._pool = things, pool
        self.seed(0)

    def seed(self, seed: int) -> None:
        """Reset the sampler."""
        self._go_on(seed, 0)

    def propose(self) -> Proposal:
        """Return the next task, with its conditional probability given all tasks before it."""
        return self._pool.next_in_pool(self._next)

    def note_feasibility(self, word: Word, feasible: bool) -> None:
        """Do nothing."""

    def update(self, result: EpisodeResult) -> None:
        """Do nothing."""

    def summary(self) -> Mapping[str, int | str]:
        """Return the number of the pass, the number of samples in it, and the total number."""
        times, place = divmod(self._drawn, self._things.size)
        return {"pass": times + 1, "drawn": str(place), "of": str(self._things.size)}

    def state_dict(self) -> State:
        """Return the state as JSON values."""
        return {"seed": self._seed, "drawn": self._drawn}

    def load_state_dict(self, state: State) -> None:
        """Continue from a state returned by `state_dict`."""
        self._go_on(state["seed"], state["drawn"])

    def _go_on(self, seed: int, drawn: int) -> None:
        self._seed, self._drawn = seed, drawn
        self._draws = self._pool.batched(self._coming(seed, drawn))

    def _next(self) -> Proposal:
        """Return the next task, whether or not it is in the pool."""
        self._drawn += 1
        draw = next(self._draws)
        return Proposal(draw.word, draw.probability)

    def _coming(self, seed: int, drawn: int) -> Iterator[Draw]:
        """Yield the samples after the first `drawn` samples."""
        for number in count(drawn):
            times, place = divmod(number, self._things.size)
            own = derive_seed(seed, "pass", times)
            word, probability = self._things.word(Shuffle(self._things.size, own)[place], own)
            yield Draw(word, probability / (self._things.size - place))


class CoverageSampler:
    """A sampler of tasks with a name or pair that is due."""

    def __init__(self, pool: TaskPool, what: What):
        self._pool, self._what = pool, what
        self._keys = ActionKeys(pool.space.domain.facts)
        names: set[str] = set()
        for length in pool.lengths:
            figures = pool.at(length).statistics()
            names |= set(figures.expected_names) if what == "names" else set(map(">".join, figures.expected_pairs))
        if not names:
            raise QueryError(f"no task of the space has {what}; give a space of another length, or another curriculum")
        self._all = tuple(sorted(names))
        self._base = dict(pool.space.domain.settings.weights)
        self.seed(0)

    def seed(self, seed: int) -> None:
        """Reset the sampler."""
        self._seed, self._times = seed, 0
        self._usual = ProposalStream(self._pool, self._base, derive_seed(seed, "usual"))
        self._begin(self._all, {})

    def propose(self) -> Proposal:
        """Return a task with a due name or pair, with its probability among all such tasks."""
        try:
            return self._pool.next_in_pool(self._drawn, MISSED)
        except NotFound:
            if len(self._due) == len(self._all):
                return self._pool.next_in_pool(self._drawn)
        self._begin(self._all, {})
        proposal = self._pool.next_in_pool(self._drawn)
        return proposal._replace(passed=MISSED + proposal.passed)

    def note_feasibility(self, word: Word, feasible: bool) -> None:
        """Mark the names or pairs of a feasible task as covered, and count those of an infeasible one."""
        had = self._has(word) & self._due
        for key in had:
            self._tries[key] = TRIES if feasible else self._tries.get(key, 0) + 1
        over = {key for key in had if self._tries[key] >= TRIES}
        if over:
            left = [key for key in self._all if key in self._due and key not in over]
            self._begin(left or self._all, self._tries if left else {})

    def update(self, result: EpisodeResult) -> None:
        """Do nothing."""

    def summary(self) -> Mapping[str, int | str]:
        """Return the number of due names or pairs, and the number of all names or pairs."""
        return {"due": len(self._due), "of": len(self._all)}

    def state_dict(self) -> State:
        """Return the state as JSON values."""
        return {
            "seed": self._seed,
            "times": self._times,
            "taken": [self._usual.taken, self._emphasized.taken if self._emphasized else 0],
            "due": sorted(self._due),
            "tries": {key: tries for key, tries in sorted(self._tries.items()) if key in self._due},
        }

    def load_state_dict(self, state: State) -> None:
        """Continue from a state returned by `state_dict`."""
        self.seed(state["seed"])
        self._times = state["times"] - 1
        self._begin(state["due"], state["tries"])
        for stream, taken in zip((self._usual, self._emphasized), state["taken"], strict=True):
            if stream is not None:
                stream.skip(taken)

    def _drawn(self) -> Proposal:
        """Return a task with a due name or pair, whether or not it is in the pool."""
        stream = self._emphasized or self._usual
        for _ in range(MISSES):
            proposal = stream.take()
            if not self._has(proposal.word).isdisjoint(self._due):
                return proposal._replace(probability=proposal.probability / self._share)
        raise NotFound(f"none of {MISSES} tasks drawn in a row has {self._what} that are due; give a larger space")

    def _has(self, word: Word) -> frozenset[str]:
        """Return the names or the pairs of a task."""
        names = self._keys.names(word)
        return frozenset(names if self._what == "names" else map(">".join, pairwise(names)))

    def _begin(self, due: Sequence[str], tries: Mapping[str, int]) -> None:
        """Begin to sample due names or pairs, with larger weights if they are rare; compute their exact share.

        The total weight of all tasks is a polynomial in the weight factor of the due names or pairs. Its constant term
        is the weight of the tasks without them, so the share of the tasks with due names or pairs can approach 1. The
        weight of an action name that is also the name of a class or an entity cannot be increased, so the sampler waits
        for such names.
        """
        self._due, self._tries, self._emphasized = frozenset(due), dict(tries), None
        spaces = map(self._pool.at, self._pool.space.lengths)
        without = sum((space.sampling(weights=self._base).weight_without(due) for space in spaces), start=Fraction(0))
        self._share = 1 - without / self._usual.total
        loud = [key for key in due if self._what == "pairs" or key in self._keys.weighable]
        factor = 1
        while loud and self._share < (RARE if factor == 1 else HALF):
            factor *= EMPHASIS
            weights = scale_weights(self._base, dict.fromkeys(loud, Fraction(factor)))
            self._emphasized = ProposalStream(self._pool, weights, derive_seed(self._seed, "due", self._times))
            self._share = 1 - without / self._emphasized.total
        self._times += 1
