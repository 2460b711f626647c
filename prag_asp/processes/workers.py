"""Worker processes that print nothing, and that end when the process that started them ends, for whatever reason.

`multiprocessing` cannot guarantee that: if its parent is killed, a process that is being spawned prints a traceback
about arguments that never arrived, and its resource tracker warns about semaphores. A worker from this module does not
depend on its parent until it listens. It ignores Ctrl-C, which its parent handles. It ends when its connection is
closed, and the kernel kills it when its parent is gone, even while native code runs in it.

A worker runs the function ``answers(messages)`` of a module, which takes an iterator over the messages sent to the
worker and returns an iterator over the worker's answers.
"""

from __future__ import annotations

import os
import pickle
import signal
import subprocess
import sys
import traceback
from collections.abc import Collection, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from importlib import import_module
from multiprocessing.connection import Connection, Pipe, wait
from queue import SimpleQueue
from threading import Thread, current_thread, main_thread
from types import FrameType, TracebackType
from typing import Any

from prag_asp.processes.lifeline import hang_on, held_line
from prag_asp.processes.machine import signal_name


class WorkerEnded(Exception):
    """A worker ended before it answered; the message states how it ended."""


class RemoteTraceback(Exception):
    """The traceback of an error in a worker; it becomes the `__cause__` of the error that the parent raises."""


@dataclass(frozen=True, eq=False)
class Worker:
    """A process and the connection to it; messages wait in this process until the worker reads them."""

    process: subprocess.Popen[bytes]
    connection: Connection
    lifeline: int
    """The file descriptor that keeps the worker alive while it is open in this process."""

    def send(self, message: object) -> None:
        """Send the worker a message, which is pickled.

        Raises:
            WorkerEnded: the worker has ended.
        """
        content = pickle.dumps(message)
        try:
            self.connection.send_bytes(content)
        except OSError:
            raise WorkerEnded(self._exit()) from None

    def receive(self, seconds: float | None = None) -> Any:
        """Return the worker's next answer.

        Raises:
            TimeoutError: no answer came within `seconds`.
            WorkerEnded: the worker has ended.
            Exception: the worker's function raised it.
        """
        try:
            if not self.connection.poll(seconds):
                raise TimeoutError
            content = self.connection.recv_bytes()
        except TimeoutError:
            raise
        except (EOFError, OSError):
            raise WorkerEnded(self._exit()) from None
        answer, error, place = pickle.loads(content)
        if error is not None:
            raise error from RemoteTraceback(place)
        return answer

    def _exit(self) -> str:
        """Return how the worker ended, once its connection is closed."""
        try:
            code = self.process.wait(timeout=10)
        except subprocess.TimeoutExpired:
            return "by closing its connection"
        return f"by {signal_name(-code)}" if code < 0 else f"with code {code}"


class WorkerGroup:
    """Workers that run a module, as a context manager: they end with the block, however it ends."""

    def __init__(self, module: str, stderr: int | None = None):
        """Start no worker yet; `stderr` is the file descriptor for their stderr, by default that of this process."""
        self._module, self._stderr = module, stderr
        self._workers: list[Worker] = []

    def __enter__(self) -> WorkerGroup:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        with uninterrupted():
            for worker in [*self._workers]:
                self.end(worker)

    def start(self) -> Worker:
        """Start a worker, with empty stdin and with stdout discarded.

        Raises:
            WorkerEnded: the system cannot start it.
        """
        with uninterrupted(), _sigint_blocked():
            ours, theirs = Pipe()
            hanging, lifeline = held_line()
            with theirs:
                # sys.path is passed on, so that the current folder, which Python would add, is not on it.
                code = (
                    f"import sys; sys.path[:] = {[*map(str, sys.path)]!r}; "
                    "from prag_asp.processes.workers import serve; "
                    f"serve({theirs.fileno()}, {hanging}, {self._module!r})"
                )
                try:
                    process = subprocess.Popen(
                        [sys.executable, "-c", code],
                        stdin=subprocess.DEVNULL,
                        stdout=subprocess.DEVNULL,
                        stderr=self._stderr,
                        pass_fds=[theirs.fileno(), hanging],
                    )
                except OSError as error:
                    os.close(lifeline)
                    raise WorkerEnded(f"before it began: {error.strerror}") from None
                finally:
                    os.close(hanging)
            worker = Worker(process, ours, lifeline)
            self._workers.append(worker)
        return worker

    def end(self, worker: Worker) -> None:
        """Kill a worker, whatever it is doing, and wait until it is gone."""
        with uninterrupted():
            worker.process.kill()
            worker.process.wait()
            worker.connection.close()
            os.close(worker.lifeline)
            self._workers.remove(worker)


def ready_workers(workers: Collection[Worker], seconds: float | None = None) -> list[Worker]:
    """Return the workers that have answered or ended; wait up to `seconds` for the first one (None: without limit)."""
    ready = wait([worker.connection for worker in workers], seconds)
    return [worker for worker in workers if worker.connection in ready]


@contextmanager
def uninterrupted() -> Iterator[None]:
    """Defer the handlers of SIGINT, SIGTERM and SIGALRM until the end of the block.

    Blocking the signals is not enough: another thread, such as one of NumPy's, may receive them, and Python then runs
    the handlers in the main thread all the same.
    """
    if current_thread() is not main_thread():
        yield
        return
    received: list[int] = []

    def defer(number: int, frame: FrameType | None) -> None:
        received.append(number)

    handlers = {each: signal.getsignal(each) for each in (signal.SIGTERM, signal.SIGINT, signal.SIGALRM)}
    known = {each: handler for each, handler in handlers.items() if callable(handler)}
    try:
        for each in known:
            signal.signal(each, defer)
        yield
    finally:
        for each, handler in known.items():
            signal.signal(each, handler)
        for number in received:
            signal.raise_signal(number)


@contextmanager
def _sigint_blocked() -> Iterator[None]:
    """Block SIGINT, so that a process started here inherits the block and ignores Ctrl-C from its first instruction."""
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def serve(descriptor: int, lifeline: int, module: str) -> None:
    """Run a worker: answer messages until an error, which is sent to the parent; exit when the connection is closed.

    An error that cannot be pickled becomes a `RuntimeError` with its text.
    """
    hang_on(lifeline)
    connection = Connection(descriptor)
    os.set_inheritable(descriptor, False)
    messages: SimpleQueue[bytes] = SimpleQueue()
    Thread(target=_listen, args=(connection, messages), daemon=True).start()
    try:
        for answer in import_module(module).answers(pickle.loads(each) for each in iter(messages.get, None)):
            _send(connection, pickle.dumps((answer, None, "")))
    except Exception as error:
        place = traceback.format_exc()
        try:
            content = pickle.dumps((None, error, place))
            pickle.loads(content)
        except Exception:  # not every error can be pickled, or unpickled again
            content = pickle.dumps((None, RuntimeError(f"{type(error).__name__}: {error}"), place))
        _send(connection, content)


def _listen(connection: Connection, messages: SimpleQueue[bytes]) -> None:
    """Queue messages as they arrive, and exit the process when the connection is closed."""
    try:
        while True:
            messages.put(connection.recv_bytes())
    finally:
        os._exit(1)


def _send(connection: Connection, content: bytes) -> None:
    """Send to the parent; exit if it is gone."""
    try:
        connection.send_bytes(content)
    except OSError:
        os._exit(1)
