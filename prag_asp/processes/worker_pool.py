"""Apply a function to numbered items in several worker processes, and yield the results in the order of the items.

This is a pool of our own because `concurrent.futures.ProcessPoolExecutor` cannot replace a worker: one that is killed
breaks the whole executor, without telling which item it was at. Its processes also hear Ctrl-C, print tracebacks and
warnings of the resource tracker when the parent is killed, and cannot be ended in the middle of a task. See `workers`.
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
"""Items that are sent in one message, so that the cost of messages is small beside that of the items."""

CHUNKS_AHEAD = 3
"""Chunks that are read from the items for each worker: the items may be endless, or expensive to make."""

SENT_AHEAD = 2
"""Chunks that a worker has at most: the one it works on, and the next, so that it need not wait for it."""

REPLACEMENTS = 5
"""Deaths of workers over the same chunk after which the pool gives up: a task may need more memory than there is."""

Item = TypeVar("Item")
Result = TypeVar("Result")

Opener = Callable[[], AbstractContextManager[Callable[[int, Item], Result]]]
"""Opens what a worker needs (such as a simulator), and gives the function of an index and an item that it runs."""


def map_ordered(
    items: Iterable[tuple[int, Item]], opener: Opener[Item, Result], workers: int, *, activity: str, chunk: int = CHUNK
) -> Generator[Result, None, None]:
    """Yield the result for each item with its index, in the order of the items, which may be endless.

    One worker runs in this process, more run in processes of their own; then the `opener` and the items are pickled.
    A killed worker is replaced, and its items are done again. Closing the iterator ends the workers at once. `activity`
    names what is done, for progress.

    Raises:
        WorkerError: workers died more than `REPLACEMENTS` times over the same items, or cannot be started.
        Exception: the opener or the function raised it; the results of the items before come first.
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
    """Run in a worker: the first message is the opener, each further one a chunk; yield the results of each chunk."""
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
    """Workers, started when they are needed, each with the chunks that it was sent, in order."""

    def __init__(self, group: WorkerGroup, workers: int, opener: Opener[Item, Result]):
        self._group, self._workers, self._opener = group, workers, opener
        self._sent: dict[Worker, deque[_Chunk[Item, Result]]] = {}

    def work(self, waiting: Sequence[_Chunk[Item, Result]]) -> None:
        """Send chunks and receive results; wait for some if the first chunk is still being worked on.

        Raises:
            WorkerError: workers died more than `REPLACEMENTS` times over the same chunk, or cannot be started.
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
            except Exception as error:  # it ended the worker, and belongs to the chunk that it worked on
                self._sent[worker].popleft().error = error
                self._release(worker)

    def _free_worker(self) -> Worker | None:
        """Return an idle worker, else a new one, else the one with the fewest chunks; None if all have enough."""
        least = min(self._sent, key=lambda worker: len(self._sent[worker]), default=None)
        if least is not None and (not self._sent[least] or len(self._sent) == self._workers):
            return least if len(self._sent[least]) < SENT_AHEAD else None
        try:
            worker = self._group.start()
        except WorkerEnded as ended:
            raise WorkerError(f"a worker ended {ended}; is there enough memory? Try fewer workers") from None
        self._sent[worker] = deque()
        with suppress(WorkerEnded):  # sending the first chunk fails with it, too
            worker.send(self._opener)
        return worker

    def _replace(self, worker: Worker, ended: WorkerEnded) -> None:
        """Let other workers do the chunks of one that died.

        Raises:
            WorkerError: too many have died of the same chunk.
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
