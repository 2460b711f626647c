"""Near the goal first."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction

from prag_asp.rl.curriculum.course import Episode, State
from prag_asp.rl.curriculum.mastery import Mastery, reviewing
from prag_asp.rl.curriculum.task_pool import chosen, share_of
from prag_asp.space.weights.weights import Number


@dataclass(frozen=True)
class Backwards:
    """The last subgoal of tasks first, then the last two, and so on back to whole tasks.

    One more subgoal comes when of the last `window` episodes that began as far back as any yet a share of `threshold`
    ended well. A share of `review` of the episodes begins nearer to the goal, all such subgoals alike. The idea is that
    of Florensa, Held, Wulfmeier, Zhang and Abbeel ("Reverse curriculum generation for reinforcement learning", 2017);
    here the states to begin with are those of witnesses.

    Raises:
        QueryError: a share is none, or the window no whole number of at least 1.
    """

    threshold: Number | float = 0.8
    window: int = 50
    review: Number | float = 0.2

    def __post_init__(self) -> None:
        Mastery.of(self.threshold, self.window)
        share_of("review", self.review)

    def walk(self) -> BackwardsWalk:
        """Return a course through subgoals."""
        return BackwardsWalk(self)


class BackwardsWalk:
    """A course from the last subgoal to the first."""

    def __init__(self, asked: Backwards):
        self._review = share_of("review", asked.review)
        self._mastery = Mastery.of(asked.threshold, asked.window)
        self.seed(0)

    def seed(self, seed: int) -> None:
        """Begin anew."""
        self._seed, self._back, self._drawn, self._longest = seed, 1, 0, 1
        self._mastery.load(())

    def stage(self, stages: int) -> tuple[int, Fraction]:
        """Return the subgoal to begin with of a task of so many, and with which probability it was drawn."""
        shares = reviewing(self._review, min(self._back, stages))
        place = chosen(shares, self._seed, "stage", self._drawn)
        self._drawn += 1
        return stages - 1 - place, shares[place]

    def report(self, episode: Episode) -> None:
        """Go one subgoal farther back where enough episodes ended well."""
        self._longest = max(self._longest, episode.stages)
        if episode.stages - episode.begun == self._back and self._mastery.add(episode.success):
            self._back = min(self._back + 1, self._longest)

    def told(self) -> Mapping[str, int | str]:
        """Return how many subgoals from the end episodes begin."""
        return {"back": self._back}

    def state_dict(self) -> State:
        """Return what it has come to."""
        return {
            "seed": self._seed,
            "back": self._back,
            "drawn": self._drawn,
            "longest": self._longest,
            "ends": list(self._mastery.ends),
        }

    def load_state_dict(self, state: State) -> None:
        """Go on from what `state_dict` returned."""
        self.seed(state["seed"])
        self._back, self._drawn, self._longest = state["back"], state["drawn"], state["longest"]
        self._mastery.load(state["ends"])
