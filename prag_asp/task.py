"""A task: a plan with its initial state, its goal and one subgoal for each action."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from prag_asp.atom import Atom

State = Mapping[Atom, bool]
"""What is known of a state: fluents that it does not hold are unknown (any value will do)."""


@dataclass(frozen=True)
class Task:
    """A plan together with what is known of every state that it passes.

    `entities` maps each entity that an action or a known fluent names to its class. `states[k]` is what is known
    after action k+1 and `subgoals[k]` what that action itself makes true or false, so both are as long as `actions`.
    `goal` is what has to hold at the end. `log_probability` is the natural logarithm of the probability with
    which the task was drawn, or None where it was not drawn.
    """

    domain: str
    actions: tuple[Atom, ...]
    entities: Mapping[str, str]
    initial: State
    states: tuple[State, ...]
    subgoals: tuple[State, ...]
    goal: State
    log_probability: float | None = None

    def __len__(self) -> int:
        return len(self.actions)

    def __str__(self) -> str:
        return " ".join(map(str, self.actions))

    @property
    def skeleton(self) -> tuple[str, ...]:
        """The names of the actions, in order."""
        return tuple(action.name for action in self.actions)
