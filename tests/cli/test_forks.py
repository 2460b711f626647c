"""A process that cannot be started, whichever it is: one line or no harm, and no file that is cut."""

from __future__ import annotations

import shutil
import subprocess
import sys
from collections.abc import Callable, Mapping
from pathlib import Path

import pytest

from prag_asp.cli.exits import Exit
from tests.commands import ok
from tests.output.faults import content

Whole = Callable[[str, Path], tuple[str, Mapping[str, bytes]]]

WORKER = "a worker ended before it began: "
REFUSED = """
import _posixsubprocess, os, subprocess, sys
from prag_asp.cli import main
from prag_asp.dataset.pages import dataset_card

dataset_card.STRIP_SIZE = (60, 52)  # as in the process of the tests

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

TASKS = ("prag", "-n", "1", "--seed", "1", "--budget", "2x2")
COMMANDS: Mapping[str, tuple[tuple[str, ...], int, int, str]] = {
    "sample": (("sample", *TASKS, "--count", "2", "--workers", "2", "-o", "drawn.txt"), 3, Exit.WORKERS, WORKER),
    "generate": (("generate", *TASKS, "--tasks", "2", "--workers", "2", "-o", "data"), 3, Exit.WORKERS, WORKER),
    "validate": (("validate", "tasks.jsonl", "--workers", "2", "-o", "told.txt"), 2, Exit.WORKERS, WORKER),
    "sharp": (("count", "blocks", "-n", "2", "--engine", "sharp"), 2, Exit.BAD_INPUT, "engine sharp: Ganak ended"),
}
"""Commands that start processes, each with how many (the command itself is the first), the code, and what is said."""

STARTS = [(name, number) for name, (_, most, _, _) in COMMANDS.items() for number in range(2, most + 1)]
GROWS = "data/dataset.json"
"""A file that says how far a run is."""


def refused(number: int, arguments: tuple[str, ...], folder: Path) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-c", REFUSED, str(number), *arguments]
    return subprocess.run(command, cwd=folder, capture_output=True, text=True, timeout=120, check=False)


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> Whole:
    """Return what a command prints that nothing is refused, and the files that it leaves."""
    known: dict[str, tuple[str, Mapping[str, bytes]]] = {}
    drawn = tmp_path_factory.mktemp("drawn") / "tasks.jsonl"
    ok("sample", *TASKS, "--count", "2", "--format", "jsonl", "-o", str(drawn))

    def found(name: str, folder: Path) -> tuple[str, Mapping[str, bytes]]:
        shutil.copy(drawn, folder)
        if name not in known:
            own = tmp_path_factory.mktemp("whole")
            shutil.copy(drawn, own)
            known[name] = (ok(*COMMANDS[name][0], cwd=own), content(own))
        return known[name]

    return found


@pytest.mark.parametrize(("name", "number"), STARTS)
def test_a_process_that_cannot_be_started_is_one_line_cuts_no_file_and_a_second_run_ends_well(
    name: str, number: int, tmp_path: Path, whole: Whole
) -> None:
    arguments, _, code, told = COMMANDS[name]
    printed, files = whole(name, tmp_path)
    done = refused(number, arguments, tmp_path)
    assert (done.returncode, done.stdout, done.stderr.count("\n")) == (code, "", 1), done.stderr
    assert done.stderr.startswith(told) and "Resource temporarily unavailable" in done.stderr
    left = {file: text for file, text in content(tmp_path).items() if not file.endswith((".part", ".run"))}
    assert all(text == files[file] for file, text in left.items() if file != GROWS)
    assert ok(*arguments, cwd=tmp_path) == printed and content(tmp_path) == files


@pytest.mark.parametrize("name", ["sample", "sharp"])
def test_no_more_processes_are_started_than_are_refused_here(name: str, tmp_path: Path, whole: Whole) -> None:
    arguments, most, _, _ = COMMANDS[name]
    printed, files = whole(name, tmp_path)
    done = refused(most + 1, arguments, tmp_path)
    assert (done.returncode, done.stdout) == (0, printed) and content(tmp_path) == files


def test_without_a_process_to_watch_over_it_a_command_works_all_the_same(tmp_path: Path) -> None:
    done = refused(1, ("count", "prag", "--length", "3"), tmp_path)
    assert (done.returncode, done.stdout, done.stderr) == (0, "2092\n", "")
