"""Memory that the system refuses, at any moment: one line, a code of its own, and no file that is cut."""

from __future__ import annotations

import resource
import subprocess
import sys
from pathlib import Path

import pytest

from prag_asp.cli.exits import Exit
from tests.chance import Chance
from tests.commands import ok

testcapi = pytest.importorskip("_testcapi", reason="this Python cannot refuse memory on demand")

MOMENTS, LATEST = 16, 300_000
"""How many moments are tried, and the last of them in allocations, after which the commands below are done."""

UNTOLD = 0.1
"""The share of moments at which Python or native code takes the failure for something else, and says so."""

REFUSED = """
import _testcapi, sys
import prag_asp.space.task_space, prag_asp.space.sampling, prag_asp.cli.supervision, prag_asp.cli.domain_options
from prag_asp.cli import main

allocation, sys.argv = int(sys.argv[1]), ["prag-asp", *sys.argv[2:]]
_testcapi.set_nomemory(allocation, allocation + 1)
main()
"""
"""The command, to which one allocation is refused, and no other."""


@pytest.mark.slow
def test_an_allocation_that_fails_cuts_no_file_and_is_told_in_one_line(tmp_path: Path, chance: Chance) -> None:
    arguments = ("sample", "prag", "--length", "3", "--no-physics", "--count", "5", "--seed", "1", "--no-cache")
    right = ok(*arguments)
    odd = []
    for moment in range(MOMENTS):
        allocation = chance.generator(moment).randrange(LATEST * moment // MOMENTS, LATEST * (moment + 1) // MOMENTS)
        file = tmp_path / f"{moment}.txt"
        done = subprocess.run(
            [sys.executable, "-c", REFUSED, str(allocation), *arguments, "-o", file.name],
            cwd=tmp_path, capture_output=True, text=True, timeout=120, check=False,
        )  # fmt: skip
        if done.returncode == 0:
            assert file.read_text() == right and not done.stderr
        else:
            assert not file.exists()
            if done.returncode != Exit.LIMIT or done.stderr.count("\n") != 1:
                odd.append(f"allocation {allocation}: {done.returncode}, {done.stderr}")
    assert len(odd) <= MOMENTS * UNTOLD, "\n".join(odd)


@pytest.mark.parametrize("megabytes", [20, 60, 150])
def test_too_few_addresses_for_the_libraries_are_told_before_they_fail(megabytes: int) -> None:
    def allow() -> None:
        resource.setrlimit(resource.RLIMIT_AS, (megabytes << 20,) * 2)

    done = subprocess.run(
        [sys.executable, "-m", "prag_asp", "count", "prag", "--length", "3"],
        preexec_fn=allow, capture_output=True, text=True, timeout=300, check=False,
    )  # fmt: skip
    assert (done.returncode, done.stdout) == (Exit.LIMIT, "")
    assert done.stderr.startswith("the system allows only ") and done.stderr.endswith("allow 200 MB or more\n")
