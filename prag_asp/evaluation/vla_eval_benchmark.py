"""A benchmark for vla-eval: the scenarios of a dataset or a suite; the policy is a model server of vla-eval.

A configuration of vla-eval refers to it as ``prag_asp.evaluation.vla_eval_benchmark:ScenarioBenchmark``. Only this
module imports vla-eval.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from vla_eval.benchmarks.base import StepBenchmark, StepResult
from vla_eval.specs import GRIPPER_RAW, IMAGE_RGB, LANGUAGE, RAW, DimSpec

from prag_asp.errors import QueryError
from prag_asp.evaluation.episode import EpisodeJob
from prag_asp.evaluation.lerobot_view import arm_state
from prag_asp.evaluation.sources import StoredScenarios
from prag_asp.physics.control.names import ControlName, StateName
from prag_asp.physics.control.recorded_actions import state_names
from prag_asp.rl.environment import TaskEnv
from prag_asp.space.task_space import TaskSpace

ARM_ACTIONS = {
    "ee_delta": {
        "position": DimSpec("position", 3, "delta_xyz", (-1, 1)),
        "rotation": DimSpec("rotation", 3, "axis_angle", (-1, 1)),
    },
    "ee_position": {
        "position": DimSpec("position", 3, "absolute_xyz"),
        "rotation": DimSpec("rotation", 3, "axis_angle"),
    },
    "joint_position": {"joints": DimSpec("joints", 7, "joint_positions")},
    "joint_delta": {"joints": DimSpec("joints", 7, "joint_delta", (-1, 1))},
}
"""The components of an action of one arm, without the gripper, in vla-eval's terms."""


class ScenarioBenchmark(StepBenchmark):  # type: ignore[misc]  # vla-eval has no types for mypy
    """A benchmark with one task of vla-eval for each scenario; the suites are the parts of the dataset.

    `data` is the folder of a dataset or a suite with physics; `parts` and `most` are as in `StoredScenarios.open`.
    Actions follow the convention `control`, with `rate` actions per second; an episode has at most `steps` steps for
    each subgoal. Observations contain ``images`` from the `cameras`, which are `size` pixels wide and high,
    ``task_description`` (the instruction, by default that of the dataset), and ``state`` in a convention.
    """

    render_backends = frozenset({"cpu", "gpu"})

    @classmethod
    def configure_render(cls, mode: str) -> dict[str, str]:
        """Return no environment variables, because rendering uses the CPU in every mode."""
        return {}

    def __init__(
        self,
        data: str,
        parts: Sequence[str] = (),
        most: int | None = None,
        control: ControlName = "ee_delta",
        rate: int = 10,
        steps: int = 100,
        state: StateName = "ee_position",
        cameras: Sequence[str] = ("front", "wrist"),
        size: int = 256,
        language: str | None = None,
    ) -> None:
        super().__init__()
        source = StoredScenarios.open(data, parts, most)
        jobs = (job if language is None else job._replace(texts=None) for job in source.jobs())
        self._jobs: dict[str, EpisodeJob] = {str(job.scenario): job for job in jobs}
        self._state, self._steps, self._cameras = state, steps, tuple(cameras)
        self._env = TaskEnv(
            TaskSpace(source.domain, source.lengths), control=control, rate=rate, steps=steps, reward="sparse",
            cameras=self._cameras, size=size if cameras else None, language=language or "en",
        )  # fmt: skip

    def get_tasks(self) -> list[dict[str, Any]]:
        """Return the scenarios, with their ids as names and their parts as suites."""
        return [{"name": name, "suite": job.part} for name, job in self._jobs.items()]

    def reset(self, task: dict[str, Any]) -> Any:
        """Begin the episode of a scenario.

        Raises:
            QueryError: the benchmark has no such scenario.
        """
        job = self._jobs.get(task["name"])
        if job is None or job.given is None:
            raise QueryError(f"the benchmark has no scenario {task['name']!r:.200}; take one of get_tasks()")
        given, witness = job.given
        observation, self._info = self._env.reset(
            seed=0, options={"task": given, "witness": witness, "texts": job.texts}
        )
        return observation

    def step(self, action: dict[str, Any]) -> StepResult:
        """Apply an action, or the first one of a chunk."""
        values = np.asarray(action.get("actions", action.get("action")), dtype=np.float32)
        observation, reward, done, late, self._info = self._env.step(values.reshape(-1, values.shape[-1])[0])
        return StepResult(obs=observation, reward=reward, done=done or late, info=self._info)

    def make_obs(self, raw_obs: Any, task: dict[str, Any]) -> dict[str, Any]:
        """Return the images, the instruction and the state."""
        images = {
            name.removeprefix("camera_"): image
            for name, image in (raw_obs.items() if isinstance(raw_obs, dict) else ())
            if name.startswith("camera_")
        }
        state = arm_state(self._env, (self._state,))
        return {"images": images, "task_description": self._info["instruction"], "state": state}

    def get_step_result(self, step_result: StepResult) -> dict[str, Any]:
        """Return whether the task succeeded, and the share of its subgoals that were reached."""
        success = bool(self._info["is_success"])
        reached = int(self._info["stage"]) + success
        return {"success": success, "subgoals": reached / max(1, int(self._info["subgoals"]))}

    def get_metric_keys(self) -> dict[str, str]:
        """Return the metrics to average."""
        return {"success": "mean", "subgoals": "mean"}

    def get_metadata(self) -> dict[str, Any]:
        """Return the maximum number of steps in an episode."""
        return {"max_steps": self._steps * max(job.scenario.length for job in self._jobs.values())}

    def get_action_spec(self) -> dict[str, DimSpec]:
        """Describe the components of an action; with several arms, they are not named."""
        control = self._env.control
        if len(control.robots) > 1 or control.name not in ARM_ACTIONS:
            return {"raw": RAW}
        return {**ARM_ACTIONS[control.name], "gripper": GRIPPER_RAW}

    def get_observation_spec(self) -> dict[str, DimSpec]:
        """Return the parts of an observation."""
        size = len(state_names((self._state,), self._env.scene))
        images = dict.fromkeys(self._cameras, IMAGE_RGB)
        return {**images, "language": LANGUAGE, "state": DimSpec("state", size, self._state)}

    def cleanup(self) -> None:
        """Close the environment."""
        self._env.close()
