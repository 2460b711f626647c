"""Behaviour cloning: a small network that imitates the oracle on all skills of a domain."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import NamedTuple

import numpy as np
import torch
from numpy.typing import NDArray

from prag_asp import Task
from prag_asp.physics import Witness
from prag_asp.rl import TaskEnv, oracle

NOISE, OFTEN = 0.5, 0.1
"""The standard deviation of the noise on the oracle's actions, and the share of steps with noise.

So the demonstrations include recoveries; the recorded actions have no noise: Laskey and others, "DART: Noise injection
for robust imitation learning" (2017).
"""

STEPS = 150
"""The time limit of a subgoal for the oracle, in steps."""

BATCH = 256


class Demonstration(NamedTuple):
    """The observations and the actions of the oracle, an array each, with a row for each step."""

    features: NDArray[np.float32]
    actions: NDArray[np.float32]


def demonstrations(given: Iterable[tuple[Task, Witness]], count: int, *, seed: int) -> tuple[list[Demonstration], int]:
    """Return the first `count` successful demonstrations of the oracle, and the number of tasks that were tried."""
    rng, result, tried = np.random.default_rng(seed), list[Demonstration](), 0
    env: TaskEnv | None = None
    for task, witness in given:
        if env is None:
            env = TaskEnv(task=task, witness=witness, reward="sparse", steps=STEPS)
        tried += 1
        observation, _ = env.reset(options={"task": task, "witness": witness})
        features, actions, ended = [], [], False
        for action in oracle(env):
            features.append(observation)
            actions.append(action)
            noise = np.zeros_like(action)
            if rng.random() < OFTEN:
                noise[:4] = rng.normal(0.0, NOISE, 4)
            observation, _, ended, late, _ = env.step(action + noise)
            if ended or late:
                break
        if ended:
            result.append(Demonstration(np.stack(features), np.stack(actions)))
        if len(result) == count:
            break
    if env is not None:
        env.close()
    return result, tried


class Clone:
    """A policy that was learned by behaviour cloning."""

    def __init__(self, network: torch.nn.Module):
        self._network = network

    def __call__(self, observation: NDArray[np.float32]) -> NDArray[np.float32]:
        """Return the action for an observation."""
        with torch.no_grad():
            return self._network(torch.from_numpy(observation)).numpy()


def cloned(examples: Sequence[Demonstration], *, epochs: int, seed: int) -> torch.nn.Module:
    """Return a network that imitates demonstrations, trained on the mean squared error."""
    torch.manual_seed(seed)
    features = torch.from_numpy(np.concatenate([each.features for each in examples]))
    actions = torch.from_numpy(np.concatenate([each.actions for each in examples]))
    network = torch.nn.Sequential(
        torch.nn.Linear(features.shape[1], 128), torch.nn.ReLU(), torch.nn.Linear(128, 128), torch.nn.ReLU(),
        torch.nn.Linear(128, actions.shape[1]), torch.nn.Tanh(),
    )  # fmt: skip
    optimizer = torch.optim.Adam(network.parameters(), lr=1e-3)
    rate = torch.optim.lr_scheduler.CosineAnnealingLR(optimizer, epochs)
    for _ in range(epochs):
        for batch in torch.randperm(len(features)).split(BATCH):
            optimizer.zero_grad()
            torch.nn.functional.mse_loss(network(features[batch]), actions[batch]).backward()
            optimizer.step()
        rate.step()
    return network
