"""The criterion for the next step of a curriculum: the success rate of the most recent episodes."""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass, field
from fractions import Fraction

from prag_asp.exact_numbers import Number
from prag_asp.rl.curriculum.task_pool import parse_count, parse_share


@dataclass
class Mastery:
    """The results of the last `window` episodes, and the required success rate `threshold`."""

    threshold: Fraction
    window: int
    ends: deque[bool] = field(default_factory=deque)

    @classmethod
    def of(cls, threshold: Number | float, window: int) -> Mastery:
        """Return a criterion without any results.

        Raises:
            QueryError: the threshold is not in (0, 1], or the window is less than 1.
        """
        most = parse_count("window", window)
        return cls(parse_share("threshold", threshold, positive=True), most, deque(maxlen=most))

    def add(self, success: bool) -> bool:
        """Add a result and return whether the success rate is reached; if it is, clear the results."""
        self.ends.append(success)
        enough = len(self.ends) == self.window and sum(self.ends) >= self.threshold * self.window
        if enough:
            self.ends.clear()
        return enough

    def load(self, ends: Sequence[bool]) -> None:
        """Replace the results."""
        self.ends.clear()
        self.ends.extend(ends)


def review_shares(review: Fraction, places: int) -> list[Fraction]:
    """Return probabilities, of which all but the last are equal and sum to `review`; a single probability is 1."""
    if places == 1:
        return [Fraction(1)]
    return [review / (places - 1)] * (places - 1) + [1 - review]
