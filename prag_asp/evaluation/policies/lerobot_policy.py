"""A policy from a LeRobot checkpoint; its inputs are matched to the environment by name and shape."""

from __future__ import annotations

import sys
from collections.abc import Callable, Mapping
from contextlib import redirect_stdout
from functools import partial
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from prag_asp.dataset.formats.body_values import body_names, body_values
from prag_asp.errors import QueryError
from prag_asp.evaluation.lerobot_view import arm_state
from prag_asp.evaluation.policies.lerobot_checkpoint import IMAGES, ExportedFeature, LeRobotCheckpoint, TensorShape
from prag_asp.evaluation.policies.policy import Environment, PolicyMaker, seed_everything
from prag_asp.physics.control.names import STATES, StateName
from prag_asp.physics.control.recorded_actions import state_names
from prag_asp.rl.environment import TaskEnv

STATE, BODIES = "observation.state", "observation.environment_state"
"""The inputs of a policy other than images: states of the robots, and poses of objects."""


class LeRobotPolicy:
    """A policy that selects actions with a LeRobot policy, on the device and with the processors of that policy.

    The environment may have any kind of observation: states and poses come from its situation, and images from its
    observation, which then has to be a dictionary.
    """

    def __init__(self, checkpoint: LeRobotCheckpoint, env: Environment) -> None:
        """Load the policy in one thread, so that results do not depend on the machine's number of processors.

        Raises:
            QueryError: the checkpoint cannot be loaded, or the inputs or actions of the environment differ.
        """
        assert isinstance(env.unwrapped, TaskEnv)
        self._env, self._level = env.unwrapped, checkpoint.level
        self._inputs = input_functions(checkpoint, env)
        check_actions(checkpoint, self._env)
        self._torch, self._policy, self._before, self._after = _loaded(checkpoint)

    def begin(self, seed: int) -> None:
        """Begin an episode: forget past observations and the rest of the last chunk."""
        seed_everything(seed)
        self._policy.reset()

    def __call__(self, observation: Any, info: Mapping[str, Any]) -> NDArray[Any]:
        """Return the action of the policy."""
        values = {name: value(observation) for name, value in self._inputs.items()}
        batch = {name: self._torch.from_numpy(value[None]) for name, value in values.items()}
        with self._torch.inference_mode():
            prepared = self._before({**batch, "task": [info.get(f"instruction_{self._level}", info["instruction"])]})
            action: NDArray[Any] = self._after(self._policy.select_action(prepared))[0].cpu().numpy()
        return action


def input_functions(checkpoint: LeRobotCheckpoint, env: Environment) -> dict[str, Callable[[Any], NDArray[np.float32]]]:
    """Return, for each input of a policy, a function that computes it from an observation of the environment.

    Raises:
        QueryError: the environment lacks an input, or an input has a different shape.
    """
    task_env, path = env.unwrapped, checkpoint.path
    assert isinstance(task_env, TaskEnv)
    functions: dict[str, Callable[[Any], NDArray[np.float32]]] = {}
    for name, feature in checkpoint.inputs.items():
        if name == STATE:
            functions[name] = partial(_state, task_env, _states_of(path, feature, task_env))
        elif name == BODIES:
            names = body_names(task_env.scene)
            if feature.shape != [len(names)] or feature.names not in (None, names):
                raise QueryError(
                    f"{path}: its {name} has the shape {feature.shape} or other names than the [{len(names)}] numbers "
                    f"of {task_env.domain.name}; evaluate it in the domain of its training"
                )
            functions[name] = partial(_bodies, task_env)
        elif name.startswith(IMAGES):
            camera = f"camera_{name.removeprefix(IMAGES)}"
            seen = getattr(env.observation_space, "spaces", {}).get(camera)
            if seen is None or list(seen.shape) != feature.shape:
                has = "none" if seen is None else f"images of the shape {list(seen.shape)}"
                raise QueryError(
                    f"{path}: its {name} has the shape {feature.shape}, the environment has {has}; "
                    "give --cameras and --size as in its training"
                )
            functions[name] = partial(_image, camera)
        else:
            known = f"{STATE}, {BODIES} and {IMAGES}CAMERA"
            raise QueryError(f"{path}: environments have no input {name}, only {known}; train it on these")
    return functions


def check_actions(checkpoint: LeRobotCheckpoint, env: TaskEnv) -> None:
    """Check that the actions of a policy are those of an environment's control.

    Raises:
        QueryError: the actions have a different convention, rate or size.
    """
    determined, path = checkpoint.options(), checkpoint.path
    for name, value, here in (("control", str, env.control.name), ("rate", int, env.control.rate)):
        if name in determined and value(determined[name]) != here:
            raise QueryError(
                f"{path}: was trained with {name} {determined[name]}, the environment has {here}; leave {name} out"
            )
    action = checkpoint.config.output_features.get("action", TensorShape([]))
    if checkpoint.export is None and action.shape != [len(env.control.low)]:
        raise QueryError(
            f"{path}: its actions have the shape {action.shape}, those of {env.control.name} [{len(env.control.low)}]; "
            "the dataset of its training is not found, so give --control and --env rate=R as in its training"
        )


def environment(text: str) -> dict[str, Any]:
    """Return the environment options that a checkpoint determines.

    Raises:
        QueryError: the folder is not a checkpoint.
    """
    return LeRobotCheckpoint.open(text).options()


def files(text: str) -> list[Path]:
    """Return the files of the policy: all files in the folder of a checkpoint."""
    return [file for file in Path(text).iterdir() if file.is_file()]


def maker(text: str) -> PolicyMaker:
    """Return the maker of the policy in a checkpoint.

    Raises:
        QueryError: the folder is not a checkpoint.
    """
    return partial(LeRobotPolicy, LeRobotCheckpoint.open(text))


def _loaded(checkpoint: LeRobotCheckpoint) -> tuple[Any, Any, Any, Any]:
    """Return the `torch` module, and the policy and the two processors of a checkpoint."""
    path = checkpoint.path
    try:
        with redirect_stdout(sys.stderr):
            torch, factory = import_module("torch"), import_module("lerobot.policies.factory")
            configs = import_module("lerobot.configs.policies")
    except ImportError as error:
        raise QueryError(
            f'{path}: LeRobot cannot be imported: {error}; install it: pip install "prag_asp[lerobot]"'
        ) from None
    torch.set_num_threads(1)
    try:
        with redirect_stdout(sys.stderr):
            config = configs.PreTrainedConfig.from_pretrained(path)
            if hasattr(config, "pretrained_backbone_weights"):
                config.pretrained_backbone_weights = None  # not downloaded, because the checkpoint contains them
            policy = factory.get_policy_class(checkpoint.config.type).from_pretrained(path, config=config)
            device = {"device_processor": {"device": str(policy.config.device)}}
            moved = any(step.registry_name == "device_processor" for step in checkpoint.steps)
            before, after = factory.make_pre_post_processors(
                policy.config, str(path), preprocessor_overrides=device if moved else {}
            )
    except Exception as error:  # a checkpoint may raise anything
        reason = " ".join(f"{type(error).__name__}: {error}".split())
        raise QueryError(f"{path}: cannot be loaded: {reason:.300}; use the LeRobot that trained it") from None
    policy.eval()
    return torch, policy, before, after


def _states_of(path: Path, feature: ExportedFeature, env: TaskEnv) -> tuple[StateName, ...]:
    """Return the names of the state vectors that a policy reads.

    Raises:
        QueryError: the states of the environment have different names or a different size.
    """
    stored = feature.prag_asp.get("states")
    choices = [tuple(stored)] if stored is not None else [(name,) for name in STATES]
    for names in choices:
        if set(names) <= set(STATES):
            numbers = state_names(names, env.scene)
            if feature.shape == [len(numbers)] and feature.names in (None, numbers):
                return names
    raise QueryError(
        f"{path}: its {STATE} has {feature.shape} numbers, which are not a state of {', '.join(env.scene.robots)} "
        f"({' or '.join(STATES)}); evaluate it with the robots of its training"
    )


def _state(env: TaskEnv, names: tuple[StateName, ...], observation: Any) -> NDArray[np.float32]:
    """Return the state of the robots."""
    return arm_state(env, names)


def _bodies(env: TaskEnv, observation: Any) -> NDArray[np.float32]:
    """Return the poses of objects and the openings of furniture."""
    return body_values(env.situation)


def _image(camera: str, observation: Any) -> NDArray[np.float32]:
    """Return the image from a camera, with values from 0 to 1; shape (3, H, W)."""
    image: NDArray[np.float32] = observation[camera].transpose(2, 0, 1).astype(np.float32) / 255
    return image
