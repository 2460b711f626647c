"""A policy from a zip file of Stable-Baselines3 or of its contributed algorithms, used without exploration."""

from __future__ import annotations

import json
from collections.abc import Mapping
from importlib import import_module
from pathlib import Path
from typing import Any
from zipfile import BadZipFile, ZipFile

from numpy.typing import NDArray

from prag_asp.errors import QueryError
from prag_asp.evaluation.policies.policy import Environment, PolicyMaker, seed_everything

ALGORITHMS = {
    "stable_baselines3.sac": "SAC", "stable_baselines3.td3": "TD3", "stable_baselines3.dqn": "DQN",
    "sb3_contrib.tqc": "TQC", "sb3_contrib.qrdqn": "QRDQN", "sb3_contrib.crossq": "CrossQ",
}  # fmt: skip
"""The algorithm to which each package of policy classes in a zip file belongs; DDPG uses the policies of TD3."""

SIGNS = (("cg_max_steps", "sb3_contrib", "TRPO"), ("clip_range", "stable_baselines3", "PPO"))
"""Parameters that identify algorithms with the shared actor-critic policies; A2C stores none of them."""


class StableBaselinesPolicy:
    """A policy that predicts actions deterministically with a model."""

    def __init__(self, path: Path, env: Environment) -> None:
        """Load the model in one thread, so that results do not depend on the machine's number of processors.

        Raises:
            QueryError: the zip cannot be loaded, or its model is for different observations or actions.
        """
        package, name = algorithm_of(path)
        try:
            import_module("torch").set_num_threads(1)
            algorithm = getattr(import_module(package), name)
        except ImportError as error:
            raise QueryError(f"{path}: {name} needs {error.name}; install it: pip install {package}") from None
        try:
            self._model = algorithm.load(path, device="cpu")
        except Exception as error:  # a zip may raise anything
            reason = " ".join(f"{type(error).__name__}: {error}".split())
            raise QueryError(f"{path}: cannot be loaded: {reason:.300}; save the model again") from None
        for what in ("observation_space", "action_space"):
            own, its = getattr(env, what), getattr(self._model, what)
            if own != its:
                raise QueryError(
                    f"{path}: its {what.replace('_', ' ')} is {its!s:.200}, that of the environment is {own!s:.200}; "
                    "give --control, --everything, --cameras and --wrapper as in its training"
                )

    def begin(self, seed: int) -> None:
        """Begin an episode."""
        seed_everything(seed)

    def __call__(self, observation: Any, info: Mapping[str, Any]) -> NDArray[Any]:
        """Return the action of the model."""
        action: NDArray[Any] = self._model.predict(observation, deterministic=True)[0]
        return action


def algorithm_of(path: Path) -> tuple[str, str]:
    """Return the package and the name of the algorithm of the model in a zip.

    Raises:
        QueryError: the file is not such a zip.
    """
    try:
        with ZipFile(path) as file:
            data = json.loads(file.read("data"))
        module = data["policy_class"]["__module__"]
    except FileNotFoundError:
        raise QueryError(f"{path}: no such file; give a zip that Stable-Baselines3 saved") from None
    except (OSError, BadZipFile, KeyError, TypeError, ValueError):
        raise QueryError(f"{path}: is not a zip file of Stable-Baselines3; save the model with model.save") from None
    for prefix, name in ALGORITHMS.items():
        if module.startswith(f"{prefix}."):
            return prefix.partition(".")[0], name
    if module == "stable_baselines3.common.policies":
        return next(((package, name) for sign, package, name in SIGNS if sign in data), ("stable_baselines3", "A2C"))
    raise QueryError(
        f"{path}: its policy class is in {module}; supported are {', '.join(ALGORITHMS.values())}, PPO, A2C and TRPO"
    )


def files(text: str) -> list[Path]:
    """Return the files of the policy."""
    return [Path(text)]


def maker(text: str) -> PolicyMaker:
    """Return the maker of the policy in a zip.

    Raises:
        QueryError: the file is not a zip with a model from a known algorithm.
    """
    path = Path(text)
    algorithm_of(path)

    def make(env: Environment) -> StableBaselinesPolicy:
        return StableBaselinesPolicy(path, env)

    return make
