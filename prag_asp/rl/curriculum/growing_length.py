"""Short tasks first."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from prag_asp.rl.curriculum.course import Episode, State, skip
from prag_asp.rl.curriculum.mastery import Mastery, reviewing
from prag_asp.rl.curriculum.task_pool import Offer, Pool, Word, chosen, derived, share_of
from prag_asp.space.weights.weights import Number


@dataclass(frozen=True)
class Lengths:
    """The shortest tasks of a space first; the next length when enough of the last episodes of the longest ended well.

    A length comes when of the last `window` episodes with tasks of the one before it a share of `threshold` ended well.
    A share of `review` of the draws is of lengths that came before, all alike. Among the tasks of a length, the
    weights of the domain decide.

    Raises:
        QueryError: a share is none, or the window no whole number of at least 1.
    """

    threshold: Number | float = 0.8
    window: int = 50
    review: Number | float = 0.2

    def __post_init__(self) -> None:
        Mastery.of(self.threshold, self.window)
        share_of("review", self.review)

    def course(self, pool: Pool) -> LengthsCourse:
        """Return a course through the tasks of a pool."""
        return LengthsCourse(self, pool)


class LengthsCourse:
    """A course by length."""

    def __init__(self, asked: Lengths, pool: Pool):
        self._pool, self._lengths = pool, pool.lengths
        self._review = share_of("review", asked.review)
        self._mastery = Mastery.of(asked.threshold, asked.window)
        self.seed(0)

    def seed(self, seed: int) -> None:
        """Begin anew."""
        self._seed, self._reached, self._drawn = seed, 0, 0
        self._taken = [0] * len(self._lengths)
        self._offers: dict[int, Iterator[Offer]] = {}
        self._mastery.load(())

    def offer(self) -> Offer:
        """Return a task of a length that has been reached."""
        shares = reviewing(self._review, self._reached + 1)
        place = chosen(shares, self._seed, "length", self._drawn)
        found = next(self._of(place))
        self._drawn += 1
        self._taken[place] += 1
        return found._replace(probability=shares[place] * found.probability)

    def settle(self, word: Word, feasible: bool) -> None:
        """Nothing depends on it."""

    def report(self, episode: Episode) -> None:
        """Go on to the next length where enough episodes of this one ended well."""
        if episode.stages == self._lengths[self._reached] and self._mastery.add(episode.success):
            self._reached = min(self._reached + 1, len(self._lengths) - 1)

    def told(self) -> Mapping[str, int | str]:
        """Return the longest length that has been reached."""
        return {"length": self._lengths[self._reached]}

    def state_dict(self) -> State:
        """Return what it has come to."""
        return {
            "seed": self._seed,
            "reached": self._reached,
            "drawn": self._drawn,
            "taken": list(self._taken),
            "ends": list(self._mastery.ends),
        }

    def load_state_dict(self, state: State) -> None:
        """Go on from what `state_dict` returned."""
        self.seed(state["seed"])
        self._reached, self._drawn, self._taken = state["reached"], state["drawn"], list(state["taken"])
        self._mastery.load(state["ends"])
        for place, taken in enumerate(self._taken):
            if taken:
                skip(self._of(place), taken)

    def _of(self, place: int) -> Iterator[Offer]:
        """Return the draws of a length."""
        if place not in self._offers:
            length = self._lengths[place]
            self._offers[place] = self._pool.offers(seed=derived(self._seed, "of length", length), length=length)
        return self._offers[place]
