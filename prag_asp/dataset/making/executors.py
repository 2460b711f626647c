"""Executors that validate draws: this process, several processes on this machine, or the nodes of a Ray cluster."""

from __future__ import annotations

from collections.abc import Generator, Iterator
from contextlib import closing
from dataclasses import dataclass
from functools import partial
from typing import Protocol

from prag_asp.dataset.validation_jobs import JobResult, ValidationJob, ValidationSetup, open_job_validator
from prag_asp.errors import QueryError
from prag_asp.missing import require_ray

CHUNK = 4
"""The number of searches sent to a local process at a time: a few seconds of work, much longer than the transfer."""

RAY = "ray"
"""The name of the remote executor."""


class Executor(Protocol):
    """An executor that validates draws; all executors yield the same results in the same order."""

    @property
    def captions(self) -> bool:
        """Whether the executor also decodes draws into tasks, and writes their texts and rows."""
        ...

    def run(self, jobs: Iterator[ValidationJob], setup: ValidationSetup) -> Generator[JobResult, None, None]:
        """Yield the results of jobs in order; closing the iterator ends the work at once.

        Raises:
            SceneError: the scene lacks the shape of an entity in a task.
            WorkerError: workers died repeatedly, or there are none.
        """
        ...


@dataclass(frozen=True)
class LocalExecutor:
    """Worker processes on this machine, or the current process if there is only one worker or no physics."""

    workers: int
    captions: bool = False

    def run(self, jobs: Iterator[ValidationJob], setup: ValidationSetup) -> Generator[JobResult, None, None]:
        """Yield the results of jobs in order."""
        if self.workers == 1 or setup.scene is None:
            with open_job_validator(setup) as validate:
                for job in jobs:
                    yield validate(job.search, job)
            return
        from prag_asp.physics.validator import ACTIVITY
        from prag_asp.processes.worker_pool import map_ordered

        numbered = ((job.search, job) for job in jobs)
        chunk = max(CHUNK // setup.spec.starts, 1)
        opened = partial(open_job_validator, setup)
        with closing(map_ordered(numbered, opened, self.workers, activity=ACTIVITY, chunk=chunk)) as results:
            yield from results


def executor_of(workers: int, on: str | None) -> Executor:
    """Return the requested executor.

    Raises:
        QueryError: there is no such executor, or `workers` is below 1, or above 1 for Ray, which has its own workers.
        RayMissingError: Ray is not installed.
    """
    if workers < 1:
        raise QueryError(f"validation needs at least 1 worker; got {workers}")
    if on is None:
        return LocalExecutor(workers)
    if on != RAY:
        raise QueryError(f"no executor {on!r}; there is {RAY}")
    if workers > 1:
        raise QueryError("a Ray cluster has as many workers as it has processors; leave the number of workers out")
    require_ray()
    from prag_asp.dataset.making.on_ray import RayExecutor

    return RayExecutor()
