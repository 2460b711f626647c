"""Initial states of episodes for learning: subgoals of witnesses for training and for tests; and features."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Generator, Mapping, Sequence
from typing import Any, NamedTuple

import gymnasium
import numpy as np
from numpy.typing import NDArray

from prag_asp import Task, TaskSpace, load_domain
from prag_asp.dataset.scenes import scene_of
from prag_asp.physics import Witness, open_validator
from prag_asp.rl import Layout, TaskEnv
from prag_asp.rl.goal_env import Observation
from prag_asp.rl.goals import PLACES
from prag_asp.space.weights.weights import Number

DOMAINS = {"approach": "prag", "grasp": "prag", "pick": "tabletop", "place": "tabletop"}
"""The domain in which each skill is learned."""

TRAINING, HELD_OUT, FRESH = 1, 2, 5
"""The seeds of the tasks and witnesses for training, for validation, and for the final test.

Settings were chosen on the second set, so only the third gives an unbiased estimate. (3 and 4 are the oracle's.)
"""


class Start(NamedTuple):
    """A subgoal of a task, by its number, that begins in the state of a witness."""

    task: Task
    witness: Witness
    stage: int

    @property
    def options(self) -> dict[str, Any]:
        """The options of `reset`."""
        return self._asdict()


def witnessed(
    domain: str, length: int, *, seed: int, weights: Mapping[str, Number] | None = None
) -> Generator[tuple[Task, Witness], None, None]:
    """Yield feasible tasks with their witnesses, sampled uniformly or by weights of actions, without end."""
    loaded = load_domain(domain)
    with open_validator(scene_of(loaded)) as validator:
        for index, task in enumerate(TaskSpace(loaded, length).stream(seed=seed, weights=weights or {})):
            witness = validator.validate(task, seed=seed, index=index).witness
            if witness is not None:
                yield task, witness


def starts(
    skill: str,
    count: int,
    *,
    seed: int,
    length: int = 2,
    only: str | None = None,
    without: str | None = None,
    last: bool = False,
) -> list[Start]:
    """Return subgoals of a skill, one of each task.

    Their action names the object `only`; their task does not name the object `without`. With `last`, each is the last
    subgoal of its task, and not also the first.
    """
    result: list[Start] = []
    for task, witness in witnessed(DOMAINS[skill], length, seed=seed):
        named = {argument for action in task.actions for argument in action.arguments}
        stages = [
            stage
            for stage, action in enumerate(task.actions)
            if action.name == skill
            and (only is None or only in action.arguments)
            and (not last or 0 < stage == length - 1)
        ]
        if stages and without not in named:
            result.append(Start(task, witness, stages[-1]))
        if len(result) == count:
            break
    return result


def wholly(skills: Sequence[str], count: int, *, seed: int) -> list[Start]:
    """Return `count` witnesses of the tasks whose actions have these names, tasks in turn, from the home pose."""
    loaded, result = load_domain(DOMAINS[skills[-1]]), list[Start]()
    tasks = [task for task in TaskSpace(loaded, len(skills)) if [action.name for action in task.actions] == [*skills]]
    with open_validator(scene_of(loaded)) as validator:
        for index in itertools.count():
            task = tasks[index % len(tasks)]
            if len(result) == count:
                return result
            witness = validator.validate(task, seed=seed, index=index).witness
            if witness is not None:
                result.append(Start(task, witness, 0))


def require_apart(learned: Sequence[Start], tested: Sequence[Start], *, tasks: bool) -> None:
    """Check that training and test sets share no witness and, with `tasks`, no task.

    Raises:
        ValueError: they share one.
    """
    training_tasks = {str(start.task) for start in learned}
    for start in tested:
        same = [other for other in learned if other.task == start.task and other.witness == start.witness]
        if same or (tasks and str(start.task) in training_tasks):
            raise ValueError(f"{start.task} is in the training set and cannot be held out")


class FromStarts(gymnasium.Wrapper):
    """Begins each episode with one of the given subgoals, sampled (with a seed) or in turn.

    Without `at_stage`, an episode has the same task and witness, but the environment chooses the stage.
    """

    def __init__(self, env: gymnasium.Env, starts: Sequence[Start], *, seed: int | None = None, at_stage: bool = True):
        super().__init__(env)
        self._starts, self._next, self._at_stage = starts, 0, at_stage
        self._rng = None if seed is None else np.random.default_rng(seed)

    def reset(self, *, seed: int | None = None, options: dict[str, Any] | None = None) -> Any:
        """Begin an episode with one of the subgoals; `options` take precedence."""
        number = self._next if self._rng is None else int(self._rng.integers(len(self._starts)))
        self._next = (number + 1) % len(self._starts)
        start = self._starts[number].options
        stage = {} if self._at_stage else {"stage": None}
        return self.env.reset(seed=seed, options={**start, **stage, **(options or {})})


MOTION_SCALE = {"grasp": 0.2}
"""The factor of the tool's motion while a skill is learned, relative to the environment's; by default 1."""


def action_scale(skill: str) -> NDArray[np.float32]:
    """Return the factors of the action of a policy for a skill."""
    scale = MOTION_SCALE.get(skill, 1.0)
    return np.array([scale, scale, scale, scale, 1.0], dtype=np.float32)


class ScaledActions(gymnasium.ActionWrapper):
    """Scales actions by the factors of the current skill."""

    def action(self, action: NDArray[np.float32]) -> NDArray[np.float32]:
        """Return the action of the environment."""
        return action * action_scale(self.unwrapped.action.name)


class SkillObservations(gymnasium.ObservationWrapper):
    """Replaces observations by the features of `features_of`."""

    def __init__(self, env: TaskEnv):
        super().__init__(env)
        self._features = features_of(env.layout)
        size = self._features(env.observation_space.sample()).size
        self.observation_space = gymnasium.spaces.Box(-np.inf, np.inf, (size,), np.float32)

    def observation(self, observation: Observation) -> NDArray[np.float32]:
        """Return the features of an observation."""
        return self._features(observation)


SCALES = {
    "z": 10.0, "vx": 2.0, "vy": 2.0, "vz": 2.0, "cos yaw": 1.0, "sin yaw": 1.0, "width": 25.0, "asked width": 25.0,
    "dx": 10.0, "dy": 10.0, "dz": 10.0, "cos turn": 1.0, "sin turn": 1.0, "half x": 20.0, "half y": 20.0,
    "half z": 20.0,
}  # fmt: skip
"""The factors that scale observations of the arm and of bodies to about 1."""

MISSED = 10.0
"""The factor of the distance by which a fact is missed."""


def features_of(layout: Layout) -> Callable[[Observation], NDArray[np.float32]]:
    """Return a function that extracts the features of a skill from an observation, scaled to about 1.

    They are the tool, the gripper, the bodies relative to the tool, the skill, and the distance to each fact.
    """
    scales = np.array([_scale(name) for name in layout.names], dtype=np.float32)
    places = np.flatnonzero(scales)

    def features(observation: Observation) -> NDArray[np.float32]:
        missed = np.clip(observation["achieved_goal"][1:PLACES] * MISSED, -1.0, 5.0)
        return np.concatenate([observation["observation"][places] * scales[places], missed], dtype=np.float32)

    return features


def _scale(name: str) -> float:
    """Return the factor of a component of an observation; 0 if it is omitted."""
    owner, separator, what = name.partition(": ")
    if not separator:
        return 1.0
    if owner.startswith("body") and what in ("z", "cos yaw", "sin yaw"):
        return 0.0
    return SCALES.get(what, 0.0)
