"""A pool of worker processes that apply a function to numbered items, with the results in the order of the items.

`concurrent.futures.ProcessPoolExecutor` does not suffice, because it cannot replace a worker: a killed worker breaks
the whole executor, which does not report the item at fault. Moreover, its processes receive Ctrl-C, print tracebacks
and resource tracker warnings when the parent is killed, and cannot be ended in the middle of a task. See `workers`.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Generator, Iterable, Iterator, Sequence
from contextlib import AbstractContextManager, suppress
from dataclasses import dataclass
from itertools import islice
from typing import Any, Generic, TypeVar

from prag_asp.errors import WorkerError
from prag_asp.processes.progress_events import stage
from prag_asp.processes.workers import Worker, WorkerEnded, WorkerGroup, ready_workers

CHUNK = 4
"""The number of items that are sent in one message, so that messages cost little compared with the work on the items.
"""

CHUNKS_AHEAD = 3
"""The number of chunks that are read ahead for each worker; the items may be endless or expensive to generate."""

SENT_AHEAD = 2
"""The maximum number of chunks that a worker has: the current one and the next, so that the worker need not wait."""

REPLACEMENTS = 5
"""The number of workers that may die on the same chunk before the pool gives up, because an item may need more memory
than there is."""

Item = TypeVar("Item")
Result = TypeVar("Result")

Opener = Callable[[], AbstractContextManager[Callable[[int, Item], Result]]]
"""A function that opens the resources of a worker (such as a simulator); its context manager yields the function that
the worker applies to each index and item."""


def map_ordered(
    items: Iterable[tuple[int, Item]], opener: Opener[Item, Result], workers: int, *, activity: str, chunk: int = CHUNK
) -> Generator[Result, None, None]:
    """Yield the result for each item with its index, in the order of the items, which may be endless.

    A single worker runs in this process; several workers run in separate processes, for which the `opener` and the
    items are pickled. If a worker is killed, it is replaced, and its items are processed again. Closing the iterator
    ends the workers at once. `activity` is the text of the progress events.

    Raises:
        WorkerError: workers died more than `REPLACEMENTS` times on the same items, or cannot be started.
        Exception: the opener or the function raised it; the results of earlier items come first.
    """
    if workers == 1:
        with opener() as function:
            for index, item in items:
                yield function(index, item)
        return
    waiting: deque[_Chunk[Item, Result]] = deque()
    iterator = iter(items)
    chunks: Iterator[_Chunk[Item, Result]] = map(_Chunk, iter(lambda: tuple(islice(iterator, chunk)), ()))
    with WorkerGroup(__name__) as group:
        pool = _Pool(group, workers, opener)
        while True:
            waiting.extend(islice(chunks, workers * CHUNKS_AHEAD - len(waiting)))
            if not waiting:
                return
            stage(activity)
            pool.work(waiting)
            first = waiting[0]
            if first.error is not None:
                raise first.error
            if first.results is not None:
                waiting.popleft()
                yield from first.results


def answers(messages: Iterator[Any]) -> Iterator[list[Any]]:
    """Yield the results of each chunk, in a worker; the first message is the opener, each further one is a chunk."""
    opener = next(messages)
    with opener() as function:
        for items in messages:
            yield [function(index, item) for index, item in items]


@dataclass(eq=False)
class _Chunk(Generic[Item, Result]):
    """Items that are sent to a worker together, and their results or the error that one of them raised."""

    items: tuple[tuple[int, Item], ...]
    sent: bool = False
    deaths: int = 0
    results: list[Result] | None = None
    error: Exception | None = None


class _Pool(Generic[Item, Result]):
    """Workers, started when they are needed, each with the chunks that were sent to it, in order."""

    def __init__(self, group: WorkerGroup, workers: int, opener: Opener[Item, Result]):
        self._group, self._workers, self._opener = group, workers, opener
        self._sent: dict[Worker, deque[_Chunk[Item, Result]]] = {}

    def work(self, waiting: Sequence[_Chunk[Item, Result]]) -> None:
        """Send chunks, and receive the results that are ready; wait for results if the first chunk is being processed.

        Raises:
            WorkerError: workers died more than `REPLACEMENTS` times on the same chunk, or cannot be started.
        """
        for chunk in waiting:
            if not chunk.sent and (worker := self._free_worker()) is not None:
                chunk.sent = True
                self._sent[worker].append(chunk)
                try:
                    worker.send(chunk.items)
                except WorkerEnded as ended:
                    self._replace(worker, ended)
        first = waiting[0]
        pending = first.sent and first.results is None and first.error is None
        for worker in ready_workers(self._sent, None if pending else 0):
            try:
                self._sent[worker][0].results = worker.receive()
                self._sent[worker].popleft()
            except WorkerEnded as ended:
                self._replace(worker, ended)
            except Exception as error:  # this error ended the worker, and belongs to its first chunk
                self._sent[worker].popleft().error = error
                self._release(worker)

    def _free_worker(self) -> Worker | None:
        """Return an idle worker, else a new one, else the one with the fewest chunks, or None if all have enough."""
        least = min(self._sent, key=lambda worker: len(self._sent[worker]), default=None)
        if least is not None and (not self._sent[least] or len(self._sent) == self._workers):
            return least if len(self._sent[least]) < SENT_AHEAD else None
        try:
            worker = self._group.start()
        except WorkerEnded as ended:
            raise WorkerError(f"a worker ended {ended}; is there enough memory? Try fewer workers") from None
        self._sent[worker] = deque()
        with suppress(WorkerEnded):  # sending the first chunk then fails as well
            worker.send(self._opener)
        return worker

    def _replace(self, worker: Worker, ended: WorkerEnded) -> None:
        """Return the chunks of a dead worker to the queue.

        Raises:
            WorkerError: too many workers have died on the same chunk.
        """
        left = self._release(worker)
        if left:
            left[0].deaths += 1
            times, index = left[0].deaths, left[0].items[0][0]
            if times > REPLACEMENTS:
                raise WorkerError(
                    f"workers died {times} times in a row around task {index}, the last {ended}; "
                    "is there enough memory? Try fewer workers"
                )

    def _release(self, worker: Worker) -> deque[_Chunk[Item, Result]]:
        """End a worker, and return its chunks, which are to be sent again."""
        self._group.end(worker)
        left = self._sent.pop(worker)
        for chunk in left:
            chunk.sent = False
        return left
