"""A process that cannot be started, whichever it is: one line or no harm, and no file that is cut."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

from prag_asp.cli.exits import Exit
from tests.commands import ok

REFUSED = """
import _posixsubprocess, os, subprocess, sys
from prag_asp.cli import main

number, started = int(sys.argv[1]), [0]
sys.argv = ["prag-asp", *sys.argv[2:]]

def refusing(start):
    def attempt(*arguments):
        started[0] += 1
        if started[0] == number:
            raise BlockingIOError(11, "Resource temporarily unavailable")
        return start(*arguments)
    return attempt

os.fork = refusing(os.fork)
subprocess._fork_exec = refusing(_posixsubprocess.fork_exec)
main()
"""
"""The command, for which one process cannot be started, and no other."""

MOST = 4
"""More processes than the commands below start."""


def refused(number: int, arguments: tuple[str, ...], folder: Path) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-c", REFUSED, str(number), *arguments]
    return subprocess.run(command, cwd=folder, capture_output=True, text=True, timeout=120, check=False)


@pytest.mark.parametrize("number", range(1, MOST + 1))
def test_a_worker_that_cannot_be_started_is_one_line_and_cuts_no_file(number: int, tmp_path: Path) -> None:
    arguments = ("sample", "tabletop", "--length", "1", "--count", "2", "--seed", "1", "--workers", "2")
    done = refused(number, (*arguments, "-o", "tasks.txt"), tmp_path)
    if done.returncode == 0:
        assert (tmp_path / "tasks.txt").read_text() == ok(*arguments)
    else:
        assert (done.returncode, done.stderr.count("\n")) == (Exit.WORKERS, 1)
        assert done.stderr.startswith("a worker ended before it began: Resource temporarily unavailable")
        assert not (tmp_path / "tasks.txt").exists()


def test_without_a_process_to_watch_over_it_a_command_works_all_the_same(tmp_path: Path) -> None:
    done = refused(1, ("count", "prag", "--length", "3"), tmp_path)
    assert (done.returncode, done.stdout, done.stderr) == (0, "2092\n", "")
