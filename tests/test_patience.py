"""A test that never ends fails with where it was and what else was running; the tests after it go on."""

from __future__ import annotations

from pathlib import Path

from tests.test_chance import CONFTEST, run

IMPATIENT = "from tests import conftest, patience\nconftest.LONGEST = 0.5\npatience.DEAF = 0.5\n"


def test_a_test_that_waits_for_ever_fails_and_says_what_it_waited_for(tmp_path: Path) -> None:
    text = """
import subprocess
def test_endless():
    try:
        subprocess.run(["sleep", "1234"])
    finally:
        print("tidied")
def test_next():
    pass
"""
    done = run(tmp_path, text, conftest=CONFTEST + IMPATIENT)
    assert done.returncode == 1 and "1 failed, 1 passed" in done.stdout, done.stdout
    assert "it has taken 0.5 s, and goes on" in done.stdout and "'sleep 1234 '" in done.stdout
    assert "tidied" in done.stdout and 'subprocess.run(["sleep", "1234"])' in done.stdout


def test_one_that_hears_nothing_is_ended_with_its_process_and_told_by_its_line(tmp_path: Path) -> None:
    text = """
import ctypes
def test_deaf():
    lock = ctypes.create_string_buffer(256)  # a mutex that is free
    for _ in range(2): ctypes.PyDLL(None).pthread_mutex_lock(lock)
"""
    done = run(tmp_path, text, conftest=CONFTEST + IMPATIENT)
    assert done.returncode == 1 and 'test_it.py", line 5 in test_deaf' in done.stderr, done.stderr


def test_one_that_fails_while_the_machine_is_suspended_is_run_again(tmp_path: Path) -> None:
    text = """
from time import monotonic
from tests import patience
runs = []
def test_of_time():
    runs.append(1)
    if len(runs) == 1:
        patience.monotonic = lambda: monotonic() + 1800
        assert False
def test_wrong():
    runs.append(2)
    assert False
def test_after():
    assert runs == [1, 1, 2]
"""
    done = run(tmp_path, text)
    assert "1 failed, 2 passed" in done.stdout, done.stdout
    assert "FAILED test_it.py::test_wrong" in done.stdout
