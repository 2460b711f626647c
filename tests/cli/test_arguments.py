"""Actions as words of a command line, and the versions it tells."""

from __future__ import annotations

import subprocess
import sys
from importlib.metadata import PackageNotFoundError, version

import pytest

from prag_asp import versions
from tests.cli.conftest import Told


def test_explain_reads_what_task_reads(told: Told) -> None:
    actions = ("approach(panda, can_1)", "grasp(panda,can_1)", "drop(panda,can_1)")
    spelled = [" ".join(actions), ", ".join(actions), ",".join(actions), "  ".join(actions), "\n".join(actions)]
    for text in spelled:
        assert told("task", "prag", "-n", "3", "--rank-of", text) == "25\n"
        assert told("explain", "prag", text) == told("explain", "prag", *actions) == "a plan of prag\n"
        assert told("count", "prag", "-n", "5", "--prefix", text) == told(
            "count", "prag", "-n", "5", "--prefix", spelled[0]
        )
    assert told("explain", "prag", *actions[:1], " ".join(actions[1:])) == "a plan of prag\n"
    for command in (("explain", "prag"), ("task", "prag", "-n", "3", "--rank-of")):
        assert "is not a list of terms" in told(*command, "grasp(panda,can_1),,drop", code=2)
    assert "is not an action" in told("explain", "prag", "  ", code=2)
    assert told("explain", "prag") == "a plan of prag\n"
    assert told("task", "prag", "-n", "0", "--rank-of", "") == "0\n"


def test_versions_are_told_without_loading_what_they_are_of(told: Told, monkeypatch: pytest.MonkeyPatch) -> None:
    line = told("--version")
    assert line.startswith(f"prag_asp {version('prag_asp')}, clingo {version('clingo')}, ")
    code = "import sys; from prag_asp.cli import cli; cli.main(['--version']); print('clingo' in sys.modules)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout == f"{line}False\n"

    def missing(name: str) -> str:
        if name == "clingo":
            return "5.9"
        raise PackageNotFoundError(name)

    monkeypatch.setattr(versions, "version", missing)
    assert told("--version") == "prag_asp 0+unknown, clingo 5.9, no PyBullet\n"
