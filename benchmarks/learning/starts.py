"""Initial states of episodes: subgoals of witnesses, for training and for tests."""

from __future__ import annotations

from collections.abc import Generator, Mapping
from typing import Any, NamedTuple

from prag_asp import Task, TaskSpace, load_domain
from prag_asp.dataset.scenes import scene_of
from prag_asp.physics import Witness, open_validator
from prag_asp.space.weights.weights import Number

DOMAINS = {"approach": "prag", "grasp": "prag", "pick": "tabletop", "place": "tabletop"}
"""The domain in which each skill is learned."""

TRAINING, HELD_OUT = 1, 2
"""The seeds of the tasks and witnesses for training and for tests. (3 and 4 are the oracle's.)"""


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
) -> list[Start]:
    """Return subgoals of a skill, one of each task."""
    result: list[Start] = []
    for task, witness in witnessed(DOMAINS[skill], length, seed=seed):
        stages = [stage for stage, action in enumerate(task.actions) if action.name == skill]
        if stages:
            result.append(Start(task, witness, stages[-1]))
        if len(result) == count:
            break
    return result
