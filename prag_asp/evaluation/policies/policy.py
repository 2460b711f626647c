"""The protocol of policies in an evaluation."""

from __future__ import annotations

import random
import sys
from collections.abc import Callable, Mapping
from typing import Any, Protocol

import gymnasium
import numpy as np
from numpy.typing import NDArray

Environment = gymnasium.Env[Any, Any]


class Policy(Protocol):
    """A policy; each action depends only on the observations since `begin` and on the seed.

    Its method `close`, if it has one, releases its resources at the end.
    """

    def begin(self, seed: int) -> None:
        """Begin an episode: reset all state, and use the seed for random choices."""

    def __call__(self, observation: Any, info: Mapping[str, Any]) -> NDArray[Any] | None:
        """Return the next action for an observation and its info, or None to give up."""


PolicyMaker = Callable[[Environment], Policy]
"""A function that makes a policy for an environment, which is a `TaskEnv`, possibly in wrappers."""


def seed_everything(seed: int) -> None:
    """Seed the global random generators of Python, NumPy and (if loaded) PyTorch, which a policy may use."""
    random.seed(seed)
    np.random.seed(seed % 2**32)
    torch = sys.modules.get("torch")
    if torch is not None:
        torch.manual_seed(seed)
