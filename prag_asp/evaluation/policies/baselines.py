"""Baselines: the scripted oracle, which knows the witness; random actions; and no motion."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from prag_asp.evaluation.policies.policy import Environment, Policy, PolicyMaker
from prag_asp.rl.environment import TaskEnv
from prag_asp.rl.scripted_agent import OraclePolicy


class Oracle:
    """A policy that follows the waypoints of the witness."""

    def __init__(self, env: Environment) -> None:
        """Create the oracle for an environment.

        Raises:
            QueryError: the actions of the environment do not move the tool.
        """
        assert isinstance(env.unwrapped, TaskEnv)
        self._env = env.unwrapped
        self._policy = OraclePolicy(self._env)
        self._stage = -1

    def begin(self, seed: int) -> None:
        """Begin an episode."""
        self._stage = -1

    def __call__(self, observation: Any, info: Mapping[str, Any]) -> NDArray[Any] | None:
        """Return the next action for the current subgoal, or None after its last waypoint."""
        if self._env.stage != self._stage:
            self._stage = self._env.stage
            self._policy.begin()
        return self._policy(observation)


class Random:
    """A policy that samples actions uniformly from the action space."""

    def __init__(self, env: Environment) -> None:
        self._space: Any = env.action_space

    def begin(self, seed: int) -> None:
        """Begin an episode."""
        self._rng = np.random.default_rng(seed)

    def __call__(self, observation: Any, info: Mapping[str, Any]) -> NDArray[Any]:
        """Return a random action."""
        action: NDArray[Any] = self._rng.uniform(self._space.low, self._space.high).astype(self._space.dtype)
        return action


class Zeros:
    """A policy that returns zero actions, and therefore succeeds only at tasks that are solved by waiting."""

    def __init__(self, env: Environment) -> None:
        self._action: NDArray[Any] = np.zeros(env.action_space.shape or (), env.action_space.dtype)

    def begin(self, seed: int) -> None:
        """Begin an episode."""

    def __call__(self, observation: Any, info: Mapping[str, Any]) -> NDArray[Any]:
        """Return zeros."""
        return self._action


MAKERS: Mapping[str, PolicyMaker] = {"oracle": Oracle, "random": Random, "zeros": Zeros}


def maker(text: str) -> PolicyMaker:
    """Return the maker of the baseline with a given name."""

    def make(env: Environment) -> Policy:
        return MAKERS[text](env)

    return make
