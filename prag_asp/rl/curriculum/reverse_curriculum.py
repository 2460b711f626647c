"""A reverse curriculum, in which the first episodes begin near the goal."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction

from prag_asp.exact_numbers import Number
from prag_asp.rl.curriculum.mastery import Mastery, review_shares
from prag_asp.rl.curriculum.task_pool import parse_share, sample_index
from prag_asp.rl.curriculum.task_sampler import EpisodeResult, State


@dataclass(frozen=True)
class ReverseCurriculum:
    """Begin with the last subgoal of each task, then with the last two, and so on, back to whole tasks.

    One more subgoal is added when the success rate of the last `window` episodes that began with the earliest subgoal
    reaches `threshold`. A share `review` of the episodes begin with a later subgoal, chosen uniformly. The idea is from
    Florensa, Held, Wulfmeier, Zhang and Abbeel ("Reverse curriculum generation for reinforcement learning", 2017); here
    the initial states are those of witnesses.

    Raises:
        QueryError: a share is not between 0 and 1, or the window is less than 1.
    """

    threshold: Number | float = 0.8
    window: int = 50
    review: Number | float = 0.2

    def __post_init__(self) -> None:
        Mastery.of(self.threshold, self.window)
        parse_share("review", self.review)

    def subgoal_sampler(self) -> ReverseSampler:
        """Return a sampler of initial subgoals."""
        return ReverseSampler(self)


class ReverseSampler:
    """A sampler of initial subgoals, from the last one back to the first."""

    def __init__(self, curriculum: ReverseCurriculum):
        self._review = parse_share("review", curriculum.review)
        self._mastery = Mastery.of(curriculum.threshold, curriculum.window)
        self.seed(0)

    def seed(self, seed: int) -> None:
        """Reset the sampler."""
        self._seed, self._back, self._drawn, self._longest = seed, 1, 0, 1
        self._mastery.load(())

    def stage(self, stages: int) -> tuple[int, Fraction]:
        """Return the index of the initial subgoal among the `stages` subgoals of a task, and its probability."""
        shares = review_shares(self._review, min(self._back, stages))
        place = sample_index(shares, self._seed, "stage", self._drawn)
        self._drawn += 1
        return stages - 1 - place, shares[place]

    def update(self, result: EpisodeResult) -> None:
        """Record the result, and go back by one more subgoal if enough episodes succeeded."""
        self._longest = max(self._longest, result.stages)
        if result.stages - result.first == self._back and self._mastery.add(result.success):
            self._back = min(self._back + 1, self._longest)

    def summary(self) -> Mapping[str, int | str]:
        """Return the maximum number of subgoals from the start of an episode to the end of the task."""
        return {"back": self._back}

    def state_dict(self) -> State:
        """Return the state as JSON values."""
        return {
            "seed": self._seed,
            "back": self._back,
            "drawn": self._drawn,
            "longest": self._longest,
            "ends": list(self._mastery.ends),
        }

    def load_state_dict(self, state: State) -> None:
        """Continue from a state returned by `state_dict`."""
        self.seed(state["seed"])
        self._back, self._drawn, self._longest = state["back"], state["drawn"], state["longest"]
        self._mastery.load(state["ends"])
