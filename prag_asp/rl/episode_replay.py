"""Replay the recordings of a dataset in the environment, with the actions that its exports contain."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from prag_asp.dataset.formats.episode_source import EpisodeSource
from prag_asp.dataset.store.dataset import Dataset
from prag_asp.physics.control.names import ControlName
from prag_asp.rl.environment import TaskEnv
from prag_asp.task import Task

SETTLING = 1.0
"""The time in seconds for which the last targets are held while a subgoal is not reached, because bodies may still
move.
"""


class Replay(NamedTuple):
    """The replay of a recording: the task, the number of the initial state, and the number of subgoals `reached`."""

    task: Task
    start: int
    reached: int
    steps: int

    @property
    def success(self) -> bool:
        """Whether all subgoals were reached."""
        return self.reached == len(self.task.actions)


def replay(dataset: Dataset | str | Path, control: ControlName = "joint_position") -> Iterator[Replay]:
    """Replay each recording in a dataset as actions of a control, at the rate of the recordings, and yield the replays.

    Raises:
        QueryError: the dataset has no recordings, or the control cannot express them.
    """
    data = dataset if isinstance(dataset, Dataset) else Dataset.open(dataset)
    source = EpisodeSource(data, action=control)
    source.require_recordings()
    witnesses = data.witnesses()
    env = TaskEnv(dataset=data, control=control, rate=source.rate)
    try:
        for episode in source.episodes():
            entry, start, witness = next(witnesses)
            while (entry.part, entry.number, start) != (episode.entry.part, episode.entry.number, episode.start):
                entry, start, witness = next(witnesses)
            settling = round(SETTLING * source.rate)
            _, info = env.reset(options={"task": entry.task, "witness": witness, "steps": episode.length + settling})
            steps = 0
            for action in _held(env, source.actions_of(episode), settling):
                _, _, done, late, info = env.step(action)
                steps += 1
                if done or late:
                    break
            yield Replay(entry.task, start, info["stage"] + bool(info["is_success"]), steps)
    finally:
        env.close()


def _held(env: TaskEnv, actions: NDArray[np.float32], settling: int) -> Iterator[NDArray[np.float32]]:
    """Yield actions, and then actions that hold the last targets."""
    yield from actions
    last = actions[-1].copy()
    if not env.control.convention.absolute:
        size = len(env.control.convention.numbers)
        last.reshape(-1, size)[:, :-1] = 0.0
    for _ in range(settling):
        yield last
