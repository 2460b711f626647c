"""The commands of benchmarks/learning, shortened; those that learn need the extra `learning`."""

from __future__ import annotations

import importlib
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
    "fresh.py": ["--count", "1", "--training", "2"],
    "standing.py": ["--count", "1", "--length", "2"],
    "chained.py": ["--demonstrations", "2", "--count", "1", "--epochs", "1", "--length", "2"],
}


def told() -> list[list[str]]:
    """The commands of the page, without the Python that runs them."""
    text = (DOCS / "guides" / "learning.md").read_text(encoding="utf-8")
    return [line.split() for line in re.findall(r"^\.venv/bin/python (.*)$", text, re.MULTILINE)]


def of(name: str) -> list[str]:
    """The first command of the page with a script."""
    return next(command for command in told() if Path(command[0]).name == name)


def done(command: list[str], *more: object) -> str:
    name = Path(command[0]).name
    given = [sys.executable, *command, *SHORTENED[name], *map(str, more)]
    environment = {**os.environ, "OMP_NUM_THREADS": "1"}
    return subprocess.run(given, cwd=ROOT, capture_output=True, text=True, check=True, env=environment).stdout


@pytest.mark.parametrize("command", told(), ids=lambda command: " ".join([Path(command[0]).name, *command[1:]]))
def test_the_commands_of_the_page_run(command: list[str], tmp_path: Path) -> None:
    name = Path(command[0]).name
    if name in ("oracle.py", "standing.py"):
        assert re.findall(r"\d of [12]\)", done(command))
        return
    pytest.importorskip("stable_baselines3")
    models, output = tmp_path / "models", tmp_path / "learned"
    if name == "fresh.py":
        done(of("curves.py"), "--output", tmp_path / "first", "--models", models)
    command = [str(models) if word == "MODELS" else word for word in command]
    assert "%" in done(command, "--output", output)
    assert {path.suffix for path in output.iterdir()} == ({".parquet"} if name == "fresh.py" else {".parquet", ".png"})


def test_the_page_tells_of_all_commands() -> None:
    assert {Path(command[0]).name for command in told()} == set(SHORTENED)


def test_what_is_learned_from_is_not_held_out(monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("gymnasium")
    monkeypatch.syspath_prepend(str(ROOT / "benchmarks" / "learning"))
    module = importlib.import_module("starts")
    learned, other = [module.Start("task", "witness", 0)], [module.Start("task", "another", 0)]
    module.require_apart(learned, other, tasks=False)
    for tested, tasks in ((learned, False), (other, True)):
        with pytest.raises(ValueError, match="task is learned from"):
            module.require_apart(learned, tested, tasks=tasks)
