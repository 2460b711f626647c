"""Where learners begin: subgoals of witnesses, apart for training and for testing, and what they see of them."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Any, NamedTuple

import gymnasium
import numpy as np
from numpy.typing import NDArray

from prag_asp import Task, TaskSpace, load_domain
from prag_asp.dataset.scenes import scene_of
from prag_asp.physics import Witness, open_validator
from prag_asp.rl import Layout, TaskEnv
from prag_asp.rl.environment import Observation

DOMAINS = {"approach": "prag", "grasp": "prag", "pick": "tabletop", "place": "tabletop"}
"""The domain in which a skill is learned."""

TRAINING, HELD_OUT, FRESH = 1, 2, 5
"""The seeds of the tasks, and of their witnesses, to learn from, to be tested with, and for the last test.

Settings were chosen by looking at the second, so only the third says how well they do. (3 and 4 are the oracle's.)
"""


class Start(NamedTuple):
    """A subgoal of a task, by its number, begun in the state of a witness."""

    task: Task
    witness: Witness
    stage: int

    @property
    def options(self) -> dict[str, Any]:
        """What a reset is told."""
        return self._asdict()


def witnessed(
    domain: str, length: int, *, seed: int, weights: Mapping[str, float] | None = None
) -> Iterator[tuple[Task, Witness]]:
    """Yield feasible tasks with their witnesses, drawn uniformly, or by weights of actions, without end."""
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

    Their action names the object `only`; their task does not name the one of `without`. With `last`, they are the last
    ones of their tasks, and not the first as well.
    """
    found: list[Start] = []
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
            found.append(Start(task, witness, stages[-1]))
        if len(found) == count:
            break
    return found


def wholly(skills: Sequence[str], count: int, *, seed: int) -> list[Start]:
    """Return so many witnesses of all tasks that have these skills one after the other, by turns, begun at home."""
    loaded, found = load_domain(DOMAINS[skills[-1]]), list[Start]()
    tasks = [task for task in TaskSpace(loaded, len(skills)) if [action.name for action in task.actions] == [*skills]]
    with open_validator(scene_of(loaded)) as validator:
        for index in itertools.count():
            task = tasks[index % len(tasks)]
            if len(found) == count:
                return found
            witness = validator.validate(task, seed=seed, index=index).witness
            if witness is not None:
                found.append(Start(task, witness, 0))


def require_apart(learned: Sequence[Start], tested: Sequence[Start], *, tasks: bool) -> None:
    """Make sure that no witness that is learned from is tested with, and where `tasks` are held out, no task either.

    Raises:
        ValueError: there is one.
    """
    known = {str(start.task) for start in learned}
    for start in tested:
        same = [other for other in learned if other.task == start.task and other.witness == start.witness]
        if same or (tasks and str(start.task) in known):
            raise ValueError(f"{start.task} is learned from, and cannot be held out")


class FromStarts(gymnasium.Wrapper):
    """Begins each episode with one of some subgoals, drawn or in turn.

    Without `there`, it begins with the stage that the environment chooses, of the same task and witness.
    """

    def __init__(self, env: gymnasium.Env, given: Sequence[Start], *, seed: int | None = None, there: bool = True):
        super().__init__(env)
        self._given, self._next, self._there = given, 0, there
        self._rng = None if seed is None else np.random.default_rng(seed)

    def reset(self, *, seed: int | None = None, options: dict[str, Any] | None = None) -> Any:
        """Begin an episode with one of the subgoals, but as the options say."""
        number = self._next if self._rng is None else int(self._rng.integers(len(self._given)))
        self._next = (number + 1) % len(self._given)
        asked = self._given[number].options
        whence = {} if self._there else {"stage": None}
        return self.env.reset(seed=seed, options={**asked, **whence, **(options or {})})


GENTLY = {"grasp": 0.2}
"""How far the tool moves at an action of 1 where a skill is learned, beside how far the environment lets it."""


def moved(skill: str) -> NDArray[np.float32]:
    """Return by what the action of a policy that has learned a skill is multiplied."""
    gently = GENTLY.get(skill, 1.0)
    return np.array([gently, gently, gently, gently, 1.0], dtype=np.float32)


class Moved(gymnasium.ActionWrapper):
    """Moves the tool as it is done where the skill is learned that is being pursued."""

    def action(self, action: NDArray[np.float32]) -> NDArray[np.float32]:
        """Return the action of the environment."""
        return action * moved(self.unwrapped.action.name)


class Seen(gymnasium.ObservationWrapper):
    """Shows what `shown` does, in place of all that there is."""

    def __init__(self, env: TaskEnv):
        super().__init__(env)
        self._shown = shown(env.layout)
        size = self._shown(env.observation_space.sample()).size
        self.observation_space = gymnasium.spaces.Box(-np.inf, np.inf, (size,), np.float32)

    def observation(self, observation: Observation) -> NDArray[np.float32]:
        """Return what is shown."""
        return self._shown(observation)


SCALES = {
    "z": 10.0, "vx": 2.0, "vy": 2.0, "vz": 2.0, "cos yaw": 1.0, "sin yaw": 1.0, "width": 25.0, "asked width": 25.0,
    "dx": 10.0, "dy": 10.0, "dz": 10.0, "cos turn": 1.0, "sin turn": 1.0, "half x": 20.0, "half y": 20.0,
    "half z": 20.0,
}  # fmt: skip
"""By how many times what is told of the arm and of bodies is shown, so that it is about 1."""

MISSED = 10.0
"""By how many times what a fact is missed by is shown."""


def shown(layout: Layout) -> Callable[[Observation], NDArray[np.float32]]:
    """Return what makes of an observation what matters to a skill, as numbers of about 1.

    That is the tool, the gripper, the bodies relative to the tool, the skill, and by how much each fact is missed.
    """
    scales = np.array([_scale(name) for name in layout.names], dtype=np.float32)
    places = np.flatnonzero(scales)

    def show(observation: Observation) -> NDArray[np.float32]:
        missed = np.clip(observation["achieved_goal"][0, 1:] * MISSED, -1.0, 5.0)
        return np.concatenate([observation["observation"][places] * scales[places], missed], dtype=np.float32)

    return show


def _scale(name: str) -> float:
    """Return by how many times a number of an observation is shown, 0 where it is not."""
    whose, told, what = name.partition(": ")
    if not told:
        return 1.0
    if whose.startswith("body") and what in ("z", "cos yaw", "sin yaw"):
        return 0.0
    return SCALES.get(what, 0.0)
