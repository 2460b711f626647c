"""The page that trains a policy and evaluates it: its commands, shortened, and the results that it shows."""

from __future__ import annotations

import re
import shlex
from importlib.util import find_spec
from pathlib import Path

import pytest

from prag_asp import Dataset
from prag_asp.evaluation import Results, compare
from prag_asp.rl import TaskEnv
from tests.commands import ok
from tests.docs.pages import DOCS, ROOT, blocks

PAGE = DOCS / "guides" / "train_and_evaluate.md"
KEPT = ROOT / "benchmarks" / "learning" / "results" / "held_out"
SHORTER = {
    "--tasks 15": "--tasks 3",
    "--starts 20": "--starts 1",
    "--steps 50": "--steps 3",
    "--length 2 --tasks 200 --split train=3/4,test=1/4": "--length 1 --tasks 2 --split train=1/2,test=1/2",
    "224x224": "32x32",
    "ws://localhost:8000": "zeros --steps 2",
}


def commands(*, on_a_gpu: bool) -> list[list[str]]:
    """Return the commands of the page that tests run, shortened: those of the last section, or those before."""
    text = PAGE.read_text(encoding="utf-8")
    last = text.count("\n", 0, text.index("\n## On a GPU")) + 2
    lines = [line for block in blocks(PAGE) if block.language == "sh" and (block.line > last) == on_a_gpu
             for line in block.text.splitlines()]  # fmt: skip
    for long, short in SHORTER.items():
        lines = [line.replace(long, short) for line in lines]
    return [shlex.split(line) for line in lines if line.startswith(("prag-asp ", "python "))]


def test_commands_of_the_page_end_with_tables_by_part(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    printed: dict[str, str] = {}
    for program, *arguments in commands(on_a_gpu=False):
        if "picker" in " ".join(arguments) and find_spec("stable_baselines3") is None:
            continue
        if program == "prag-asp":
            few = ["--count", "1"] if arguments[0] == "evaluate" else []
            printed[" ".join(arguments[:2])] = ok(*arguments, *few, cwd=tmp_path)
        elif find_spec("stable_baselines3") is not None:
            script = (ROOT / arguments[0]).read_text(encoding="utf-8")
            exec(compile(script.replace("10_000", "101"), arguments[0], "exec"), {})
    tables = [text for name, text in printed.items() if name.startswith("evaluate")]
    assert len(tables) >= 2 and all("\npart test" in text and "\npart train" in text for text in tables)
    assert all("\npart test" in text for name, text in printed.items() if name.startswith("compare"))
    dataset = Dataset.open(tmp_path / "scenarios")
    env = TaskEnv(domain="tabletop", length=1, split="train", hold_out="can")
    trained = {env.reset(seed=0)[1]["task"], *(env.reset()[1]["task"] for _ in range(5))}
    env.close()
    assert not any("can_1" in task for task in trained | {*map(str, dataset.part("train").tasks())})
    assert all("can_1" in str(task) for task in dataset.part("test").tasks())


def test_commands_for_a_policy_server_run(tmp_path: Path) -> None:
    pytest.importorskip("av")
    for _, *arguments in commands(on_a_gpu=True):
        printed = ok(*arguments, cwd=tmp_path)
    assert "\npart test" in printed and "\npart train" in printed
    env = TaskEnv(domain="tabletop", length=2, control="joint_position", observation="poses")
    names = env.layout.names
    assert names[:7] == tuple(f"panda: joint {i}" for i in range(1, 8)) and names[15] == "panda: width"
    env.close()


def test_tables_of_the_page_are_those_of_the_kept_results() -> None:
    shown = [block.text.rstrip("\n") for block in blocks(PAGE) if block.language == "text"]
    picker, reach, oracle = (Results.open(KEPT / name) for name in ("picker", "reach", "oracle"))
    assert shown[1:] == [picker.table(), compare(picker, reach).table(), compare(picker, oracle).table()]
    assert picker.by("part")["test"].trials == 100 and picker.by("part")["train"].trials == 200
    text = PAGE.read_text(encoding="utf-8")
    for rate in (results.by("part")[part] for results in (reach, oracle) for part in ("train", "test")):
        assert re.sub(r"; (.*)\)$", r")", str(rate)) in text
