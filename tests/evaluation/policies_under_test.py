"""Policies that tests evaluate by their names."""

from __future__ import annotations

import random
from collections.abc import Mapping
from typing import Any

import numpy as np


def noise(observation: Mapping[str, Any]) -> Any:
    return np.array([random.uniform(-1, 1), *np.random.uniform(-1, 1, 4)], dtype=np.float32)


class Informed:
    """Gives up after as many steps as the instruction has words."""

    def __init__(self, env: Any) -> None:
        self.size = env.action_space.shape

    def begin(self) -> None:
        self.steps = 0

    def __call__(self, observation: Any, info: Mapping[str, Any]) -> Any:
        self.steps += 1
        return np.zeros(self.size, np.float32) if self.steps <= len(info["instruction"].split()) else None


def wrong(observation: Any) -> Any:
    return [0.0] * 3


class Unmade:
    def __init__(self) -> None:
        raise ZeroDivisionError("it divides\nby zero")


def leaving(observation: Any) -> Any:
    raise SystemExit(0)


def failing(observation: Any) -> Any:
    raise ZeroDivisionError("it divides\nby zero")
