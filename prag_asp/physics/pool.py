"""Validate many tasks, in order, in one process or in several: the verdicts are the same.

Each task has its own generator of random numbers, seeded from the seed and its index. Workers are not forked,
because PyBullet does not survive that; each keeps one simulator for all its tasks.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Generator, Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from itertools import islice
from typing import Any

from prag_asp.errors import QueryError, WorkerError
from prag_asp.physics.filming.episode_options import Staging
from prag_asp.physics.validator import open_validator
from prag_asp.physics.verdict import Budget, Verdict
from prag_asp.processes.progress_events import stage
from prag_asp.processes.workers import Child, Children, Ended, answered
from prag_asp.scene.scene import Scene
from prag_asp.task import Task

CHUNK = 4
CHUNKS_AHEAD = 3
"""For each worker; of these it has been handed at most `HANDED`: the one it does, and one that it need not wait for."""

HANDED = 2
REPLACEMENTS = 5


Numbered = tuple[int, Task]
"""The index of a task, and the task."""


def validate_tasks(
    tasks: Iterable[Task],
    scene: Scene,
    *,
    seed: int,
    workers: int = 1,
    budget: Budget | None = None,
    staging: Staging | None = None,
) -> Generator[Verdict, None, None]:
    """Yield the verdict on each task, in the order of the tasks, which may be endless; they are numbered from 0.

    `staging` says how they are demonstrated, where the budget asks for that. One worker runs in this process, more in
    processes of their own; the verdicts do not depend on it. Tasks of a worker that was killed are done again by a new
    one. Closing the iterator ends the workers at once.

    Raises:
        QueryError: the number of workers is not positive, or the scene lacks a camera.
        SceneError: the scene cannot be built, or a task speaks about something for which it has no shape.
        WorkerError: workers died more than `REPLACEMENTS` times over the same tasks, or cannot be started.
    """
    return validate_numbered(enumerate(tasks), scene, seed=seed, workers=workers, budget=budget, staging=staging)


def validate_numbered(
    tasks: Iterable[Numbered],
    scene: Scene,
    *,
    seed: int,
    workers: int = 1,
    budget: Budget | None = None,
    staging: Staging | None = None,
) -> Generator[Verdict, None, None]:
    """Yield the verdict on each task with its index, of which alone it depends, not of the order of the tasks.

    Raises:
        PragError: as `validate_tasks` does.
    """
    if workers < 1:
        raise QueryError(f"validation needs at least 1 worker; got {workers}")
    if staging is not None:
        staging.cameras_of(scene)
    settings = {"seed": seed, "budget": budget or Budget(), "staging": staging}
    if workers == 1:
        return _in_process(tasks, scene, settings)
    return pooled(tasks, "prag_asp.physics.worker", (scene, settings), workers)


def _in_process(tasks: Iterable[Numbered], scene: Scene, settings: Mapping[str, Any]) -> Generator[Verdict, None, None]:
    """Yield verdicts found in this process."""
    with open_validator(scene) as validator:
        for index, task in tasks:
            yield validator.validate(task, index=index, **settings)


def pooled(
    numbered: Iterable[tuple[int, Any]], module: str, settings: Any, workers: int, *, chunk: int = CHUNK
) -> Generator[Any, None, None]:
    """Yield what other processes answer, in the order of what is asked, a bounded number of questions ahead.

    Each runs ``answers(messages)`` of a `module`: the first message has the `settings`, each other one some questions,
    each with its number, a `chunk` of them together; it answers with as many values. Those of a worker that was killed
    are asked of a new one.

    Raises:
        WorkerError: workers died more than `REPLACEMENTS` times over the same questions, or cannot be started.
        Exception: a worker met this error.
    """
    waiting: deque[_Chunk] = deque()
    chunks = _chunks(numbered, chunk)
    with Children(module) as children:
        pool = _Pool(children, workers, settings)
        while True:
            waiting.extend(islice(chunks, workers * CHUNKS_AHEAD - len(waiting)))
            if not waiting:
                return
            pool.work(waiting)
            first = waiting[0]
            if first.error is not None:
                raise first.error
            if first.answers is not None:
                waiting.popleft()
                yield from first.answers


@dataclass(eq=False)
class _Chunk:
    """Tasks that go to a worker together, so that fewer messages are sent, and what has become of them."""

    tasks: tuple[tuple[int, Any], ...]
    handed: bool = False
    deaths: int = 0
    answers: list[Any] | None = None
    error: Exception | None = None

    @property
    def awaited(self) -> bool:
        """Tell whether a worker is to do it still."""
        return self.handed and self.answers is None and self.error is None


def _chunks(tasks: Iterable[tuple[int, Any]], size: int) -> Iterator[_Chunk]:
    """Yield the tasks in groups."""
    iterator = iter(tasks)
    while group := tuple(islice(iterator, size)):
        yield _Chunk(group)


class _Pool:
    """Workers, started as they are needed, each with the chunks that it has been handed, in order."""

    def __init__(self, children: Children, workers: int, settings: Any):
        self._children, self._workers, self._settings = children, workers, settings
        self._handed: dict[Child, deque[_Chunk]] = {}

    def work(self, waiting: Sequence[_Chunk]) -> None:
        """Hand out chunks and take in what became of some; wait for that where the first chunk is still being done.

        Raises:
            WorkerError: workers died more than `REPLACEMENTS` times over the same chunk, or cannot be started.
        """
        stage("checking tasks by physics")
        for chunk in waiting:
            if not chunk.handed and (worker := self._free()) is not None:
                self._hand(chunk, worker)
        for worker in answered(self._handed, None if waiting[0].awaited else 0):
            self._take_in(worker)

    def _free(self) -> Child | None:
        """Return the worker with the least to do, a new one rather than a busy one, None where all have enough."""
        idle = [worker for worker, chunks in self._handed.items() if not chunks]
        if idle:
            return idle[0]
        if len(self._handed) < self._workers:
            return self._started()
        least = min(self._handed, key=lambda worker: len(self._handed[worker]))
        return least if len(self._handed[least]) < HANDED else None

    def _started(self) -> Child:
        """Start a worker."""
        try:
            worker = self._children.start()
        except Ended as ended:
            raise WorkerError(f"a worker ended {ended}; is there enough memory? Try fewer workers") from None
        self._handed[worker] = deque()
        with suppress(Ended):  # which it will be at the first chunk, too
            worker.send(self._settings)
        return worker

    def _hand(self, chunk: _Chunk, worker: Child) -> None:
        """Give a worker one more chunk to do."""
        chunk.handed = True
        self._handed[worker].append(chunk)
        try:
            worker.send(chunk.tasks)
        except Ended as ended:
            self._replace(worker, ended)

    def _take_in(self, worker: Child) -> None:
        """Take the answers to the chunk that a worker has done, or the error that has ended it, which is its own."""
        try:
            self._handed[worker][0].answers = worker.receive()
        except Ended as ended:
            self._replace(worker, ended)
        except Exception as error:
            self._handed[worker].popleft().error = error
            self._leave(worker)
        else:
            self._handed[worker].popleft()

    def _replace(self, worker: Child, ended: Ended) -> None:
        """Let others do what a worker was doing when it died.

        Raises:
            WorkerError: too many have died of that.
        """
        left = self._leave(worker)
        if left:
            left[0].deaths += 1
            times, index = left[0].deaths, left[0].tasks[0][0]
            if times > REPLACEMENTS:
                raise WorkerError(
                    f"workers died {times} times in a row around task {index}, the last {ended}; "
                    "is there enough memory? Try fewer workers"
                )

    def _leave(self, worker: Child) -> deque[_Chunk]:
        """Give up a worker, and return the chunks that it leaves for others to do."""
        self._children.end(worker)
        left = self._handed.pop(worker)
        for chunk in left:
            chunk.handed = False
        return left
