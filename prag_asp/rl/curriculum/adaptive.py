"""What the agent makes progress with more often: its successes become weights of the exact draw."""

from __future__ import annotations

from collections import deque
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction

from prag_asp.rl.curriculum.course import Episode, Keys, State
from prag_asp.rl.curriculum.stream import Stream, times
from prag_asp.rl.curriculum.task_pool import Offer, Pool, Word, chosen, derived, share_of, whole_of
from prag_asp.space.weights.weights import Number

EMPHASIS = 4
"""How much more often than one that makes no progress an action is drawn that makes most."""

STEPS = 16
"""Weights are multiples of one of so many parts, so that the numbers that are counted with stay small."""


@dataclass(frozen=True)
class Adaptive:
    """Tasks of what the agent is getting better or worse at, by action name, pair of names, and class.

    The progress with each is by how much the share of subgoals that were reached differs between the newer and the
    older half of the last `window` attempts; what was tried too seldom to tell counts as the greatest progress. A name,
    pair or class weighs from 1, without progress, to `EMPHASIS`, with the most that there is, beside the weights of the
    domain. After each `lot` of episodes the weights are set anew.

    A share of `exploration` of the draws is by the weights of the domain alone: 1 explores only, near 0 exploits. So no
    task is ever less probable than that share of what it is without a curriculum, and no importance weight larger than
    its inverse. The absolute learning progress is that of Matiisen, Oliver, Cohen and Schulman ("Teacher-student
    curriculum learning", 2017); no bound of regret is known for it (`Bandit` has one).

    Raises:
        QueryError: the share is none above 0, or a number no whole one of at least 1.
    """

    exploration: Number | float = 0.2
    lot: int = 100
    window: int = 40

    def __post_init__(self) -> None:
        share_of("exploration", self.exploration, least=True)
        whole_of("lot", self.lot)
        whole_of("window", self.window)

    def course(self, pool: Pool) -> AdaptiveCourse:
        """Return a course through the tasks of a pool."""
        return AdaptiveCourse(self, pool)


class AdaptiveCourse:
    """A course by learning progress."""

    def __init__(self, asked: Adaptive, pool: Pool):
        self._asked, self._pool = asked, pool
        exploration = share_of("exploration", asked.exploration, least=True)
        self._shares = exploration, 1 - exploration
        self._keys = Keys(pool.space.domain.facts)
        self._base = dict(pool.space.domain.settings.weights)
        self.seed(0)

    def seed(self, seed: int) -> None:
        """Begin anew."""
        self._seed = seed
        self._ends: dict[str, deque[bool]] = {}
        self._usual = Stream(self._pool, self._base, derived(seed, "usual"))
        self._begin(0, {})

    def offer(self) -> Offer:
        """Return a task by the weights as they are now, or by those of the domain, with its probability by both."""
        return self._pool.kept(self._drawn)

    def settle(self, word: Word, feasible: bool) -> None:
        """Nothing depends on it."""

    def report(self, episode: Episode) -> None:
        """Note what was reached; after a lot, weigh anew."""
        for attempt in episode.attempts:
            for key in self._keys.of(attempt):
                self._ends.setdefault(key, deque(maxlen=self._asked.window)).append(attempt.reached)
        self._reported += 1
        if self._reported == self._asked.lot:
            self._begin(self._lots + 1, self._weights())

    def told(self) -> Mapping[str, int | str]:
        """Return how often it has weighed anew."""
        return {"lot": self._lots}

    def state_dict(self) -> State:
        """Return what it has come to."""
        return {
            "seed": self._seed,
            "lots": self._lots,
            "reported": self._reported,
            "taken": [self._usual.taken, self._now.taken if self._now else 0],
            "weights": {key: str(weight) for key, weight in self._own.items()},
            "ends": {key: list(ends) for key, ends in sorted(self._ends.items())},
        }

    def load_state_dict(self, state: State) -> None:
        """Go on from what `state_dict` returned."""
        self.seed(state["seed"])
        self._ends = {key: deque(ends, maxlen=self._asked.window) for key, ends in state["ends"].items()}
        self._begin(state["lots"], {key: Fraction(weight) for key, weight in state["weights"].items()})
        self._reported = state["reported"]
        for stream, taken in zip((self._usual, self._now), state["taken"], strict=True):
            if stream is not None:
                stream.skip(taken)

    def _drawn(self) -> Offer:
        """Return a task of the pool or none of it: what is passed over was drawn by both, too."""
        if self._now is None:
            return self._usual.take()
        both = self._usual, self._now
        which = chosen(self._shares, self._seed, "which", self._usual.taken, self._lots, self._now.taken)
        found = both[which].take()
        other = both[1 - which].probability(found.word)
        return found._replace(probability=self._shares[which] * found.probability + self._shares[1 - which] * other)

    def _weights(self) -> dict[str, Fraction]:
        """Return how much more often each name, pair and class is to be drawn, by its progress."""
        progress = {key: progress_of(list(ends), self._asked.window) for key, ends in sorted(self._ends.items())}
        most = max(progress.values(), default=Fraction(0))
        if not most:
            return {}
        found = {key: Fraction(round((EMPHASIS - 1) * STEPS * each / most), STEPS) for key, each in progress.items()}
        return {key: 1 + more for key, more in found.items() if more}

    def _begin(self, lots: int, own: dict[str, Fraction]) -> None:
        """Draw with other weights from now on."""
        self._lots, self._reported, self._own = lots, 0, own
        self._now = Stream(self._pool, times(self._base, own), derived(self._seed, "lot", lots)) if own else None


def progress_of(ends: Sequence[bool], window: int) -> Fraction:
    """Return by how much the share of successes differs between the halves of some ends; 1 where they are too few."""
    half = len(ends) // 2
    if 2 * half < window - 1 or not half:
        return Fraction(1)
    return abs(Fraction(sum(ends[-half:]), half) - Fraction(sum(ends[:half]), half))
