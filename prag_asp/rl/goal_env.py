"""The goal interface of an environment: rewards and ends of episodes from goal vectors, for steps or batches."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from types import MethodType
from typing import Any

import gymnasium
import numpy as np
from gymnasium import spaces
from numpy.typing import NDArray

from prag_asp.rl.environment_options import steps_left_of
from prag_asp.rl.goals import PLACES
from prag_asp.rl.rewards import Flags, Floats, reached, step_rewards

Observation = NDArray[np.float32] | dict[str, Any]
"""An observation: a single array, or arrays by name."""


def observation_space(size: int, images: Mapping[str, spaces.Box], *, goals: bool) -> spaces.Space[Any]:
    """Return the space of observations with `size` numbers, with images by name and, if requested, goals."""
    numbers = spaces.Box(-np.inf, np.inf, (size,), np.float32)
    if not goals and not images:
        return numbers
    goal = spaces.Box(-np.inf, np.inf, (2 * PLACES,), np.float32)
    both = {"achieved_goal": goal, "desired_goal": goal} if goals else {}
    return spaces.Dict({"observation": numbers, **both, **images})


class GoalMethod:
    """A method that exists only in environments with goals, because tools recognise these by their methods."""

    def __init__(self, method: Callable[..., Any]) -> None:
        self._method, self.__doc__ = method, method.__doc__

    def __get__(self, env: GoalEnv | None, owner: type | None = None) -> Callable[..., Any]:
        if env is None:
            return self._method
        if not env.has_goals:
            raise AttributeError(f"{self._method.__name__} needs goals in the observations; give goals=True")
        return MethodType(self._method, env)


class GoalEnv(gymnasium.Env[Observation, NDArray[np.float32]]):
    """An environment whose rewards and episode ends follow from goal vectors, as hindsight replay needs.

    A goal has the shape (2 * `PLACES`,): the vector of the moment, then the vector of the previous step. `discount` is
    the discount factor of the potentials, and `share` is the weight of the dense reward. The methods ``compute_...``
    exist only if `has_goals` is true, that is, if observations have goals.
    """

    has_goals: bool
    discount: float
    share: float

    @GoalMethod
    def compute_reward(self, achieved_goal: Floats, desired_goal: Floats, info: Any) -> Any:
        """Return the rewards for steps that lead to `achieved_goal`, shape (..., 2 * `PLACES`); `info` is ignored."""
        reward, _ = self.rewards(np.asarray(achieved_goal), np.asarray(desired_goal))
        return float(reward) if reward.ndim == 0 else reward

    @GoalMethod
    def compute_terminated(self, achieved_goal: Floats, desired_goal: Floats, info: Any) -> Any:
        """Return whether steps that lead to `achieved_goal` reach their goals; `info` is ignored."""
        is_reached = _reached(achieved_goal, desired_goal)
        return bool(is_reached) if is_reached.ndim == 0 else is_reached

    @GoalMethod
    def compute_truncated(self, achieved_goal: Floats, desired_goal: Floats, info: Any) -> Any:
        """Return whether steps end an episode without reaching their goals, that is, `steps_left` in `info` is 0.

        `info` is the info for a step, or holds an info for each step of a batch; a step without `steps_left` is not
        truncated.
        """
        is_truncated = ~_reached(achieved_goal, desired_goal) & (steps_left_of(info) <= 0.0)
        return bool(is_truncated) if is_truncated.ndim == 0 else is_truncated

    def rewards(self, achieved: Floats, desired: Floats) -> tuple[Floats, Flags]:
        """Return the rewards for steps, and whether the steps reach their goals."""
        now, before, goal = achieved[..., :PLACES], achieved[..., PLACES:], desired[..., :PLACES]
        return step_rewards(before, now, goal, discount=self.discount, share=self.share)


def _reached(achieved: Floats, desired: Floats) -> Flags:
    """Return whether steps reach their goals."""
    return reached(np.asarray(achieved)[..., :PLACES], np.asarray(desired)[..., :PLACES])
