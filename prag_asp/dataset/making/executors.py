"""Executors that validate draws: this process, several of this machine, or the nodes of a Ray cluster."""

from __future__ import annotations

from collections.abc import Generator, Iterator
from contextlib import closing
from dataclasses import dataclass
from typing import Protocol

from prag_asp.dataset.validation_jobs import JobResult, ValidationJob, ValidationSetup, open_job_validator
from prag_asp.errors import QueryError
from prag_asp.missing import require_ray

CHUNK = 4
"""Searches that a process of this machine gets together: some seconds of work, much more than sending them."""

RAY = "ray"
"""The name of the executor that is not on this machine."""


class Executor(Protocol):
    """Validates draws, with the same results in the same order as any other executor."""

    @property
    def captions(self) -> bool:
        """Whether jobs come as draws, whose tasks, texts and rows are made there."""
        ...

    def run(self, jobs: Iterator[ValidationJob], setup: ValidationSetup) -> Generator[JobResult, None, None]:
        """Yield the results of jobs, in their order; closing the iterator ends the work at once.

        Raises:
            SceneError: a task names something for which the scene has no shape.
            WorkerError: workers died again and again, or there are none.
        """
        ...


@dataclass(frozen=True)
class LocalExecutor:
    """A number of processes of this machine, or this one alone with one worker or without physics."""

    workers: int
    captions: bool = False

    def run(self, jobs: Iterator[ValidationJob], setup: ValidationSetup) -> Generator[JobResult, None, None]:
        """Yield the results of jobs, in their order."""
        if self.workers == 1 or setup.scene is None:
            with open_job_validator(setup) as validate:
                for job in jobs:
                    yield validate([job])[0]
            return
        from prag_asp.physics.pool import pooled

        numbered = ((job.search, job) for job in jobs)
        chunk = max(CHUNK // setup.starts, 1)
        with closing(pooled(numbered, "prag_asp.dataset.validation_jobs", setup, self.workers, chunk=chunk)) as found:
            yield from found


def executor_of(workers: int, on: str | None) -> Executor:
    """Return the executor that is requested.

    Raises:
        QueryError: there is none of that name, no worker, or workers are requested of Ray, which has its own.
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
