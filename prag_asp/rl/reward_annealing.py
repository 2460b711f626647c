"""How much the dense part of a reward counts as an agent learns."""

from __future__ import annotations

from collections import deque
from collections.abc import Mapping
from typing import Any, Literal

from prag_asp.errors import QueryError
from prag_asp.rl.environment_options import is_whole

REMEMBERED = 50
"""Of how many episodes the share of successes is taken."""


class Fading:
    """A share that goes from 1 to 0: over a number of steps, or as the episodes end well.

    It is read between episodes alone: with one share throughout an episode, the shaping remains that of a potential.
    """

    def __init__(self, over: int | Literal["success"]):
        if over != "success" and (not is_whole(over) or over < 1):
            raise QueryError(f"fade {over!r}: give a number of steps, such as 50000, or success")
        self._over = over if over == "success" else int(over)
        self._steps = 0
        self._ends: deque[bool] = deque(maxlen=REMEMBERED)

    def step(self) -> None:
        """Note a step."""
        self._steps += 1

    def end(self, success: bool) -> None:
        """Note how an episode has ended."""
        self._ends.append(success)

    def state_dict(self) -> dict[str, Any]:
        """Return what was noted, of what JSON can write."""
        return {"steps": self._steps, "ends": list(self._ends)}

    def load_state_dict(self, state: Mapping[str, Any]) -> None:
        """Go on from what `state_dict` returned."""
        self._steps = state["steps"]
        self._ends = deque(state["ends"], maxlen=REMEMBERED)

    @property
    def share(self) -> float:
        """The share, between 0 and 1."""
        if self._over == "success":
            return 1.0 - sum(self._ends) / REMEMBERED
        return max(0.0, 1.0 - self._steps / self._over)
