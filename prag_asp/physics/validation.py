"""Validate many tasks, or check many witnesses, in order, in one process or in several with the same verdicts.

Each task has its own random generator, seeded with the seed and the task's index. Workers are spawned, not forked,
because PyBullet does not survive a fork; each keeps one simulator for all its tasks.
"""

from __future__ import annotations

from collections.abc import Callable, Generator, Iterable, Iterator
from contextlib import contextmanager
from functools import partial

from prag_asp.errors import QueryError
from prag_asp.physics.filming.episode_options import Staging
from prag_asp.physics.tiers import TierOutcome, open_tier_check
from prag_asp.physics.validator import ACTIVITY, open_validator
from prag_asp.physics.verdict import Budget, Verdict
from prag_asp.physics.witness import Witness
from prag_asp.processes.worker_pool import map_ordered
from prag_asp.scene.scene import Scene
from prag_asp.task import Task


def validate_tasks(
    tasks: Iterable[Task],
    scene: Scene,
    *,
    seed: int,
    workers: int = 1,
    budget: Budget | None = None,
    staging: Staging | None = None,
) -> Generator[Verdict, None, None]:
    """Yield the verdict on each task, in the order of the tasks, which may be infinite; they are numbered from 0.

    `staging` has the options of demonstrations, if the budget includes that tier. A single worker runs in this process;
    several workers run in separate processes. The verdicts do not depend on the number of workers. If a worker is
    killed, a new one repeats its tasks. Closing the iterator ends the workers at once.

    Raises:
        QueryError: the number of workers is not positive, or the scene lacks a camera.
        SceneError: the scene cannot be built, or a task contains an entity that has no shape.
        WorkerError: workers died repeatedly on the same tasks, or cannot be started.
    """
    return validate_numbered(enumerate(tasks), scene, seed=seed, workers=workers, budget=budget, staging=staging)


def validate_numbered(
    tasks: Iterable[tuple[int, Task]],
    scene: Scene,
    *,
    seed: int,
    workers: int = 1,
    budget: Budget | None = None,
    staging: Staging | None = None,
) -> Generator[Verdict, None, None]:
    """Yield the verdict on each task with its index; it depends on the seed and the index, not on the order.

    Raises:
        PragError: see `validate_tasks`.
    """
    if workers < 1:
        raise QueryError(f"validation needs at least 1 worker; got {workers}")
    if staging is not None:
        staging.cameras_of(scene)
    opener = partial(_open_validation, scene, seed, budget or Budget(), staging)
    return map_ordered(tasks, opener, workers, activity=ACTIVITY)


def check_numbered(
    witnesses: Iterable[tuple[int, tuple[Task, Witness]]],
    scene: Scene,
    *,
    budget: Budget,
    seed: int = 0,
    workers: int = 1,
    staging: Staging | None = None,
) -> Generator[TierOutcome, None, None]:
    """Yield the result of passing each witness through a budget's tiers, in order; tasks come with their indices.

    Closing the iterator ends the workers at once.

    Raises:
        QueryError: the number of workers is not positive.
        SceneError: the scene cannot be built.
        WorkerError: workers died repeatedly on the same tasks, or cannot be started.
    """
    if workers < 1:
        raise QueryError(f"checking needs at least 1 worker; got {workers}")
    opener = partial(_open_check, scene, seed, budget, staging)
    return map_ordered(witnesses, opener, workers, activity=ACTIVITY)


@contextmanager
def _open_validation(
    scene: Scene, seed: int, budget: Budget, staging: Staging | None
) -> Iterator[Callable[[int, Task], Verdict]]:
    with open_validator(scene) as validator:
        yield lambda index, task: validator.validate(task, seed=seed, index=index, budget=budget, staging=staging)


@contextmanager
def _open_check(
    scene: Scene, seed: int, budget: Budget, staging: Staging | None
) -> Iterator[Callable[[int, tuple[Task, Witness]], TierOutcome]]:
    with open_tier_check(scene, budget, staging, seed) as check:
        yield lambda index, shown: check(*shown, index)
