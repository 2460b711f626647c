"""A bandit whose arms are names, pairs and classes: each pull is a lot of tasks that have more of one of them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from decimal import Context, Decimal
from fractions import Fraction

from prag_asp.errors import QueryError
from prag_asp.rl.curriculum.course import Episode, Keys, State
from prag_asp.rl.curriculum.stream import Stream, times
from prag_asp.rl.curriculum.task_pool import Offer, Pool, Word, chosen, derived, share_of, whole_of
from prag_asp.space.weights.weights import Number

EMPHASIS = 8
"""How much more often what an arm stands for is drawn while it is pulled."""

PARTS = 10**12
"""Of how many parts the weight of an arm is, beside the largest."""

DIGITS = Context(prec=40)


@dataclass(frozen=True)
class Bandit:
    """EXP3 over what tasks can have more of: a name of an action, a pair of names, or a class.

    A pull of an arm is a `lot` of episodes whose tasks are drawn with `EMPHASIS` times the weight for it. Its gain is
    the absolute learning progress: by how much the share of its subgoals that were reached differs from that in the
    lot before in which some were tried, between 0 and 1.

    `exploration` is the gamma of EXP3. For K arms and g pulls, the gains fall short of those of the best arm by
    (e - 1) gamma G + K ln(K) / gamma at most, in expectation, where G is what the best arm gains; with the best gamma,
    min(1, sqrt(K ln(K) / ((e - 1) g))), that is 2.63 sqrt(g K ln K): Auer, Cesa-Bianchi, Freund and Schapire, "The
    nonstochastic multiarmed bandit problem", SIAM Journal on Computing 32 (2002), theorem 3.1 and corollary 3.2. It
    compares with the gains as they were along the way, for what an agent has learned depends on what it was given.

    Raises:
        QueryError: the share is none above 0, or the lot no whole number of at least 1.
    """

    exploration: Number | float = 0.2
    lot: int = 20

    def __post_init__(self) -> None:
        share_of("exploration", self.exploration, least=True)
        whole_of("lot", self.lot)

    def course(self, pool: Pool) -> BanditCourse:
        """Return a course through the tasks of a pool.

        Raises:
            QueryError: all tasks have the same names and classes.
        """
        return BanditCourse(self, pool)


class BanditCourse:
    """A course by the arms that are pulled."""

    def __init__(self, asked: Bandit, pool: Pool):
        self._asked, self._pool = asked, pool
        self._exploration = share_of("exploration", asked.exploration, least=True)
        self._keys = Keys(pool.space.domain.facts)
        self._base = dict(pool.space.domain.settings.weights)
        self.arms = _arms(pool)
        self.seed(0)

    def seed(self, seed: int) -> None:
        """Begin anew."""
        self._seed = seed
        self._gained = [Fraction(0)] * len(self.arms)
        self._before: dict[str, Fraction] = {}
        self._tried: dict[str, tuple[int, int]] = {}
        self._pull(0)

    @property
    def probabilities(self) -> list[Fraction]:
        """With which probability each arm is pulled next: exact, of gains and weights rounded to 12 digits."""
        most = max(self._gained)
        rate = self._exploration / len(self.arms)
        weights = [int(PARTS * _exponential(rate * (gained - most))) for gained in self._gained]
        total = sum(weights)
        return [(1 - self._exploration) * Fraction(weight, total) + rate for weight in weights]

    def offer(self) -> Offer:
        """Return a task by the weights of the arm that is pulled, with its probability by these."""
        return self._pool.kept(self._stream.take)

    def settle(self, word: Word, feasible: bool) -> None:
        """Nothing depends on it."""

    def report(self, episode: Episode) -> None:
        """Note what was reached; after a lot, learn from it and pull again."""
        for attempt in episode.attempts:
            for key in self._keys.of(attempt):
                tried, reached = self._tried.get(key, (0, 0))
                self._tried[key] = tried + 1, reached + attempt.reached
        self._reported += 1
        if self._reported == self._asked.lot:
            self._learn()
            self._pull(self._lots + 1)

    def told(self) -> Mapping[str, int | str]:
        """Return the number of the lot, and the arm that is pulled."""
        return {"lot": self._lots, "arm": self.arms[self._arm]}

    def state_dict(self) -> State:
        """Return what it has come to."""
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
        """Go on from what `state_dict` returned."""
        self._seed = state["seed"]
        self._gained = list(map(Fraction, state["gained"]))
        self._before = {key: Fraction(share) for key, share in state["before"].items()}
        self._pull(state["lots"])
        self._reported = state["reported"]
        self._tried = {key: (tried, reached) for key, (tried, reached) in state["tried"].items()}
        self._stream.skip(state["taken"])

    def _learn(self) -> None:
        """Give the arm its gain, over the probability with which it was pulled."""
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
        self._arm = chosen(probabilities, self._seed, "arm", lots)
        self._probability = probabilities[self._arm]
        weights = times(self._base, {self.arms[self._arm]: Fraction(EMPHASIS)})
        self._stream = Stream(self._pool, weights, derived(self._seed, "lot", lots))


def _arms(pool: Pool) -> tuple[str, ...]:
    """Return what some tasks of a pool's space have more of than others.

    Raises:
        QueryError: there are no two such things.
    """
    found: set[str] = set()
    for length in reversed(pool.lengths):
        figures = pool.at(length).statistics()
        found |= {*figures.expected_names, *map(">".join, figures.expected_pairs), *figures.contains_class}
    known = Keys(pool.space.domain.facts)
    found = {key for key in found if ">" in key or key in known.weighable}
    if len(found) < 2:
        raise QueryError("a bandit needs two arms: action names, pairs or classes; give a space that has more")
    return tuple(sorted(found))


def _exponential(number: Fraction) -> Decimal:
    """Return e to the power of a number, the same on every machine."""
    return DIGITS.exp(DIGITS.divide(Decimal(number.numerator), Decimal(number.denominator)))
