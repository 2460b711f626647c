"""The comparison of curricula: the gradients of its agent, and its statistics."""

from __future__ import annotations

import sys
from importlib import import_module
from itertools import combinations
from typing import Any

import numpy as np
import pytest

from tests.chance import Chance
from tests.docs.pages import ROOT


@pytest.fixture(scope="module")
def learner() -> Any:
    """The module of the agent."""
    sys.path.insert(0, str(ROOT / "benchmarks" / "learning"))
    yield import_module("soft_actor_critic")
    sys.path.pop(0)


@pytest.fixture(scope="module")
def comparison() -> Any:
    """The module of the comparison."""
    pytest.importorskip("scipy", reason="SciPy is installed with the extra learning")
    sys.path.insert(0, str(ROOT / "benchmarks" / "learning"))
    yield import_module("curricula")
    sys.path.pop(0)


def test_the_gradient_of_the_actor_is_that_of_its_loss(learner: Any, chance: Chance) -> None:
    agent, rng = learner.Agent(7, 3, seed=0, width=16), np.random.default_rng(chance.seed(1))
    seen, noise = rng.normal(size=(64, 7)).astype(np.float32), agent.normal(64)
    agent.actor_gradient(seen, noise, 0.3)
    gradient, vector = agent.actor.gradient.copy(), agent.actor.vector
    direction = (gradient / np.linalg.norm(gradient)).astype(np.float32)
    losses = []
    for sign in (1, -1):
        vector += sign * 0.01 * direction
        losses.append(agent.actor_gradient(seen, noise, 0.3)[0])
        vector -= sign * 0.01 * direction
    assert (losses[0] - losses[1]) / 0.02 == pytest.approx(np.linalg.norm(gradient), rel=0.02)


def test_an_agent_learns_which_action_is_rewarded(learner: Any, chance: Chance) -> None:
    agent, memory = learner.Agent(2, 1, seed=0, width=16, rate=3e-3), learner.Memory(400, 2, 1)
    rng = np.random.default_rng(chance.seed(0))
    for _ in range(400):
        seen, action = rng.normal(size=2), rng.uniform(-1, 1, 1)
        memory.add(seen, action, -10 * abs(action[0] - 0.5), seen, True)
    for _ in range(600):
        agent.update(memory.sample(agent.rng, 64))
    actions = [agent.act(seen)[0] for seen in rng.normal(size=(20, 2)).astype(np.float32)]
    assert np.abs(np.array(actions) - 0.5).max() < 0.2


def test_the_permutation_test_counts_all_divisions(comparison: Any) -> None:
    first, second = [0.5, 0.3, 0.6, 0.4], [0.2, 0.35, 0.1, 0.25]
    values, least = first + second, abs(np.mean(first) - np.mean(second)) - 1e-12
    divisions = [[values[i] for i in chosen] for chosen in combinations(range(8), 4)]
    extreme = sum(abs(2 * np.mean(one) - np.mean(values) * 2) >= least for one in divisions)
    assert comparison.permuted(first, second) == pytest.approx(extreme / len(divisions))


def test_p_values_are_corrected_as_by_holm(comparison: Any) -> None:
    assert comparison.holm([0.01, 0.04, 0.03]) == pytest.approx([0.03, 0.06, 0.06])
    assert comparison.holm([0.5, 0.001]) == pytest.approx([0.5, 0.002])
