"""A curriculum based on learning progress: the weights for exact sampling depend on the results of episodes."""

from __future__ import annotations

from collections import deque
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction

from prag_asp.exact_numbers import Number
from prag_asp.rl.curriculum.proposal_stream import ProposalStream, scale_weights
from prag_asp.rl.curriculum.task_pool import (
    Proposal,
    TaskPool,
    Word,
    derive_seed,
    parse_count,
    parse_share,
    sample_index,
)
from prag_asp.rl.curriculum.task_sampler import ActionKeys, EpisodeResult, State

EMPHASIS = 4
"""The ratio of the weight factors for the greatest progress and for no progress."""

STEPS = 16
"""Weights are multiples of 1 / `STEPS`, so that the integers in exact counts remain small."""


@dataclass(frozen=True)
class AdaptiveCurriculum:
    """Favour tasks with action names, pairs of names and classes whose success rates are changing.

    The progress of a name, pair or class is the difference between the success rates in the newer and the older half of
    its last `window` attempts; if there are too few attempts, the progress counts as 1, the maximum. The weights of the
    domain are multiplied by a factor between 1 (without progress) and `EMPHASIS` (with the greatest progress). After
    each `lot` of episodes, the factors are updated.

    A share `exploration` of the tasks is sampled with the unchanged weights of the domain: at 1, the curriculum only
    explores; near 0, it mostly exploits. The probability of a task is therefore at least that share of its probability
    without a curriculum, and no importance weight exceeds the inverse of the share. Absolute learning progress was
    proposed by Matiisen, Oliver, Cohen and Schulman ("Teacher-student curriculum learning", 2017); no regret bound is
    known for this curriculum (one is known for `BanditCurriculum`).

    Raises:
        QueryError: the share is not in (0, 1], or a number is less than 1.
    """

    exploration: Number | float = 0.2
    lot: int = 100
    window: int = 40

    def __post_init__(self) -> None:
        parse_share("exploration", self.exploration, positive=True)
        parse_count("lot", self.lot)
        parse_count("window", self.window)

    def task_sampler(self, pool: TaskPool) -> AdaptiveSampler:
        """Return a sampler of the tasks of a pool."""
        return AdaptiveSampler(self, pool)


class AdaptiveSampler:
    """A sampler of tasks by learning progress."""

    def __init__(self, curriculum: AdaptiveCurriculum, pool: TaskPool):
        self._curriculum, self._pool = curriculum, pool
        exploration = parse_share("exploration", curriculum.exploration, positive=True)
        self._shares = exploration, 1 - exploration
        self._keys = ActionKeys(pool.space.domain.facts)
        self._base = dict(pool.space.domain.settings.weights)
        self.seed(0)

    def seed(self, seed: int) -> None:
        """Reset the sampler."""
        self._seed = seed
        self._ends: dict[str, deque[bool]] = {}
        self._usual = ProposalStream(self._pool, self._base, derive_seed(seed, "usual"))
        self._begin(0, {})

    def propose(self) -> Proposal:
        """Return a task sampled with the current weights or those of the domain, and its probability in the mixture."""
        return self._pool.next_in_pool(self._drawn)

    def note_feasibility(self, word: Word, feasible: bool) -> None:
        """Do nothing."""

    def update(self, result: EpisodeResult) -> None:
        """Record the attempts; after each lot, update the weights."""
        for attempt in result.attempts:
            for key in self._keys.of(attempt):
                self._ends.setdefault(key, deque(maxlen=self._curriculum.window)).append(attempt.reached)
        self._reported += 1
        if self._reported == self._curriculum.lot:
            self._begin(self._lots + 1, self._weights())

    def summary(self) -> Mapping[str, int | str]:
        """Return the number of updates of the weights."""
        return {"lot": self._lots}

    def state_dict(self) -> State:
        """Return the state as JSON values."""
        return {
            "seed": self._seed,
            "lots": self._lots,
            "reported": self._reported,
            "taken": [self._usual.taken, self._now.taken if self._now else 0],
            "weights": {key: str(weight) for key, weight in self._own.items()},
            "ends": {key: list(ends) for key, ends in sorted(self._ends.items())},
        }

    def load_state_dict(self, state: State) -> None:
        """Continue from a state returned by `state_dict`."""
        self.seed(state["seed"])
        self._ends = {key: deque(ends, maxlen=self._curriculum.window) for key, ends in state["ends"].items()}
        self._begin(state["lots"], {key: Fraction(weight) for key, weight in state["weights"].items()})
        self._reported = state["reported"]
        for stream, taken in zip((self._usual, self._now), state["taken"], strict=True):
            if stream is not None:
                stream.skip(taken)

    def _drawn(self) -> Proposal:
        """Return a task sampled from the mixture, whether or not it is in the pool."""
        if self._now is None:
            return self._usual.take()
        both = self._usual, self._now
        which = sample_index(self._shares, self._seed, "which", self._usual.taken, self._lots, self._now.taken)
        proposal = both[which].take()
        other = both[1 - which].probability(proposal.word)
        return proposal._replace(
            probability=self._shares[which] * proposal.probability + self._shares[1 - which] * other
        )

    def _weights(self) -> dict[str, Fraction]:
        """Return the weight factor of each name, pair and class, computed from its progress."""
        progress = {key: progress_of(list(ends), self._curriculum.window) for key, ends in sorted(self._ends.items())}
        most = max(progress.values(), default=Fraction(0))
        if not most:
            return {}
        factors = {key: Fraction(round((EMPHASIS - 1) * STEPS * each / most), STEPS) for key, each in progress.items()}
        return {key: 1 + more for key, more in factors.items() if more}

    def _begin(self, lots: int, own: dict[str, Fraction]) -> None:
        """Begin a lot with new factors."""
        self._lots, self._reported, self._own = lots, 0, own
        weights, seed = scale_weights(self._base, own), derive_seed(self._seed, "lot", lots)
        self._now = ProposalStream(self._pool, weights, seed) if own else None


def progress_of(ends: Sequence[bool], window: int) -> Fraction:
    """Return the difference between the success rates in the two halves of the results, or 1 for too few results."""
    half = len(ends) // 2
    if 2 * half < window - 1 or not half:
        return Fraction(1)
    return abs(Fraction(sum(ends[-half:]), half) - Fraction(sum(ends[:half]), half))
