"""Annealing of the dense part of a reward."""

from __future__ import annotations

from collections import deque
from collections.abc import Mapping
from typing import Any, Literal

from prag_asp.errors import QueryError
from prag_asp.rl.environment_options import is_whole

WINDOW = 50
"""The number of episodes over which the success rate is computed: enough for a resolution of 2 percent, and few enough
to follow learning.
"""


class RewardAnnealing:
    """The weight of the dense reward, which falls from 1 to 0 over a number of steps or with the success rate.

    It changes only between episodes, so that the shaping within an episode remains potential-based.
    """

    def __init__(self, over: int | Literal["success"]):
        if over != "success" and (not is_whole(over) or over < 1):
            raise QueryError(f"fade {over!r}: give a number of steps, such as 50000, or success")
        self._over = over if over == "success" else int(over)
        self._steps = 0
        self._ends: deque[bool] = deque(maxlen=WINDOW)

    def step(self) -> None:
        """Count a step."""
        self._steps += 1

    def end(self, success: bool) -> None:
        """Record the result of an episode."""
        self._ends.append(success)

    def state_dict(self) -> dict[str, Any]:
        """Return the state as JSON values."""
        return {"steps": self._steps, "ends": list(self._ends)}

    def load_state_dict(self, state: Mapping[str, Any]) -> None:
        """Continue from a state returned by `state_dict`."""
        self._steps = state["steps"]
        self._ends = deque(state["ends"], maxlen=WINDOW)

    @property
    def share(self) -> float:
        """The weight, between 0 and 1."""
        if self._over == "success":
            return 1.0 - sum(self._ends) / WINDOW
        return max(0.0, 1.0 - self._steps / self._over)
