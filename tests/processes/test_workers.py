"""Workers print nothing and end with the process that started them, however and whenever either ends."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from threading import Event, Thread

import pytest

from prag_asp.processes import workers
from prag_asp.processes.workers import RemoteTraceback, Worker, WorkerEnded, WorkerGroup, ready_workers, uninterrupted
from tests.processes import children, gone, interruptible

MODULE = "tests.answers"
ROOT = Path(__file__).parents[2]


def test_a_worker_answers_messages_in_order(started: Callable[[], list[int]]) -> None:
    with WorkerGroup(MODULE) as group:
        worker = group.start()
        for number in range(5):
            worker.send(("echo", number))
        assert [worker.receive(30) for _ in range(5)] == [0, 1, 2, 3, 4]
    assert not started()


def test_the_workers_with_answers_are_found_among_many() -> None:
    with WorkerGroup(MODULE) as group:
        slow, quick = group.start(), group.start()
        slow.send(("sleep", 60))
        quick.send(("echo", "here"))
        assert ready_workers([slow, quick], 30) == [quick]
        assert quick.receive() == "here"
        assert ready_workers([slow, quick], 0) == []


def test_large_messages_are_sent_before_a_worker_listens_or_while_it_is_busy() -> None:
    with WorkerGroup(MODULE) as group:
        worker = group.start()
        for _ in range(3):
            worker.send(("sleep", 0.1))
            worker.send(("length", bytes(10**7)))
        assert [worker.receive(30) for _ in range(6)] == ["slept", 10**7] * 3


def test_a_worker_reads_no_stdin_and_writes_no_stdout(
    capfd: pytest.CaptureFixture[str],
) -> None:
    with WorkerGroup(MODULE) as group:
        worker = group.start()
        worker.send(("streams",))
        assert worker.receive(30) == ""
    assert capfd.readouterr() == ("", "")


def test_an_error_of_a_worker_is_raised_with_its_traceback() -> None:
    with WorkerGroup(MODULE) as group:
        worker = group.start()
        worker.send(("what",))
        with pytest.raises(ValueError, match="no answer to what") as caught:
            worker.receive(30)
    assert isinstance(caught.value.__cause__, RemoteTraceback)
    assert "answers.py" in str(caught.value.__cause__)


@pytest.mark.parametrize(
    ("module", "wish", "reported"),
    [(MODULE, "stubborn", "Stubborn: it cannot travel"), ("tests.nowhere", "echo", "No module named 'tests.nowhere'")],
)
def test_an_error_that_cannot_be_pickled_or_comes_before_the_work_is_raised_too(
    module: str, wish: str, reported: str, capfd: pytest.CaptureFixture[str]
) -> None:
    with WorkerGroup(module) as group:
        worker = group.start()
        worker.send((wish, None))
        with pytest.raises((RuntimeError, ModuleNotFoundError), match=reported):
            worker.receive(30)
    assert capfd.readouterr() == ("", "")


@pytest.mark.parametrize(
    ("wish", "how"),
    [
        (("exit", 3), "with code 3"),
        (("die", signal.SIGKILL), "by SIGKILL"),
        (("die", signal.SIGSEGV), "by SIGSEGV"),
        (("die", signal.SIGRTMIN + 3), f"by signal {signal.SIGRTMIN + 3}"),
    ],
)
def test_a_worker_that_ends_before_it_answers_raises_how_it_ended(wish: tuple[object, ...], how: str) -> None:
    with WorkerGroup(MODULE) as group:
        worker = group.start()
        worker.send(wish)
        with pytest.raises(WorkerEnded, match=f"^{how}$"):
            worker.receive(30)
        with pytest.raises(WorkerEnded, match=f"^{how}$"):
            worker.send(("echo", 1))


def test_waiting_for_an_answer_has_a_time_limit(started: Callable[[], list[int]]) -> None:
    with WorkerGroup(MODULE) as group:
        worker = group.start()
        worker.send(("sleep", 600))
        begun = time.monotonic()
        with pytest.raises(TimeoutError):
            worker.receive(0.2)
    assert time.monotonic() - begun < 60
    assert not started()


def test_an_error_in_the_block_ends_busy_workers(started: Callable[[], list[int]]) -> None:
    with pytest.raises(RuntimeError, match="enough"), WorkerGroup(MODULE) as group:
        for _ in range(3):
            group.start().send(("sleep", 60))
        raise RuntimeError("enough")
    assert not started()


@pytest.mark.parametrize("delay", [0, 0.01, 0.04, 0.16])
def test_a_worker_ignores_ctrl_c_even_while_python_starts(delay: float, capfd: pytest.CaptureFixture[str]) -> None:
    with WorkerGroup(MODULE) as group:
        worker = group.start()
        time.sleep(delay)
        for _ in range(20):
            worker.process.send_signal(signal.SIGINT)
            time.sleep(0.005)
        worker.send(("echo", "unmoved"))
        assert worker.receive(30) == "unmoved"
    assert capfd.readouterr() == ("", "")


def test_an_interrupt_while_a_worker_is_started_is_deferred_and_ends_it(
    monkeypatch: pytest.MonkeyPatch, started: Callable[[], list[int]]
) -> None:
    begun: list[Worker] = []
    start = subprocess.Popen

    def interrupted(*arguments, **options):  # type: ignore[no-untyped-def]
        process = start(*arguments, **options)
        signal.raise_signal(signal.SIGINT)
        begun.append(process)
        return process

    monkeypatch.setattr(workers.subprocess, "Popen", interrupted)
    with pytest.raises(KeyboardInterrupt), WorkerGroup(MODULE) as group:
        group.start()
    assert len(begun) == 1 and not started()


def test_deferred_signals_are_handled_afterwards_and_the_handlers_are_restored() -> None:
    heard: list[str] = []
    before = signal.signal(signal.SIGTERM, lambda number, frame: heard.append("terminated"))
    ending = Event()
    other = Thread(target=ending.wait)  # which may take signals that the main one blocks
    other.start()
    try:
        usual = [signal.getsignal(number) for number in (signal.SIGINT, signal.SIGTERM)]
        with pytest.raises(KeyboardInterrupt):
            with uninterrupted():
                with uninterrupted():
                    os.kill(os.getpid(), signal.SIGTERM)
                    os.kill(os.getpid(), signal.SIGINT)
                    time.sleep(0.05)  # in which another thread takes what this one does not
                    heard.append("inner")
                heard.append("outer")
            heard.append("too late")
        assert heard in (["inner", "outer", "terminated"], ["inner", "outer"])
        assert [signal.getsignal(number) for number in (signal.SIGINT, signal.SIGTERM)] == usual
    finally:
        signal.signal(signal.SIGTERM, before)
        ending.set()
        other.join()


PARENT = f"""
import signal, sys
signal.signal(signal.SIGHUP, signal.SIG_DFL)  # which nohup would have it ignore
sys.path.insert(0, {str(ROOT)!r})
from prag_asp.processes.workers import WorkerGroup
with WorkerGroup("tests.answers") as group:
    children = [group.start(), group.start()]
    for worker in children:
        worker.send(("echo", "ready"))
        worker.send(("sleep", 60))
    sys.stdout.write("started")
    sys.stdout.flush()
    for worker in children:
        worker.receive()
    children[0].receive()
"""


@pytest.mark.parametrize("delay", [0, 0.02, 0.08, 0.4])
@pytest.mark.parametrize("number", [signal.SIGKILL, signal.SIGTERM, signal.SIGINT, signal.SIGHUP])
def test_workers_of_a_process_that_ends_at_any_moment_end_and_print_nothing(
    number: int, delay: float, tmp_path: Path
) -> None:
    with interruptible([sys.executable, "-c", PARENT], tmp_path) as parent:
        assert parent.stdout is not None
        assert parent.stdout.read(7) == "started"
        time.sleep(delay)
        born = children(parent.pid)
        parent.send_signal(number)
        said = parent.communicate(timeout=300)[1]
        assert len(born) == 2
        assert gone(born)
    reported = said.strip().splitlines()
    assert parent.returncode == -number
    assert reported[-1:] == (["KeyboardInterrupt"] if number == signal.SIGINT else [])
    assert said.count("Traceback") == (number == signal.SIGINT)
