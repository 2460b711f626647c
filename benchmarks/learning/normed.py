"""Soft actor-critic with layer normalisation in the critics, which bounds their estimates."""

from __future__ import annotations

from typing import Any

from stable_baselines3.common.policies import ContinuousCritic
from stable_baselines3.common.torch_layers import BaseFeaturesExtractor
from stable_baselines3.sac.policies import SACPolicy
from torch import nn


class NormedCritic(ContinuousCritic):
    """Has a layer normalisation (Ba, Kiros, Hinton 2016) between each hidden layer and its activation.

    The estimate for an untried action is then bounded by the weights of the last layer, so that it
    cannot grow from update to update (Ball, Smith, Kostrikov, Levine 2023, *Efficient online reinforcement learning
    with offline data*).
    """

    def __init__(self, *arguments: Any, **options: Any):
        super().__init__(*arguments, **options)
        self.q_networks = [_normed(network) for network in self.q_networks]
        for index, network in enumerate(self.q_networks):
            self.add_module(f"qf{index}", network)


class Normed(SACPolicy):
    """The policy of soft actor-critic as Stable-Baselines3 has it, with normalised critics."""

    def make_critic(self, features_extractor: BaseFeaturesExtractor | None = None) -> ContinuousCritic:
        """Return the critics."""
        return NormedCritic(**self._update_features_extractor(self.critic_kwargs, features_extractor)).to(self.device)


def _normed(network: nn.Sequential) -> nn.Sequential:
    """Return a network with a layer normalisation after each linear layer except the last."""
    layers: list[nn.Module] = []
    for layer in network:
        layers.append(layer)
        if isinstance(layer, nn.Linear):
            layers.append(nn.LayerNorm(layer.out_features))
    return nn.Sequential(*layers[:-1])
