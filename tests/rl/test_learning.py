"""The commands of benchmarks/learning, shortened; those that learn need the extra `learning`."""

from __future__ import annotations

import importlib
import io
import os
import re
import runpy
import subprocess
import sys
from contextlib import redirect_stdout, suppress
from functools import cache
from pathlib import Path
from typing import Any

import pyarrow.parquet as pq
import pybullet
import pytest
from click.testing import CliRunner

from tests.docs.pages import DOCS, ROOT

SHORTENED = {
    "oracle.py": "--count 1",
    "plain.py": "--agent SAC --skill PragGrasp --steps 110 --seeds 1 --tests 1",
    "standing.py": "--count 1 --length 2",
    "rates.py": "--blocks 1 --steps 100 --rounds 1 --seconds 0.1",
    "beside.py": "--rounds 1 --seconds 0.1",
    "lasting.py": "--steps 60 --every 30",
    "composition.py": "--kind objects --part familiar --seeds 1 --steps 2 --tests 1",
    "curricula.py": "--curriculum uniform --curriculum Length --seeds 2 --steps 110 --tests 4",
    "chained.py": "--demonstrations 2 --count 1 --epochs 1 --length 2",
}


def commands() -> list[list[str]]:
    """The commands of the pages on learning and on curricula, without the Python that runs them."""
    text = "".join((DOCS / "guides" / name).read_text(encoding="utf-8") for name in ("learning.md", "curriculum.md"))
    return [line.split() for line in re.findall(r"^\.venv/bin/python (.*)$", text, re.MULTILINE)]


def of(name: str) -> list[str]:
    """The first command of the pages with a script."""
    return next(command for command in commands() if Path(command[0]).name == name)


def done(command: list[str], *more: object) -> str:
    """Return what a command prints that runs in a process of its own."""
    given = [sys.executable, *command, *SHORTENED[Path(command[0]).name].split(), *map(str, more)]
    environment = {**os.environ, "OMP_NUM_THREADS": "1"}
    return subprocess.run(given, cwd=ROOT, capture_output=True, text=True, check=True, env=environment).stdout


def done_here(monkeypatch: pytest.MonkeyPatch, command: list[str], *more: object) -> str:
    """Return what a command prints that runs in this process, which has imported what it needs."""
    script = ROOT / command[0]
    monkeypatch.syspath_prepend(str(script.parent))
    monkeypatch.setattr(sys, "argv", [*command, *SHORTENED[script.name].split(), *map(str, more)])
    monkeypatch.chdir(ROOT)
    printed = io.StringIO()
    with redirect_stdout(printed), suppress(SystemExit):
        runpy.run_path(str(script), run_name="__main__")
    return printed.getvalue()


def names(folder: Path) -> set[str]:
    return {path.name for path in folder.iterdir()}


@pytest.mark.parametrize("name", ["oracle.py", "standing.py"])
def test_commands_of_the_page_run_without_training(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    assert re.findall(r"\d of [12]\b", done_here(monkeypatch, of(name)))


def test_the_command_that_measures_memory_runs() -> None:
    measured = re.findall(r"^(\d+) steps, \d+ episodes, \d+ s: [\d.]+ MB$", done(of("lasting.py")), re.MULTILINE)
    assert measured == ["30", "60"]


def test_the_command_that_chains_runs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("stable_baselines3")
    output = done_here(monkeypatch, of("chained.py"), "--output", tmp_path)
    assert re.search(r"^2 of \d+ demonstrations succeed", output, re.MULTILINE)
    assert len(re.findall("^│ cloned ", output, re.MULTILINE)) == 2, "one row for each length"
    assert names(tmp_path) == {"chained.parquet", "chained.png"}


def test_the_command_that_clones_recordings_runs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("torch")
    pytest.importorskip("scipy")
    suite = 'domain = "tabletop"\nlengths = 1\nphysics = {demonstrate = true}\n[parts.train]\ntasks = 2\n'
    (tmp_path / "small.toml").write_text(suite + "split = {train = 0.5, familiar = 0.5}\n")
    monkeypatch.setenv("COLUMNS", "160")
    given = "--suite", tmp_path / "small.toml", "--output", tmp_path
    assert re.search(r"^│ objects │ familiar │ 1 ", done_here(monkeypatch, of("composition.py"), *given), re.MULTILINE)
    assert "composition.parquet" in names(tmp_path)
    before = (tmp_path / "composition.parquet").read_bytes()
    assert "familiar" in done_here(monkeypatch, of("composition.py"), *given)
    assert (tmp_path / "composition.parquet").read_bytes() == before, "evaluations are not run again"


def test_the_command_that_compares_curricula_runs_what_is_missing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    pytest.importorskip("scipy")
    monkeypatch.setenv("COLUMNS", "160")
    command = ["benchmarks/learning/curricula.py"]
    assert f".venv/bin/python {command[0]}\n" in (DOCS / "guides" / "curriculum.md").read_text(encoding="utf-8")
    table = done_here(monkeypatch, command, "--output", tmp_path)
    assert re.search(r"^│ whole tasks +│ Length ", table, re.MULTILINE)
    rows = pq.read_table(tmp_path / "curricula.parquet").to_pylist()
    assert len(rows) == 2 * 2 * 4 and all(0 <= row["reached"] <= row["length"] for row in rows)
    trained = pq.read_table(tmp_path / "curricula_training.parquet").to_pylist()
    assert {(row["curriculum"], row["seed"]) for row in trained} == {(row["curriculum"], row["seed"]) for row in rows}
    assert max(row["length"] for row in trained if row["curriculum"] == "Length") == 1, "it begins with one action"
    before = (tmp_path / "curricula.parquet").read_bytes()
    assert done_here(monkeypatch, command, "--output", tmp_path) == table
    assert (tmp_path / "curricula.parquet").read_bytes() == before


def test_agents_with_default_settings_are_trained_and_tested_once(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    pytest.importorskip("sb3_contrib")
    printed = done_here(monkeypatch, of("plain.py"), "--output", tmp_path)
    assert re.search(r"│ PragGrasp +│ SAC +│ 110 ", printed)
    rows = pq.read_table(tmp_path / "plain.parquet").to_pylist()
    assert [(row["agent"], row["seed"], row["trials"]) for row in rows] == [("SAC", 0, 1)]


@pytest.mark.parametrize("name", ["train_sac.py", "train_pick.py"])
def test_scripts_that_train_run(name: str, capsys: pytest.CaptureFixture[str]) -> None:
    pytest.importorskip("stable_baselines3")
    script = (ROOT / "examples" / "learning" / name).read_text(encoding="utf-8")
    exec(compile(script.replace("10_000", "101").replace("< 30", "< 2"), name, "exec"), {})
    assert re.fullmatch(r"[012] of 2\n", capsys.readouterr().out)


def test_the_pages_name_all_commands() -> None:
    assert {Path(command[0]).name for command in commands()} == set(SHORTENED)


def test_two_processes_are_judged_beside_what_the_machine_lets_two_do(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.syspath_prepend(str(ROOT / "benchmarks" / "learning"))
    beside = importlib.import_module("beside")
    verdicts = {(times, most): beside.verdict(times, most) for times in (1.5, 1.7, 1.8) for most in (1.6, 1.85, 2.1)}
    assert [enough for enough, _ in verdicts.values()] == [True, False, False, True, True, False, True, True, True]
    assert {most for (_, most), (_, message) in verdicts.items() if "no speed-up" in message} == {1.6}


def connected() -> set[int]:
    """Return the clients of PyBullet in this process."""
    return {client for client in range(64) if pybullet.isConnected(client)}


def test_what_environments_do_alone_and_by_twos_is_measured(monkeypatch: pytest.MonkeyPatch) -> None:
    """Both commands report on two processes, which are measured once for both."""
    monkeypatch.syspath_prepend(str(ROOT / "benchmarks" / "learning"))
    monkeypatch.setenv("COLUMNS", "160")
    beside, rates = map(importlib.import_module, ("beside", "rates"))
    monkeypatch.setattr(beside, "measured", cache(beside.measured))
    apart = beside.together

    def together(kind: str, count: int, seconds: float) -> Any:
        """Measure environments in processes, as the command does, and the rest in this one, which has begun."""
        if kind == beside.ENVIRONMENT:
            return apart(kind, count, seconds)
        printed, before = io.StringIO(), connected()
        monkeypatch.setattr(sys, "stdin", io.StringIO("go\n"))
        with redirect_stdout(printed):
            beside.work(kind, count, seconds)
        for client in connected() - before:
            pybullet.disconnect(client)
        assert printed.getvalue().startswith("there\n")
        return beside.Done(*map(float, printed.getvalue().split()[1:]))

    monkeypatch.setattr(beside, "together", together)
    for module, cells, ours in ((beside, 4 * 7, 1), (rates, 4 * 8 + 4 * 7, 2)):
        name = f"{module.__name__}.py"
        assert "--rounds" in CliRunner().invoke(module.main, ["--help"]).stdout
        ended = CliRunner().invoke(module.main, [*of(name)[1:], *SHORTENED[name].split()])
        summary = re.search(r"speed-up of two processes: [\d.]+; of PyBullet alone: [\d.]+", ended.stdout)
        assert summary and ended.stdout.count("│") == cells and ended.exit_code in (0, 1), ended.output
        rows = re.findall(r"^│ (?:prag_asp|environment,) tabletop.*?│ +([\d,]+) ", ended.stdout, re.MULTILINE)
        assert len(rows) == ours and all(int(rate.replace(",", "")) > 0 for rate in rows)
    command = [sys.executable, of("rates.py")[0], "--help"]
    assert "--rounds" in subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True).stdout


def test_what_curricula_cost_is_measured(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    monkeypatch.syspath_prepend(str(ROOT / "benchmarks"))
    module = importlib.import_module("curriculum")
    for name, value in {"SPACES": {"prag": 3}, "COUNT": 4, "TIMES": 1}.items():
        monkeypatch.setattr(module, name, value)
    module.main()
    (row,) = re.findall(r"^│ prag, n = 3 (.*)$", capsys.readouterr().out, re.MULTILINE)
    assert len(re.findall(r"\d\.\d\d", row)) == 7
