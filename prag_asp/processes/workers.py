"""Python processes of our own: whatever befalls them or the one that started them, they say nothing and end with it.

`multiprocessing` cannot promise that: a process that is just being started tells of arguments that never came where
its parent has ended, and a tracker that it runs beside tells of semaphores. Here nothing that a child does before it
listens depends on its parent; it hears no Ctrl-C, which is for its parent to answer; and a line that is cut ends it at
once. Where its parent is gone, the kernel ends it, even while foreign code keeps it from hearing anything.

A child runs `answers(messages)` of a module: an iterator over what is sent to it makes one over what it answers.
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


class Ended(Exception):
    """A child has ended before it answered: the message says how."""


class There(Exception):
    """Where an error was raised in a child, as Python tells it."""


@dataclass(frozen=True, eq=False)
class Child:
    """A process, and the line to it; what is sent waits there, not here, until the child comes to it."""

    process: subprocess.Popen[bytes]
    line: Connection
    held: int
    """The end of its lifeline that we hold as long as we live."""

    def send(self, message: object) -> None:
        """Send it something that can be pickled.

        Raises:
            Ended: it is gone.
        """
        content = pickle.dumps(message)
        try:
            self.line.send_bytes(content)
        except OSError:
            raise Ended(self._how()) from None

    def receive(self, seconds: float | None = None) -> Any:
        """Return its next answer.

        Raises:
            TimeoutError: there was none within the seconds.
            Ended: it is gone.
            Exception: it met this error.
        """
        try:
            if not self.line.poll(seconds):
                raise TimeoutError
            content = self.line.recv_bytes()
        except TimeoutError:
            raise
        except (EOFError, OSError):
            raise Ended(self._how()) from None
        answer, error, place = pickle.loads(content)
        if error is not None:
            raise error from There(place)
        return answer

    def _how(self) -> str:
        """Return how a child has ended that has closed its line."""
        try:
            code = self.process.wait(timeout=10)
        except subprocess.TimeoutExpired:
            return "its line was cut"
        try:
            return f"by {signal.Signals(-code).name}" if code < 0 else f"with code {code}"
        except ValueError:
            return f"by signal {-code}"


class Children:
    """Processes that run a module, and that end with the block, whatever ends that."""

    def __init__(self, module: str, complaints: int | None = None):
        """Start none yet; `complaints` is the file descriptor that they have as standard error, by default ours."""
        self._module, self._complaints = module, complaints
        self._all: list[Child] = []

    def __enter__(self) -> Children:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        with uninterrupted():
            for child in [*self._all]:
                self.end(child)

    def start(self) -> Child:
        """Start one more. It takes nothing from stdin and leaves nothing on stdout.

        Raises:
            Ended: the system has no room for it.
        """
        with uninterrupted(), _unheard():
            ours, theirs = Pipe()
            hanging, held = held_line()
            with theirs:
                # The path is handed over, and the folder that the user stands in, which Python would add, left out.
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
                        stderr=self._complaints,
                        pass_fds=[theirs.fileno(), hanging],
                    )
                except OSError as error:
                    os.close(held)
                    raise Ended(f"before it began: {error.strerror}") from None
                finally:
                    os.close(hanging)
            child = Child(process, ours, held)
            self._all.append(child)
        return child

    def end(self, child: Child) -> None:
        """End one in the middle of what it does, and wait until it is gone."""
        with uninterrupted():
            child.process.kill()
            child.process.wait()
            child.line.close()
            os.close(child.held)
            self._all.remove(child)


@contextmanager
def uninterrupted() -> Iterator[None]:
    """Put off what SIGINT, SIGTERM and SIGALRM do until the block has ended.

    Blocking them would not do: another thread may take them, one of NumPy's for instance, and the main one answers.
    """
    if current_thread() is not main_thread():
        yield
        return
    came: list[int] = []

    def put_off(number: int, frame: FrameType | None) -> None:
        came.append(number)

    usual = {each: signal.getsignal(each) for each in (signal.SIGTERM, signal.SIGINT, signal.SIGALRM)}
    known = {each: handler for each, handler in usual.items() if callable(handler)}
    try:
        for each in known:
            signal.signal(each, put_off)
        yield
    finally:
        for each, handler in known.items():
            signal.signal(each, handler)
        for number in came:
            signal.raise_signal(number)


@contextmanager
def _unheard() -> Iterator[None]:
    """Have what is started here never hear of SIGINT, from its first instruction on: what is blocked is inherited."""
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def answered(children: Collection[Child], seconds: float | None = None) -> list[Child]:
    """Return those from which there is something to receive, be it their end; wait until there is one, or so long."""
    ready = wait([child.line for child in children], seconds)
    return [child for child in children if child.line in ready]


def serve(descriptor: int, lifeline: int, module: str) -> None:
    """Be a child: answer what comes, tell of an error and end, and end at once when a line is cut."""
    hang_on(lifeline)
    line = Connection(descriptor)
    os.set_inheritable(descriptor, False)
    messages: SimpleQueue[bytes] = SimpleQueue()
    Thread(target=_listen, args=(line, messages), daemon=True).start()
    try:
        for answer in import_module(module).answers(_unpacked(messages)):
            _say(line, pickle.dumps((answer, None, "")))
    except Exception as error:
        _say(line, _told(error, traceback.format_exc()))


def _listen(line: Connection, messages: SimpleQueue[bytes]) -> None:
    """Take messages off the line as they come, and end the process when there can be no more."""
    try:
        while True:
            messages.put(line.recv_bytes())
    finally:
        os._exit(1)


def _unpacked(messages: SimpleQueue[bytes]) -> Iterator[Any]:
    """Yield messages without an end."""
    while True:
        yield pickle.loads(messages.get())


def _say(line: Connection, content: bytes) -> None:
    """Send to the parent; where it is gone, so is the reason to be."""
    try:
        line.send_bytes(content)
    except OSError:
        os._exit(1)


def _told(error: Exception, place: str) -> bytes:
    """Return an error as it travels; one that cannot travel becomes one that has its words."""
    try:
        content = pickle.dumps((None, error, place))
        pickle.loads(content)
    except Exception:
        return pickle.dumps((None, RuntimeError(f"{type(error).__name__}: {error}"), place))
    return content
