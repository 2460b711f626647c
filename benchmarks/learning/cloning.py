"""Behaviour cloning: a small network that does what the oracle did, for all skills of a domain at once."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import NamedTuple

import numpy as np
import torch
from numpy.typing import NDArray
from starts import shown

from prag_asp import Task
from prag_asp.physics import Witness
from prag_asp.rl import Layout, TaskEnv, oracle
from prag_asp.rl.environment import Observation

NOISE, OFTEN = 0.5, 0.1
"""The standard deviation of what is added to the oracle's actions as it acts, in so many of its steps.

So it shows how to come back, and what is added is not learned: Laskey and others, "DART: Noise injection for robust
imitation learning" (2017).
"""

STEPS = 150
"""For how many steps the oracle may pursue a subgoal."""

BATCH = 256


class Demonstration(NamedTuple):
    """What was shown at each step, and what the oracle did: arrays of the shapes (steps, seen) and (steps, action)."""

    seen: NDArray[np.float32]
    actions: NDArray[np.float32]


def demonstrations(given: Iterable[tuple[Task, Witness]], count: int, *, seed: int) -> tuple[list[Demonstration], int]:
    """Return what the oracle does with the first `count` of tasks where that ends well, and how many it was given."""
    rng, found, asked = np.random.default_rng(seed), list[Demonstration](), 0
    env: TaskEnv | None = None
    for task, witness in given:
        if env is None:
            env = TaskEnv(task=task, witness=witness, reward="sparse", steps=STEPS)
            show = shown(env.layout)
        asked += 1
        observation, _ = env.reset(options={"task": task, "witness": witness})
        seen, actions, ended = [], [], False
        for action in oracle(env):
            seen.append(show(observation))
            actions.append(action)
            noise = np.zeros_like(action)
            if rng.random() < OFTEN:
                noise[:4] = rng.normal(0.0, NOISE, 4)
            observation, _, ended, late, _ = env.step(action + noise)
            if ended or late:
                break
        if ended:
            found.append(Demonstration(np.stack(seen), np.stack(actions)))
        if len(found) == count:
            break
    if env is not None:
        env.close()
    return found, asked


class Clone:
    """A policy that was learned from demonstrations."""

    def __init__(self, network: torch.nn.Module, layout: Layout):
        self._network, self._show = network, shown(layout)

    def __call__(self, observation: Observation) -> NDArray[np.float32]:
        """Return the action for an observation."""
        with torch.no_grad():
            return self._network(torch.from_numpy(self._show(observation))).numpy()


def cloned(demonstrated: Sequence[Demonstration], *, epochs: int, seed: int) -> torch.nn.Module:
    """Return a network that does what was demonstrated, learned by the mean squared error."""
    torch.manual_seed(seed)
    seen = torch.from_numpy(np.concatenate([each.seen for each in demonstrated]))
    actions = torch.from_numpy(np.concatenate([each.actions for each in demonstrated]))
    network = torch.nn.Sequential(
        torch.nn.Linear(seen.shape[1], 128), torch.nn.ReLU(), torch.nn.Linear(128, 128), torch.nn.ReLU(),
        torch.nn.Linear(128, actions.shape[1]), torch.nn.Tanh(),
    )  # fmt: skip
    optimizer = torch.optim.Adam(network.parameters(), lr=1e-3)
    rate = torch.optim.lr_scheduler.CosineAnnealingLR(optimizer, epochs)
    for _ in range(epochs):
        for batch in torch.randperm(len(seen)).split(BATCH):
            optimizer.zero_grad()
            torch.nn.functional.mse_loss(network(seen[batch]), actions[batch]).backward()
            optimizer.step()
        rate.step()
    return network
