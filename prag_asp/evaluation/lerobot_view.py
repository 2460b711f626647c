"""Observations in the form that LeRobot's evaluation expects, with the same numbers as in exported datasets."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import gymnasium
import numpy as np
from gymnasium import spaces
from numpy.typing import NDArray

from prag_asp.dataset.formats.body_values import body_names, body_values
from prag_asp.errors import QueryError
from prag_asp.physics.control.names import STATES, StateName
from prag_asp.physics.control.recorded_actions import state_names, states_in
from prag_asp.rl.environment import TaskEnv
from prag_asp.wording import unknown

CAMERA = "camera_"
"""The prefix of images in an observation of the environment."""


def arm_state(env: TaskEnv, names: Sequence[StateName]) -> NDArray[np.float32]:
    """Return the state of the robots in given conventions; `state_names` returns the names of the components."""
    arms = [env.situation.arm(robot) for robot in env.scene.robots]
    rows = np.array([[[*arm.joints, arm.width] for arm in arms]])
    state: NDArray[np.float32] = states_in(names, env.scene, rows)[0].astype(np.float32)
    return state


class LeRobotView(gymnasium.Wrapper[Any, Any, Any, Any]):
    """A wrapper that converts observations to those of an exported dataset, under names that LeRobot expects.

    ``agent_pos`` is ``observation.state`` (in the conventions `state`), ``environment_state`` holds the poses of
    objects if there are no cameras, and ``pixels`` holds the images from the cameras. The attribute `task_description`
    is the instruction of the episode; `steps`, which LeRobot needs, is the maximum number of steps in an episode.

    Raises:
        QueryError: there is no such state.
    """

    def __init__(
        self, env: gymnasium.Env[Any, Any], steps: int, state: Sequence[StateName] = ("joint_position",)
    ) -> None:
        super().__init__(env)
        for name in state:
            if name not in STATES:
                raise QueryError(unknown(name, STATES, "state"))
        assert isinstance(env.unwrapped, TaskEnv)
        self._task_env, self._state, self.task_description = env.unwrapped, tuple(state), ""
        self._max_episode_steps = steps
        scene, seen = self._task_env.scene, getattr(env.observation_space, "spaces", {})
        self._cameras = [name for name in seen if name.startswith(CAMERA)]

        def numbers(names: list[str]) -> spaces.Space[Any]:
            return spaces.Box(-np.inf, np.inf, (len(names),), np.float32)

        self.observation_space = spaces.Dict(
            {"agent_pos": numbers(state_names(self._state, scene))}
            | (
                {"pixels": spaces.Dict({name.removeprefix(CAMERA): seen[name] for name in self._cameras})}
                if self._cameras
                else {"environment_state": numbers(body_names(scene))}
            )
        )

    @property
    def task(self) -> str:
        """The instruction of the episode."""
        return self.task_description

    def reset(self, **arguments: Any) -> tuple[dict[str, Any], dict[str, Any]]:
        """Begin an episode."""
        observation, info = self.env.reset(**arguments)
        self.task_description = info["instruction"]
        return self._converted(observation), info

    def step(self, action: Any) -> tuple[dict[str, Any], Any, bool, bool, dict[str, Any]]:
        """Apply an action."""
        observation, reward, done, late, info = self.env.step(action)
        return self._converted(observation), reward, done, late, info

    def _converted(self, observation: Any) -> dict[str, Any]:
        """Return an observation in LeRobot's form."""
        state = {"agent_pos": arm_state(self._task_env, self._state)}
        if self._cameras:
            return {**state, "pixels": {name.removeprefix(CAMERA): observation[name] for name in self._cameras}}
        return {**state, "environment_state": body_values(self._task_env.situation)}
