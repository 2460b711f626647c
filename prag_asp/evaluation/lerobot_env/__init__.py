"""An environment type for LeRobot, ``lerobot-eval --env.type=prag_asp``.

LeRobot imports this package with ``--env.discover_packages_path=prag_asp.evaluation.lerobot_env``. Only this package
imports LeRobot's environment configurations.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import gymnasium
from lerobot.configs.types import FeatureType, PolicyFeature
from lerobot.envs.configs import EnvConfig

from prag_asp.evaluation.lerobot_view import LeRobotView
from prag_asp.rl.environment import TaskEnv

NAME = "prag_asp/LeRobot-v0"
"""The name of the environments, which are registered when this package is imported."""

PIXELS = "pixels"


@EnvConfig.register_subclass("prag_asp")
@dataclass
class LeRobotTasks(EnvConfig):  # type: ignore[misc]  # LeRobot has no types for mypy
    """The configuration of environments whose observations and actions are as in `prag-asp export lerobot`.

    `task` is the name or the folder of a domain, and `length` gives the lengths of its tasks; alternatively, `dataset`
    is the folder of a dataset. `where`, `split`, `hold_out`, `control` and `cameras` are as for `TaskEnv`; images are
    `size` pixels wide and high. `state` lists the conventions of the state. There are `fps` actions per second, and at
    most `episode_length` in an episode.
    """

    task: str | None = "tabletop"
    fps: int = 20
    length: str = "1"
    dataset: str | None = None
    where: list[str] = field(default_factory=list)
    split: str | None = None
    hold_out: str | None = None
    control: str = "joint_position"
    state: list[str] = field(default_factory=lambda: ["joint_position"])
    cameras: list[str] = field(default_factory=list)
    size: int = 128
    episode_length: int = 200

    def __post_init__(self) -> None:
        """Derive the features from the spaces of an environment."""
        env = lerobot_env(**self.gym_kwargs)
        observed: Any = env.observation_space
        seen, actions = dict(observed.spaces), env.action_space.shape
        env.close()
        self.features = {"action": PolicyFeature(FeatureType.ACTION, actions)}
        self.features_map = {"action": "action", "agent_pos": "observation.state"}
        for name, image in seen.pop(PIXELS, {}).items():
            self.features[f"{PIXELS}/{name}"] = PolicyFeature(FeatureType.VISUAL, image.shape)
            self.features_map[f"{PIXELS}/{name}"] = f"observation.images.{name}"
        kinds = {"agent_pos": FeatureType.STATE, "environment_state": FeatureType.ENV}
        self.features |= {name: PolicyFeature(kinds[name], space.shape) for name, space in seen.items()}
        self.features_map |= {name: f"observation.{name}" for name in seen if name != "agent_pos"}

    @property
    def package_name(self) -> str:
        """The package that registers the environments."""
        return __name__

    @property
    def gym_id(self) -> str:
        """The name of the environments."""
        return NAME

    @property
    def gym_kwargs(self) -> dict[str, Any]:
        """The arguments for `lerobot_env`."""
        tasks = {"domain": self.task, "length": self.length} if self.dataset is None else {"dataset": self.dataset}
        images = {"cameras": tuple(self.cameras), "size": self.size if self.cameras else None}
        return {
            **tasks, **images, "where": tuple(self.where), "split": self.split, "hold_out": self.hold_out,
            "control": self.control, "rate": self.fps, "steps": self.episode_length, "state": tuple(self.state),
        }  # fmt: skip


def lerobot_env(*, steps: int, state: tuple[Any, ...], render_mode: Any = "rgb_array", **options: Any) -> LeRobotView:
    """Make an environment with at most `steps` steps in an episode; `options` are arguments of `TaskEnv`."""
    return LeRobotView(TaskEnv(steps=steps, reward="sparse", render_mode=render_mode, **options), steps, state)


# LeRobot reads attributes of the outermost wrapper, so Gymnasium must not add its own.
gymnasium.register(NAME, entry_point=f"{__name__}:lerobot_env", order_enforce=False, disable_env_checker=True)
