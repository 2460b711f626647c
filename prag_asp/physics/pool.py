"""Validate many tasks, in order, in one process or in several: the verdicts are the same.

Each task has its own generator of random numbers, seeded from the seed and its index. Workers are spawned,
because PyBullet does not survive a fork; each keeps one simulator for all its tasks.
"""

from __future__ import annotations

import os
import signal
import threading
from collections import deque
from collections.abc import Generator, Iterable, Iterator
from concurrent.futures import Future, ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from contextlib import ExitStack
from dataclasses import dataclass
from itertools import islice
from multiprocessing import get_context
from multiprocessing.connection import Connection, wait

from prag_asp.errors import PragError, QueryError, SceneError
from prag_asp.physics.bullet import STDOUT, silence
from prag_asp.physics.validator import Validator, open_validator
from prag_asp.physics.verdict import Budget, Verdict
from prag_asp.scene.model import Scene
from prag_asp.task import Task

CHUNK = 4
CHUNKS_AHEAD = 3
REPLACEMENTS = 5


class WorkerError(PragError):
    """The processes that validate tasks died again and again."""


Numbered = tuple[int, Task]
"""The index of a task, and the task."""

Chunk = tuple[Numbered, ...]
"""Tasks that go to a worker together."""


def validate_tasks(
    tasks: Iterable[Task],
    scene: Scene,
    *,
    seed: int,
    workers: int = 1,
    budget: Budget | None = None,
) -> Generator[Verdict, None, None]:
    """Yield the verdict on each task, in the order of the tasks, which may be endless; they are numbered from 0.

    One worker runs in this process, more are spawned; the verdicts do not depend on it. Tasks of a worker
    that was killed are done again in a new pool. Closing the iterator ends the workers at once.

    Raises:
        QueryError: the number of workers is not positive.
        SceneError: the scene cannot be built, or a task speaks about something for which it has no shape.
        WorkerError: workers died more than `REPLACEMENTS` times in a row.
    """
    return validate_numbered(enumerate(tasks), scene, seed=seed, workers=workers, budget=budget)


def validate_numbered(
    tasks: Iterable[Numbered],
    scene: Scene,
    *,
    seed: int,
    workers: int = 1,
    budget: Budget | None = None,
) -> Generator[Verdict, None, None]:
    """Yield the verdict on each task with its index, of which alone it depends, not of the order of the tasks.

    Raises:
        PragError: as `validate_tasks` does.
    """
    if workers < 1:
        raise QueryError(f"validation needs at least 1 worker; got {workers}")
    budget = budget or Budget()
    if workers == 1:
        return _in_process(tasks, scene, seed, budget)
    return _in_pool(tasks, scene, seed, workers, budget)


def _in_process(tasks: Iterable[Numbered], scene: Scene, seed: int, budget: Budget) -> Generator[Verdict, None, None]:
    """Yield verdicts found in this process."""
    with open_validator(scene) as validator:
        for index, task in tasks:
            yield validator.validate(task, seed=seed, index=index, budget=budget)


def _in_pool(
    tasks: Iterable[Numbered], scene: Scene, seed: int, workers: int, budget: Budget
) -> Generator[Verdict, None, None]:
    """Yield verdicts found in spawned processes, a bounded number of tasks ahead."""
    waiting: deque[tuple[Chunk, Future[list[Verdict]] | None]] = deque()
    chunks = _chunks(tasks)
    pool = _Pool(scene, workers, seed, budget)
    failures = 0
    try:
        while True:
            for chunk in islice(chunks, workers * CHUNKS_AHEAD - len(waiting)):
                waiting.append((chunk, None))
            if not waiting:
                return
            try:
                for i, (chunk, future) in enumerate(waiting):
                    if future is None:
                        waiting[i] = (chunk, pool.submit(chunk))
                first = waiting[0][1]
                assert first is not None
                verdicts = first.result()
            except BrokenProcessPool as error:
                failures += 1
                if failures > REPLACEMENTS:
                    index = waiting[0][0][0][0]
                    raise WorkerError(
                        f"workers died {failures} times in a row around task {index}; "
                        "is there enough memory? Try fewer workers"
                    ) from error
                pool.kill()
                pool = _Pool(scene, workers, seed, budget)
                waiting = deque((chunk, future if _done(future) else None) for chunk, future in waiting)
                continue
            failures = 0
            waiting.popleft()
            yield from verdicts
    finally:
        pool.kill()


def _chunks(tasks: Iterable[Numbered]) -> Iterator[Chunk]:
    """Yield the tasks in groups, so that fewer messages go between processes."""
    iterator = iter(tasks)
    while group := tuple(islice(iterator, CHUNK)):
        yield group


def _done(future: Future[list[Verdict]] | None) -> bool:
    """Tell whether a chunk has its verdicts."""
    return future is not None and future.done() and not future.cancelled() and future.exception() is None


class _Pool:
    """Spawned processes, each with a validator."""

    def __init__(self, scene: Scene, workers: int, seed: int, budget: Budget):
        self._settings = (seed, budget)
        context = get_context("spawn")
        lifeline, self._held = context.Pipe(duplex=False)
        self._executor = ProcessPoolExecutor(
            workers, mp_context=context, initializer=_start_worker, initargs=(scene, lifeline)
        )

    def submit(self, chunk: Chunk) -> Future[list[Verdict]]:
        """Hand a chunk to a worker; one that is started for it never sees Ctrl-C, which is for its parent to answer."""
        before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
        try:
            return self._executor.submit(_validate_chunk, chunk, *self._settings)
        finally:
            signal.pthread_sigmask(signal.SIG_SETMASK, before)

    def kill(self) -> None:
        """End the workers in the middle of what they do, and wait until they are gone.

        Leaving the executor in peace would finish the chunks that it has already handed out.
        """
        self._held.close()
        self._executor.shutdown(wait=True, cancel_futures=True)


@dataclass
class _Worker:
    """What a spawned process keeps between its tasks: a validator, or why there is none."""

    validator: Validator | None
    resources: ExitStack
    error: PragError | None = None


_worker: list[_Worker] = []


def _end_with(lifeline: Connection) -> None:
    """End this process when the other end of a pipe is closed: by its parent, or because that has been killed."""
    wait([lifeline])
    os._exit(1)


def _start_worker(scene: Scene, lifeline: Connection) -> None:
    """Prepare a spawned process: no output, an end when its parent ends, one validator.

    An error is kept for the first chunk to raise: raised here it would only break the pool.
    """
    threading.Thread(target=_end_with, args=(lifeline,), daemon=True).start()
    silence(STDOUT)
    resources = ExitStack()
    try:
        _worker.append(_Worker(resources.enter_context(open_validator(scene)), resources))
    except PragError as error:
        _worker.append(_Worker(None, resources, error))
    except Exception as error:
        what = f"{type(error).__name__}: {error}"
        _worker.append(_Worker(None, resources, SceneError(f"the scene cannot be built: {what}")))


def _validate_chunk(chunk: Chunk, seed: int, budget: Budget) -> list[Verdict]:
    """Return the verdicts on some tasks, in a spawned process.

    Raises:
        SceneError: the scene of this process could not be built.
    """
    validator, error = _worker[0].validator, _worker[0].error
    if validator is None:
        raise error or SceneError("the scene cannot be built")
    return [validator.validate(task, seed=seed, index=index, budget=budget) for index, task in chunk]
