"""Some of the allocations that ``python -m tests.output.refusals`` refuses all of."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

from tests.chance import Chance

EACH = 25
"""Allocations of each command, spread over all that it has."""


@pytest.mark.slow
def test_whichever_allocation_is_refused_no_file_is_cut_and_it_is_told_in_one_line(chance: Chance) -> None:
    pytest.importorskip("_testcapi", reason="this Python cannot refuse memory on demand")
    count, seed = str(chance.examples(EACH)), str(chance.seed(1))
    done = subprocess.run(
        [sys.executable, "-m", "tests.output.refusals", "--count", count, "--seed", seed],
        cwd=Path(__file__).parents[2], capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert done.returncode == 0, done.stdout + done.stderr
    assert done.stdout.count(f"{count} allocations: ") == 7
