"""A soft actor-critic in NumPy for small networks: one update takes less than half the time that PyTorch needs.

Haarnoja and others, "Soft actor-critic algorithms and applications" (2018): two critics with target networks, a
squashed Gaussian policy, and an entropy coefficient that is adapted to the target entropy of minus one per action
number. Defaults are those of Stable-Baselines3, except for the smaller networks and batches.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float32]

SMALLEST, LARGEST = -20.0, 2.0
"""The bounds of the logarithm of the policy's standard deviation."""

EPSILON = 1e-6


class Network:
    """`count` networks of equal shape with two hidden layers; all parameters are one vector."""

    def __init__(self, rng: np.random.Generator, count: int, sizes: Sequence[int]):
        shapes = [shape for inner, outer in pairwise(sizes) for shape in ((count, inner, outer), (count, 1, outer))]
        self.vector = np.empty(sum(int(np.prod(shape)) for shape in shapes), dtype=np.float32)
        self.gradient = np.zeros_like(self.vector)
        self._layers, self._gradients = _views(self.vector, shapes), _views(self.gradient, shapes)
        for number, layer in enumerate(self._layers):
            bound = sizes[number // 2] ** -0.5
            layer[:] = rng.uniform(-bound, bound, layer.shape)

    def forward(self, inputs: Floats) -> list[Floats]:
        """Return the inputs (batch, size), the activations and the outputs (count, batch, size)."""
        values = [inputs]
        for number in range(0, len(self._layers), 2):
            value = values[-1] @ self._layers[number] + self._layers[number + 1]
            values.append(value if number == len(self._layers) - 2 else np.maximum(value, 0.0))
        return values

    def backward(self, values: Sequence[Floats], outer: Floats) -> Floats:
        """Set the gradient for that of the outputs, and return that of the inputs, (count, batch, size)."""
        for number in range(len(self._layers) - 2, -1, -2):
            inner = values[number // 2]
            np.matmul(inner.swapaxes(-1, -2), outer, out=self._gradients[number])
            np.sum(outer, axis=1, keepdims=True, out=self._gradients[number + 1])
            outer = outer @ self._layers[number].swapaxes(-1, -2)
            if number:
                outer = outer * (inner > 0.0)
        return outer


def _views(vector: Floats, shapes: Sequence[tuple[int, ...]]) -> list[Floats]:
    """Return consecutive parts of a vector in the given shapes."""
    ends = np.cumsum([int(np.prod(shape)) for shape in shapes])
    return [part.reshape(shape) for part, shape in zip(np.split(vector, ends[:-1]), shapes, strict=True)]


class Adam:
    """The optimizer of Kingma and Ba (2015)."""

    def __init__(self, size: int, rate: float):
        self._rate, self._count = rate, 0
        self._mean, self._square = np.zeros(size, np.float32), np.zeros(size, np.float32)

    def step(self, vector: Floats, gradient: Floats) -> None:
        """Change a vector in place."""
        self._count += 1
        self._mean += 0.1 * (gradient - self._mean)
        self._square += 0.001 * (gradient * gradient - self._square)
        scale = self._rate / (1 - 0.9**self._count)
        vector -= scale * self._mean / (np.sqrt(self._square / (1 - 0.999**self._count)) + 1e-8)


class Agent:
    """An agent for observations and actions of given sizes; the numbers of actions are between -1 and 1."""

    def __init__(
        self, observation: int, action: int, *, seed: int, width: int = 64, rate: float = 3e-4, discount: float = 0.99
    ):
        self.rng = np.random.default_rng(seed)
        self.size, self.discount = action, discount
        self.actor = Network(self.rng, 1, [observation, width, width, 2 * action])
        self.critics = Network(self.rng, 2, [observation + action, width, width, 1])
        self.targets = Network(self.rng, 2, [observation + action, width, width, 1])
        self.targets.vector[:] = self.critics.vector
        self.log_alpha = np.zeros(1, np.float32)
        self._optimizers = [Adam(each.size, rate) for each in (self.actor.vector, self.critics.vector, self.log_alpha)]

    def act(self, observation: Floats, *, sampled: bool = False) -> Floats:
        """Return the mean action, or a sampled one, for one observation."""
        values = self.actor.forward(observation[None])
        if sampled:
            actions, _ = self.squashed(values[-1][0], self.normal(1))
        else:
            actions = np.tanh(values[-1][0, :, : self.size])
        action: Floats = actions[0]
        return action

    def normal(self, count: int) -> Floats:
        """Return standard normal numbers for `count` actions."""
        return self.rng.standard_normal((count, self.size), dtype=np.float32)

    def squashed(self, outputs: Floats, noise: Floats) -> tuple[Floats, Floats]:
        """Return the actions for the outputs of the actor, and the logarithms of their densities."""
        log_std = outputs[:, self.size :].clip(SMALLEST, LARGEST)
        actions = np.tanh(outputs[:, : self.size] + np.exp(log_std) * noise)
        density = -0.5 * noise * noise - log_std - 0.5 * np.log(2 * np.pi) - np.log(1 - actions * actions + EPSILON)
        return actions, density.sum(axis=1)

    def update(self, batch: Sequence[Floats]) -> None:
        """Take a gradient step on a batch of observations, actions, rewards, next observations and ends."""
        seen, actions, rewards, following, ended = batch
        alpha = float(np.exp(self.log_alpha[0]))
        noise = self.normal(len(seen))
        _, density = self.actor_gradient(seen, noise, alpha)
        self._optimizers[0].step(self.actor.vector, self.actor.gradient)
        self._optimizers[2].step(self.log_alpha, np.array([self.size - density.mean()], np.float32))
        ahead, ahead_density = self.squashed(self.actor.forward(following)[-1][0], self.normal(len(seen)))
        worth = self.targets.forward(np.hstack([following, ahead]))[-1][..., 0].min(axis=0) - alpha * ahead_density
        aim = rewards + self.discount * (1.0 - ended) * worth
        values = self.critics.forward(np.hstack([seen, actions]))
        self.critics.backward(values, (values[-1] - aim[:, None]) / np.float32(len(seen)))
        self._optimizers[1].step(self.critics.vector, self.critics.gradient)
        self.targets.vector += 0.005 * (self.critics.vector - self.targets.vector)

    def actor_gradient(self, seen: Floats, noise: Floats, alpha: float) -> tuple[float, Floats]:
        """Set the gradient of the actor; return its loss and the logarithms of the densities of its actions."""
        values = self.actor.forward(seen)
        outputs = values[-1][0]
        actions, density = self.squashed(outputs, noise)
        judged = self.critics.forward(np.hstack([seen, actions]))
        quality = judged[-1][..., 0]
        least = (np.arange(2)[:, None] == quality.argmin(axis=0)).astype(np.float32)
        by_action = self.critics.backward(judged, -least[..., None] / len(seen))[..., -self.size :].sum(axis=0)
        square = 1 - actions * actions
        moved = (by_action + alpha / len(seen) * 2 * actions / (square + EPSILON)) * square
        log_std = outputs[:, self.size :]
        inside = (log_std > SMALLEST) & (log_std < LARGEST)
        spread = inside * (moved * np.exp(log_std.clip(SMALLEST, LARGEST)) * noise - alpha / len(seen))
        self.actor.backward(values, np.hstack([moved, spread])[None].astype(np.float32))
        return float((alpha * density - quality.min(axis=0)).mean()), density


class Memory:
    """The transitions of a training, of which batches are sampled uniformly."""

    def __init__(self, capacity: int, observation: int, action: int):
        self._columns = [
            np.zeros((capacity, *size), np.float32) for size in ((observation,), (action,), (), (observation,), ())
        ]
        self.count = 0

    def add(self, *transition: Any) -> None:
        """Add an observation, an action, a reward, the next observation, and whether it is terminal."""
        for column, value in zip(self._columns, transition, strict=True):
            column[self.count] = value
        self.count += 1

    def sample(self, rng: np.random.Generator, size: int) -> list[Floats]:
        """Return a batch."""
        chosen = rng.integers(self.count, size=size)
        return [column[chosen] for column in self._columns]
