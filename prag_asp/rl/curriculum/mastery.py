"""When an agent may go on: the share of its last episodes that ended well."""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass, field
from fractions import Fraction

from prag_asp.rl.curriculum.task_pool import share_of, whole_of
from prag_asp.space.weights.weights import Number


@dataclass
class Mastery:
    """The ends of the last `window` episodes, and the `threshold` share of them that have to be good."""

    threshold: Fraction
    window: int
    ends: deque[bool] = field(default_factory=deque)

    @classmethod
    def of(cls, threshold: Number | float, window: int) -> Mastery:
        """Return one that has heard of no episode.

        Raises:
            QueryError: the threshold is no share above 0, or the window no whole number of at least 1.
        """
        most = whole_of("window", window)
        return cls(share_of("threshold", threshold, least=True), most, deque(maxlen=most))

    def add(self, success: bool) -> bool:
        """Note an end; return whether enough were good, and then forget them all."""
        self.ends.append(success)
        enough = len(self.ends) == self.window and sum(self.ends) >= self.threshold * self.window
        if enough:
            self.ends.clear()
        return enough

    def load(self, ends: Sequence[bool]) -> None:
        """Take the ends of episodes from elsewhere."""
        self.ends.clear()
        self.ends.extend(ends)


def reviewing(review: Fraction, places: int) -> list[Fraction]:
    """Return with which probability each of some places is taken: the last one, or for review one before it."""
    if places == 1:
        return [Fraction(1)]
    return [review / (places - 1)] * (places - 1) + [1 - review]
