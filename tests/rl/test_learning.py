"""The commands of benchmarks/learning, shortened; those that learn need the extra `learning`."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

from tests.docs.pages import DOCS, ROOT

SHORTENED = {
    "oracle.py": ["--count", "1"],
    "curves.py": ["--steps", "310", "--every", "310", "--training", "2", "--held-out", "1"],
    "chained.py": ["--demonstrations", "2", "--count", "1", "--epochs", "1", "--length", "2"],
}


def told() -> list[list[str]]:
    """The commands of the page, without the Python that runs them."""
    text = (DOCS / "guides" / "learning.md").read_text(encoding="utf-8")
    return [line.split() for line in re.findall(r"^\.venv/bin/python (.*)$", text, re.MULTILINE)]


def done(command: list[str], *more: object) -> str:
    name = Path(command[0]).name
    given = [sys.executable, *command, *SHORTENED[name], *map(str, more)]
    environment = {**os.environ, "OMP_NUM_THREADS": "1"}
    return subprocess.run(given, cwd=ROOT, capture_output=True, text=True, check=True, env=environment).stdout


@pytest.mark.parametrize("command", told(), ids=lambda command: Path(command[0]).name)
def test_the_commands_of_the_page_run(command: list[str], tmp_path: Path) -> None:
    name = Path(command[0]).name
    if name == "oracle.py":
        assert re.findall(r"\d of 1\)", done(command))
        return
    pytest.importorskip("stable_baselines3")
    assert "%" in done(command, "--output", tmp_path)
    kept = "approach" if name == "curves.py" else "chained"
    assert {path.name for path in tmp_path.iterdir()} == {f"{kept}.parquet", f"{kept}.png"}


def test_the_page_tells_of_all_commands() -> None:
    assert {Path(command[0]).name for command in told()} == set(SHORTENED)
