"""A curriculum of growing length, which begins with short tasks."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from prag_asp.exact_numbers import Number
from prag_asp.rl.curriculum.mastery import Mastery, review_shares
from prag_asp.rl.curriculum.task_pool import Proposal, TaskPool, Word, derive_seed, parse_share, sample_index
from prag_asp.rl.curriculum.task_sampler import EpisodeResult, State, skip


@dataclass(frozen=True)
class LengthCurriculum:
    """Begin with the shortest tasks of a space, and proceed to longer ones as the agent succeeds.

    The next length is added when the success rate of the last `window` episodes with tasks of the longest current
    length reaches `threshold`. A share `review` of the tasks have shorter lengths, chosen uniformly. Tasks of one
    length are sampled with the weights of the domain.

    Raises:
        QueryError: a share is not between 0 and 1, or the window is less than 1.
    """

    threshold: Number | float = 0.8
    window: int = 50
    review: Number | float = 0.2

    def __post_init__(self) -> None:
        Mastery.of(self.threshold, self.window)
        parse_share("review", self.review)

    def task_sampler(self, pool: TaskPool) -> LengthSampler:
        """Return a sampler of the tasks of a pool."""
        return LengthSampler(self, pool)


class LengthSampler:
    """A sampler of tasks of growing length."""

    def __init__(self, curriculum: LengthCurriculum, pool: TaskPool):
        self._pool, self._lengths = pool, pool.lengths
        self._review = parse_share("review", curriculum.review)
        self._mastery = Mastery.of(curriculum.threshold, curriculum.window)
        self.seed(0)

    def seed(self, seed: int) -> None:
        """Reset the sampler, with a new seed."""
        self._seed, self._reached, self._drawn = seed, 0, 0
        self._taken = [0] * len(self._lengths)
        self._proposals: dict[int, Iterator[Proposal]] = {}
        self._mastery.load(())

    def propose(self) -> Proposal:
        """Return a task of one of the current lengths."""
        shares = review_shares(self._review, self._reached + 1)
        place = sample_index(shares, self._seed, "length", self._drawn)
        proposal = next(self._of_length(place))
        self._drawn += 1
        self._taken[place] += 1
        return proposal._replace(probability=shares[place] * proposal.probability)

    def note_feasibility(self, word: Word, feasible: bool) -> None:
        """Do nothing."""

    def update(self, result: EpisodeResult) -> None:
        """Record the result, and proceed to the next length if enough episodes of the longest length succeeded."""
        if result.stages == self._lengths[self._reached] and self._mastery.add(result.success):
            self._reached = min(self._reached + 1, len(self._lengths) - 1)

    def summary(self) -> Mapping[str, int | str]:
        """Return the greatest current length."""
        return {"length": self._lengths[self._reached]}

    def state_dict(self) -> State:
        """Return the state as JSON values."""
        return {
            "seed": self._seed,
            "reached": self._reached,
            "drawn": self._drawn,
            "taken": list(self._taken),
            "ends": list(self._mastery.ends),
        }

    def load_state_dict(self, state: State) -> None:
        """Continue from a state returned by `state_dict`."""
        self.seed(state["seed"])
        self._reached, self._drawn, self._taken = state["reached"], state["drawn"], list(state["taken"])
        self._mastery.load(state["ends"])
        for place, taken in enumerate(self._taken):
            if taken:
                skip(self._of_length(place), taken)

    def _of_length(self, place: int) -> Iterator[Proposal]:
        """Return the proposals of one length."""
        if place not in self._proposals:
            length = self._lengths[place]
            seed = derive_seed(self._seed, "of length", length)
            self._proposals[place] = self._pool.proposals(seed=seed, length=length)
        return self._proposals[place]
