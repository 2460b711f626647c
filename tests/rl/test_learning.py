"""The commands of benchmarks/learning, shortened; those that learn need the extra `learning`."""

from __future__ import annotations

import importlib
import os
import re
import subprocess
import sys
from functools import cache
from pathlib import Path
from typing import Any

import pytest
from click.testing import CliRunner

from prag_asp.rl import OraclePolicy
from prag_asp.rl.environment import STEPS
from tests.docs.pages import DOCS, ROOT

SHORTENED = {
    "oracle.py": "--count 1",
    "curves.py": "--steps 310 --every 310 --training 2 --held-out 1",
    "fresh.py": "--count 1 --training 2",
    "standing.py": "--count 1 --length 2",
    "parts.py": "--approach 60 --grasp 60 --every 60 --seeds 1 --training 3 --held-out 1",
    "rates.py": "--blocks 1 --steps 100 --rounds 1 --seconds 0.1",
    "beside.py": "--rounds 1 --seconds 0.1",
    "lasting.py": "--steps 60 --every 30",
    "chained.py": "--demonstrations 2 --count 1 --epochs 1 --length 2",
}


def commands() -> list[list[str]]:
    """The commands of the page, without the Python that runs them."""
    text = (DOCS / "guides" / "learning.md").read_text(encoding="utf-8")
    return [line.split() for line in re.findall(r"^\.venv/bin/python (.*)$", text, re.MULTILINE)]


def of(name: str) -> list[str]:
    """The first command of the page with a script."""
    return next(command for command in commands() if Path(command[0]).name == name)


def done(command: list[str], *more: object) -> str:
    name = Path(command[0]).name
    given = [sys.executable, *command, *SHORTENED[name].split(), *map(str, more)]
    environment = {**os.environ, "OMP_NUM_THREADS": "1"}
    return subprocess.run(given, cwd=ROOT, capture_output=True, text=True, check=True, env=environment).stdout


def names(folder: Path) -> set[str]:
    return {path.name for path in folder.iterdir()}


@pytest.mark.parametrize("name", ["oracle.py", "standing.py"])
def test_commands_of_the_page_run_without_training(name: str) -> None:
    assert re.findall(r"\d of [12]\b", done(of(name)))


def test_the_command_that_measures_memory_runs() -> None:
    measured = re.findall(r"^(\d+) steps, \d+ episodes, \d+ s: [\d.]+ MB$", done(of("lasting.py")), re.MULTILINE)
    assert measured == ["30", "60"]


def test_the_command_that_chains_runs(tmp_path: Path) -> None:
    pytest.importorskip("stable_baselines3")
    output = done(of("chained.py"), "--output", tmp_path)
    assert re.search(r"^2 of \d+ demonstrations succeed", output, re.MULTILINE)
    assert len(re.findall("^│ cloned ", output, re.MULTILINE)) == 2, "one row for each length"
    assert names(tmp_path) == {"chained.parquet", "chained.png"}


def test_the_commands_run_that_learn_and_that_test_what_is_learned(tmp_path: Path) -> None:
    pytest.importorskip("stable_baselines3")
    models, output = tmp_path / "models", tmp_path / "learned"
    assert "%" in done(of("curves.py"), "--output", output, "--models", models)
    assert names(output) == {"approach.parquet", "approach.png"}
    tested = [str(models) if word == "MODELS" else word for word in of("fresh.py")]
    assert "%" in done(tested, "--output", output)
    assert "fresh.parquet" in names(output)


def test_the_command_runs_that_learns_a_pick_by_parts(tmp_path: Path) -> None:
    pytest.importorskip("stable_baselines3")
    assert "%" in done(of("parts.py"), "--output", tmp_path)
    assert names(tmp_path) == {"parts.parquet", "parts.png"}


@pytest.mark.parametrize("reaches", [True, False])
def test_a_grasp_is_learned_from_where_the_approach_ends(reaches: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("stable_baselines3")
    monkeypatch.syspath_prepend(str(ROOT / "benchmarks" / "learning"))
    parts, curves, starts = (importlib.import_module(name) for name in ("parts", "curves", "starts"))
    env = curves.begun(starts.wholly(parts.SKILLS, 3, seed=1), "dense", seed=0, begin="task")
    expert = OraclePolicy(env.unwrapped)

    class Approach:
        def predict(self, seen: Any, *, deterministic: bool) -> tuple[Any, None]:
            return (expert({}) if reaches else 0 * env.action_space.sample()), None

    grasping = parts.After(env, Approach(), limit=2)
    seen, info = grasping.reset()
    assert info["action"].startswith("grasp") and (info["steps_left"] % STEPS == 0) is not reaches
    assert seen.shape == env.observation_space.shape
    ends = [grasping.step(0 * env.action_space.sample())[2:4] for _ in range(2)]
    assert ends == [(False, False), (False, True)]
    env.close()


@pytest.mark.slow
def test_whole_tasks_are_learned_from_any_stage(tmp_path: Path) -> None:
    pytest.importorskip("stable_baselines3")
    command = [of("curves.py")[0], "grasp", "--begin", "backwards", "--rewards", "dense", "--seeds", "1"]
    assert "whole" in done(command, "--output", tmp_path)
    assert names(tmp_path) == {"grasp_from_backwards.parquet", "grasp_from_backwards.png"}


def test_the_page_names_all_commands() -> None:
    assert {Path(command[0]).name for command in commands()} == set(SHORTENED)


def test_two_processes_are_judged_beside_what_the_machine_lets_two_do(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.syspath_prepend(str(ROOT / "benchmarks" / "learning"))
    beside = importlib.import_module("beside")
    verdicts = {(times, most): beside.verdict(times, most) for times in (1.5, 1.7, 1.8) for most in (1.6, 1.85, 2.1)}
    assert [enough for enough, _ in verdicts.values()] == [True, False, False, True, True, False, True, True, True]
    assert {most for (_, most), (_, message) in verdicts.items() if "no speed-up" in message} == {1.6}


def test_what_environments_do_alone_and_by_twos_is_measured(monkeypatch: pytest.MonkeyPatch) -> None:
    """Both commands report on two processes, which are measured once for both."""
    monkeypatch.syspath_prepend(str(ROOT / "benchmarks" / "learning"))
    monkeypatch.setenv("COLUMNS", "160")
    beside, rates = map(importlib.import_module, ("beside", "rates"))
    monkeypatch.setattr(beside, "measured", cache(beside.measured))
    for module, cells, ours in ((beside, 4 * 7, 1), (rates, 4 * 6 + 4 * 7, 2)):
        name = f"{module.__name__}.py"
        command = [sys.executable, of(name)[0], "--help"]
        assert "--rounds" in subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True).stdout
        ended = CliRunner().invoke(module.main, [*of(name)[1:], *SHORTENED[name].split()])
        summary = re.search(r"speed-up of two processes: [\d.]+; of PyBullet alone: [\d.]+", ended.stdout)
        assert summary and ended.stdout.count("│") == cells and ended.exit_code in (0, 1), ended.output
        rows = re.findall(r"^│ (?:prag_asp|environment,) tabletop.*?│ +([\d,]+) ", ended.stdout, re.MULTILINE)
        assert len(rows) == ours and all(int(rate.replace(",", "")) > 0 for rate in rows)


def test_what_curricula_cost_is_measured(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    monkeypatch.syspath_prepend(str(ROOT / "benchmarks"))
    module = importlib.import_module("curriculum")
    for name, value in {"SPACES": {"prag": 3}, "COUNT": 4, "TIMES": 1}.items():
        monkeypatch.setattr(module, name, value)
    module.main()
    (row,) = re.findall(r"^│ prag, n = 3 (.*)$", capsys.readouterr().out, re.MULTILINE)
    assert len(re.findall(r"\d\.\d\d", row)) == 7


def test_what_is_learned_from_is_not_held_out(monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("gymnasium")
    monkeypatch.syspath_prepend(str(ROOT / "benchmarks" / "learning"))
    module = importlib.import_module("starts")
    learned, other = [module.Start("task", "witness", 0)], [module.Start("task", "another", 0)]
    module.require_apart(learned, other, tasks=False)
    for tested, tasks in ((learned, False), (other, True)):
        with pytest.raises(ValueError, match="task is in the training set"):
            module.require_apart(learned, tested, tasks=tasks)
