"""What Stable-Baselines3 asks of an environment; it needs the extra `learning`."""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial
from importlib.util import find_spec
from typing import TYPE_CHECKING, Any

import gymnasium
import numpy as np
import pytest

from prag_asp import TaskSpace, load_domain
from prag_asp.rl import ReverseCurriculum, TaskEnv
from prag_asp.rl.goals import PLACES
from tests.chance import Chance
from tests.rl.conftest import DOMAINS, Given

if TYPE_CHECKING:
    from stable_baselines3.common.vec_env import VecEnv

# It is imported where it is used: PyTorch takes seconds, and each process imports all tests.
pytestmark = pytest.mark.skipif(find_spec("stable_baselines3") is None, reason="Stable-Baselines3 is not installed")


@pytest.mark.parametrize("name", DOMAINS)
@pytest.mark.parametrize("asked", [{"cameras": ("front",), "size": 40}, {"control": "joint_delta", "everything": True}])
def test_stable_baselines3_finds_nothing_wrong(
    name: str, asked: dict[str, Any], given: Mapping[str, list[Given]]
) -> None:
    from stable_baselines3.common.env_checker import check_env

    task, witness = given[name][0]
    env = TaskEnv(task=task, witness=witness, **asked)
    check_env(env)
    env.close()


def test_processes_of_stable_baselines3_see_what_one_process_sees(chance: Chance) -> None:
    from stable_baselines3.common.vec_env import DummyVecEnv, SubprocVecEnv

    space = TaskSpace(load_domain("prag"), length=2)
    make = partial(gymnasium.make, "prag_asp.rl:prag_asp/Task-v0", space=space, steps=3, curriculum=ReverseCurriculum())
    found = [followed(made, chance) for made in (DummyVecEnv([make] * 2), SubprocVecEnv([make] * 2, "spawn"))]
    assert found[0] == found[1]


def followed(envs: VecEnv, chance: Chance) -> list[Any]:
    """Return what two environments tell of a few steps, over the ends of their episodes."""
    rng = np.random.default_rng(chance.seed(1))
    envs.seed(7)
    told: list[Any] = [envs.reset().tobytes(), [info["task"] for info in envs.reset_infos]]
    assert told[-1][0] != told[-1][1], "each has a seed of its own"
    for _ in range(5):
        seen, gains, ends, infos = envs.step(rng.uniform(-1.0, 1.0, (2, 5)))
        told += [seen.tobytes(), gains.tolist(), ends.tolist(), [info["action"] for info in infos]]
    envs.close()
    return told


@pytest.mark.parametrize("reward", ["sparse", "dense"])
def test_hindsight_replay_learns_from_an_episode_that_has_failed(reward: Any, given: Mapping[str, list[Given]]) -> None:
    from stable_baselines3 import SAC, HerReplayBuffer

    task, witness = given["tabletop"][0]
    env = TaskEnv(task=task, witness=witness, reward=reward, until="subgoal", steps=20, goals=True)
    model = SAC(
        "MultiInputPolicy", env, replay_buffer_class=HerReplayBuffer, replay_buffer_kwargs={"n_sampled_goal": 4},
        learning_starts=25, batch_size=64, seed=0, device="cpu", policy_kwargs={"net_arch": [8]},
    )  # fmt: skip
    model.learn(40)
    buffer = model.replay_buffer
    assert buffer is not None and (reward == "dense" or not buffer.rewards[:40].any()), "no subgoal is reached"
    seen = buffer.sample(200, env=model.get_vec_normalize_env())
    gains = seen.rewards.numpy().ravel()
    after, goals = (seen.next_observations[name].numpy() for name in ("achieved_goal", "desired_goal"))
    reached = (after[:, :PLACES] <= goals[:, :PLACES]).all(axis=1)
    assert 0 < reached.sum() < 200
    if reward == "sparse":
        assert np.array_equal(gains, reached)
    else:
        assert gains[reached].mean() > gains[~reached].mean()
    env.close()
