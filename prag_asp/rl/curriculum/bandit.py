"""An EXP3 bandit whose arms are action names, pairs and classes: a pull is a batch of tasks that favours one arm."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from decimal import Context, Decimal
from fractions import Fraction

from prag_asp.errors import QueryError
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

EMPHASIS = 8
"""The factor that multiplies the weight of the name, pair or class of an arm while that arm is pulled."""

PARTS = 10**12
"""The weights of arms are multiples of the largest weight / `PARTS`, so that they are the same on every machine."""

DIGITS = Context(prec=40)


@dataclass(frozen=True)
class BanditCurriculum:
    """EXP3 over arms that are action names, pairs of names, or classes.

    A pull of an arm is a `lot` of episodes, whose tasks are sampled with the arm's weight multiplied by `EMPHASIS`. The
    gain, between 0 and 1, is the absolute learning progress: the difference between the success rates of the arm's
    subgoals in this lot and in the last earlier lot that attempted any of them.

    `exploration` is the gamma of EXP3. For K arms and g pulls, the expected total gain is less than that of the best
    arm by at most (e - 1) gamma G + K ln(K) / gamma, where G is the total gain of the best arm; with the best gamma,
    min(1, sqrt(K ln(K) / ((e - 1) g))), that is 2.63 sqrt(g K ln K): Auer, Cesa-Bianchi, Freund and Schapire, "The
    nonstochastic multiarmed bandit problem", SIAM Journal on Computing 32 (2002), theorem 3.1 and corollary 3.2. The
    comparison uses the gains that occurred, because the agent's learning depends on its tasks.

    Raises:
        QueryError: the share is not in (0, 1], or the lot is less than 1.
    """

    exploration: Number | float = 0.2
    lot: int = 20

    def __post_init__(self) -> None:
        parse_share("exploration", self.exploration, positive=True)
        parse_count("lot", self.lot)

    def task_sampler(self, pool: TaskPool) -> BanditSampler:
        """Return a sampler of the tasks of a pool.

        Raises:
            QueryError: all tasks have the same names and classes.
        """
        return BanditSampler(self, pool)


class BanditSampler:
    """A sampler of tasks with the weights of the current arm."""

    def __init__(self, curriculum: BanditCurriculum, pool: TaskPool):
        self._curriculum, self._pool = curriculum, pool
        self._exploration = parse_share("exploration", curriculum.exploration, positive=True)
        self._keys = ActionKeys(pool.space.domain.facts)
        self._base = dict(pool.space.domain.settings.weights)
        self.arms = _arms(pool)
        self.seed(0)

    def seed(self, seed: int) -> None:
        """Reset the sampler."""
        self._seed = seed
        self._gained = [Fraction(0)] * len(self.arms)
        self._before: dict[str, Fraction] = {}
        self._tried: dict[str, tuple[int, int]] = {}
        self._pull(0)

    @property
    def probabilities(self) -> list[Fraction]:
        """The exact probability of each arm in the next pull; gains and weights are rounded to 12 digits."""
        most = max(self._gained)
        rate = self._exploration / len(self.arms)
        weights = [int(PARTS * _exponential(rate * (gained - most))) for gained in self._gained]
        total = sum(weights)
        return [(1 - self._exploration) * Fraction(weight, total) + rate for weight in weights]

    def propose(self) -> Proposal:
        """Return a task sampled with the weights of the current arm, and its probability."""
        return self._pool.next_in_pool(self._stream.take)

    def note_feasibility(self, word: Word, feasible: bool) -> None:
        """Do nothing."""

    def update(self, result: EpisodeResult) -> None:
        """Record the attempts; after each lot, update the gains and pull an arm."""
        for attempt in result.attempts:
            for key in self._keys.of(attempt):
                tried, reached = self._tried.get(key, (0, 0))
                self._tried[key] = tried + 1, reached + attempt.reached
        self._reported += 1
        if self._reported == self._curriculum.lot:
            self._learn()
            self._pull(self._lots + 1)

    def summary(self) -> Mapping[str, int | str]:
        """Return the number of the current lot and the current arm."""
        return {"lot": self._lots, "arm": self.arms[self._arm]}

    def state_dict(self) -> State:
        """Return the state as JSON values."""
        return {
            "seed": self._seed,
            "lots": self._lots,
            "reported": self._reported,
            "taken": self._stream.taken,
            "gained": list(map(str, self._gained)),
            "before": {key: str(share) for key, share in sorted(self._before.items())},
            "tried": {key: list(tried) for key, tried in sorted(self._tried.items())},
        }

    def load_state_dict(self, state: State) -> None:
        """Continue from a state returned by `state_dict`."""
        self._seed = state["seed"]
        self._gained = list(map(Fraction, state["gained"]))
        self._before = {key: Fraction(share) for key, share in state["before"].items()}
        self._pull(state["lots"])
        self._reported = state["reported"]
        self._tried = {key: (tried, reached) for key, (tried, reached) in state["tried"].items()}
        self._stream.skip(state["taken"])

    def _learn(self) -> None:
        """Add the gain of the current arm, divided by the probability of its pull."""
        shares = {key: Fraction(reached, tried) for key, (tried, reached) in self._tried.items()}
        arm = self.arms[self._arm]
        if arm in shares:
            gain = abs(shares[arm] - self._before.get(arm, 0)) / self._probability
            self._gained[self._arm] += Fraction(round(gain * PARTS), PARTS)
        self._before.update(shares)

    def _pull(self, lots: int) -> None:
        """Pull an arm."""
        self._lots, self._reported = lots, 0
        self._tried = {}
        probabilities = self.probabilities
        self._arm = sample_index(probabilities, self._seed, "arm", lots)
        self._probability = probabilities[self._arm]
        weights = scale_weights(self._base, {self.arms[self._arm]: Fraction(EMPHASIS)})
        self._stream = ProposalStream(self._pool, weights, derive_seed(self._seed, "lot", lots))


def _arms(pool: TaskPool) -> tuple[str, ...]:
    """Return the names, pairs and classes in the tasks of a pool's space.

    Raises:
        QueryError: there are fewer than two arms.
    """
    arms: set[str] = set()
    for length in reversed(pool.lengths):
        figures = pool.at(length).statistics()
        arms |= {*figures.expected_names, *map(">".join, figures.expected_pairs), *figures.contains_class}
    keys = ActionKeys(pool.space.domain.facts)
    arms = {key for key in arms if ">" in key or key in keys.weighable}
    if len(arms) < 2:
        raise QueryError("a bandit needs two arms: action names, pairs or classes; give a space that has more")
    return tuple(sorted(arms))


def _exponential(number: Fraction) -> Decimal:
    """Return e to the power of a number, with the same digits on every machine."""
    return DIGITS.exp(DIGITS.divide(Decimal(number.numerator), Decimal(number.denominator)))
