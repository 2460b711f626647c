"""Environments for LeRobot's EnvHub and a benchmark for vla-eval; both with the real packages where they exist."""

from __future__ import annotations

import asyncio
import runpy
import sys
from collections import namedtuple
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import gymnasium
import numpy as np
import pytest

from prag_asp import Dataset, QueryError, TaskSpace, load_domain
from prag_asp.dataset import generate
from prag_asp.evaluation.lerobot_view import LeRobotView
from tests.docs.pages import ROOT

ENV = ROOT / "examples" / "lerobot" / "env.py"
MODULE = "prag_asp.evaluation.lerobot_env"


@pytest.fixture(scope="module")
def data(tmp_path_factory: pytest.TempPathFactory) -> Dataset:
    folder = tmp_path_factory.mktemp("programs") / "data"
    return generate(TaskSpace(load_domain("tabletop"), 1), folder, tasks=2)


def test_env_py_makes_what_lerobot_evaluates(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PRAG_ASP_CAMERAS", "")
    vector = runpy.run_path(str(ENV))["make_env"](n_envs=2)["prag_asp"][0]
    try:
        observation, _ = vector.reset(seed=[1, 2])
        assert observation["agent_pos"].shape == (2, 8) and observation["environment_state"].shape == (2, 56)
        assert vector.observation_space.contains(observation) and vector.single_action_space.shape == (8,)
        assert all(vector.call("task_description")) and vector.call("_max_episode_steps") == (100, 100)
        *_, info = vector.step(np.array([env.action_space.sample() for env in vector.envs]))
        assert info["instruction"][0] == vector.call("task")[0]
    finally:
        vector.close()
    env = gymnasium.make("prag_asp.rl:prag_asp/Tabletop-v0", length=1, cameras=("front",), size=16)
    with pytest.raises(QueryError, match="state"):
        LeRobotView(env, 10, state=("ee_delta",))  # type: ignore[arg-type]
    view = LeRobotView(env, 10, state=("ee_position",))
    assert {name: space.shape for name, space in view.observation_space["pixels"].items()} == {"front": (16, 16, 3)}
    assert view.observation_space["agent_pos"].shape == (7,) and "environment_state" not in view.observation_space
    view.close()


def test_lerobot_loads_env_py_and_renames_its_observations(monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("lerobot", reason="LeRobot needs versions of its own")
    from lerobot.envs import utils

    monkeypatch.setenv("PRAG_ASP_CAMERAS", "front")
    module = utils._import_hub_module(str(ENV), "me/tabletop")
    vector = utils._normalize_hub_result(utils._call_make_env(module, 1, False, None))["prag_asp"][0]
    observation, _ = vector.reset(seed=[1])
    batch = utils.add_envs_task(vector, utils.preprocess_observation(observation))
    vector.close()
    assert batch["observation.state"].shape == (1, 8) and batch["observation.images.front"].shape == (1, 3, 128, 128)
    assert isinstance(batch["task"][0], str) and batch["task"][0]


@dataclass
class StandInConfig:
    """The part of LeRobot's `EnvConfig` that an environment type builds on."""

    task: str | None = None
    fps: int = 30
    features: dict[str, Any] = field(default_factory=dict)
    features_map: dict[str, str] = field(default_factory=dict)

    @classmethod
    def register_subclass(cls, name: str) -> Callable[[type], type]:
        return lambda subclass: subclass


@pytest.fixture
def lerobot_env(monkeypatch: pytest.MonkeyPatch) -> Iterator[Any]:
    """The environment type for LeRobot, on LeRobot itself if it is installed."""
    if find_spec("lerobot") is None:
        kinds = SimpleNamespace(ACTION="ACTION", STATE="STATE", ENV="ENV", VISUAL="VISUAL")
        types = SimpleNamespace(FeatureType=kinds, PolicyFeature=namedtuple("PolicyFeature", ("type", "shape")))
        for name in ("lerobot", "lerobot.configs", "lerobot.envs"):
            monkeypatch.setitem(sys.modules, name, SimpleNamespace())
        monkeypatch.setitem(sys.modules, "lerobot.configs.types", types)
        monkeypatch.setitem(sys.modules, "lerobot.envs.configs", SimpleNamespace(EnvConfig=StandInConfig))
    yield import_module(MODULE)
    sys.modules.pop(MODULE)
    gymnasium.registry.pop("prag_asp/LeRobot-v0")


def test_lerobot_eval_makes_its_environments_from_a_configuration(data: Dataset, lerobot_env: Any) -> None:
    poses = lerobot_env.LeRobotTasks(length="1..2", control="ee_delta", state=["joint_position", "ee_position"])
    assert {name: feature.shape for name, feature in poses.features.items()} == {
        "action": (7,), "agent_pos": (14,), "environment_state": (56,),
    }  # fmt: skip
    assert poses.features_map["environment_state"] == "observation.environment_state"
    config = lerobot_env.LeRobotTasks(dataset=str(data.folder), cameras=["front"], size=16, fps=10, episode_length=3)
    assert config.features["pixels/front"].shape == (16, 16, 3)
    assert config.features_map == {
        "action": "action", "agent_pos": "observation.state", "pixels/front": "observation.images.front",
    }  # fmt: skip
    assert config.package_name == MODULE
    vector = gymnasium.vector.SyncVectorEnv([lambda: gymnasium.make(config.gym_id, **config.gym_kwargs)])
    observation, _ = vector.reset(seed=[1])
    assert observation["pixels"]["front"].shape == (1, 16, 16, 3)
    # LeRobot looks for these attributes at the outermost environment.
    assert vector.envs[0].task_description == vector.envs[0].task and vector.call("_max_episode_steps") == (3,)
    assert vector.envs[0].render().shape == (16, 16, 3) and vector.envs[0].unwrapped.metadata["render_fps"] == 10
    assert [bool(vector.step(np.zeros((1, 8), np.float32))[3]) for _ in range(3)] == [False, False, True]
    vector.close()


def test_vla_eval_runs_the_scenarios_of_a_dataset(data: Dataset, tmp_path: Path) -> None:
    pytest.importorskip("vla_eval", reason="vla-eval needs packages of its own")
    from vla_eval.runners.sync_runner import SyncEpisodeRunner

    from prag_asp.evaluation.vla_eval_benchmark import ScenarioBenchmark

    class Still:
        """A connection to a model that does not move, and notes what it gets."""

        seen: list[Any] = []

        async def start_episode(self, payload: Any) -> None: ...

        async def end_episode(self, result: Any) -> None: ...

        async def act(self, observation: Any) -> Any:
            self.seen.append(observation)
            return {"actions": np.zeros((2, 7), np.float32)}

    benchmark = ScenarioBenchmark(str(data.folder), cameras=("front",), size=16, steps=3)
    tasks = benchmark.get_tasks()
    assert [task["name"] for task in tasks] == [str(data.scenario(number)) for number in range(2)]
    assert {task["suite"] for task in tasks} == {"train"} and benchmark.get_metadata() == {"max_steps": 3}
    result = asyncio.run(SyncEpisodeRunner().run_episode(benchmark, tasks[1], Still(), max_steps=10))
    assert result["steps"] == 3 and result["metrics"] == {"success": False, "subgoals": 0.0}
    first = Still.seen[0]
    assert first["images"]["front"].shape == (16, 16, 3) and first["state"].shape == (7,) and first["task_description"]
    assert set(benchmark.get_observation_spec()) == {"front", "language", "state"}
    assert set(benchmark.get_action_spec()) == {"position", "rotation", "gripper"}
    with pytest.raises(QueryError, match="no scenario"):
        benchmark.reset({"name": "other"})
    benchmark.cleanup()
