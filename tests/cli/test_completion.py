"""Completion as shells ask for it: by click's protocol, and by bash itself."""

from __future__ import annotations

import os
import pty
import re
import select
import shlex
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from prag_asp.program.paths import shipped_domains
from prag_asp.space.engines import AUTO, ENGINES
from tests.warm import warm_commands

ROOT = Path(__file__).parents[2]
PATIENCE = 300.0
"""Seconds that a shell on a busy machine may take for one completion."""


def asked(*words: str, shell: str = "bash", cwd: Path = ROOT) -> list[str]:
    """Return the lines that a shell is answered for the last of some words, as it stands on the command line."""
    told = {"COMP_WORDS": "\n".join(["prag-asp", *words]), "COMP_CWORD": str(len(words))}
    if shell == "fish":
        told = {"COMP_WORDS": " ".join(["prag-asp", *words]), "COMP_CWORD": words[-1]}
    done = subprocess.run(
        [warm_commands() / "prag-asp"], env={**os.environ, **told, "_PRAG_ASP_COMPLETE": f"{shell}_complete"},
        cwd=cwd, capture_output=True, text=True, timeout=PATIENCE, check=True,
    )  # fmt: skip
    assert done.stderr == ""
    return done.stdout.strip("\n").splitlines()


def offered(*words: str, cwd: Path = ROOT) -> list[str]:
    """Return what bash is offered, without its quotes."""
    found = [line.partition(",") for line in asked(*words, cwd=cwd)]
    assert all(kind == "plain" for kind, _, _ in found)
    return [shlex.split(value)[0] if not words[-1].startswith("'") else value for _, _, value in found]


def test_commands_and_options_are_offered() -> None:
    assert offered("co") == ["compare", "completion", "count"]
    assert offered("count", "--up") == ["--upto"]
    assert offered("sample", "prag", "--over", "g") == ["goals"]
    assert offered("export", "b") == ["bddl", "blocks"]
    assert offered("export", "lerobot", "data", "--le") == ["--level"]
    assert offered("export", "tabletop", "--engine", "auto", "--by", "t") == ["task"]


def test_domains_are_offered_by_name_and_as_folders_and_files(tmp_path: Path) -> None:
    assert offered("count", "") == [*shipped_domains()]
    assert offered("count", "t") == ["tabletop", "two_arms"]
    for name in ("talk.lp", "task/domain.lp", "tame/other.txt"):
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).write_text("", encoding="utf-8")
    assert offered("count", "ta", cwd=tmp_path) == ["tabletop", "talk.lp", "task"]
    assert offered("count", "./ta", cwd=tmp_path) == ["./talk.lp", "./task"]
    assert offered("count", "talk.lp", "ta", cwd=tmp_path) == ["talk.lp"]  # more files, for it is one of files
    assert asked("count", "tam", cwd=tmp_path) == ["file,tam"]
    assert offered("render", "tasks.jsonl", "--domain", "pr") == ["prag"]
    assert asked("validate", "ta") == ["file,ta"]
    assert offered("explain", "han") == offered("split", "han") == ["hanoi"]


def test_cameras_of_the_scene_and_what_varies_are_offered() -> None:
    assert offered("sample", "two_arms", "--cameras", "") == ["front", "left_wrist", "right_wrist"]
    assert offered("sample", "tabletop", "--cameras", "front,w") == ["front,wrist"]
    assert offered("sample", "hanoi", "--cameras", "") == []
    assert offered("sample", "tabletop", "--vary", "mass,c") == ["mass,camera", "mass,colour"]


def test_rules_engines_and_first_words_of_conditions_are_offered(tmp_path: Path) -> None:
    assert offered("count", "prag", "--rule", "") == ["at_most", "closed_world", "ever", "no_undo"]
    (tmp_path / "rules").mkdir()
    (tmp_path / "rules" / "mine.lp").write_text("", encoding="utf-8")
    assert offered("count", "prag", "--encodings", str(tmp_path), "--rule", "") == ["mine"]
    assert offered("count", "prag", "--engine", "") == [AUTO, *ENGINES]
    assert offered("count", "prag", "--where", "l") == ["lacks", "loop-free"]
    assert offered("count", "--where", "no") == ["not matches", "nontrivial"]
    assert offered("count", "prag", "--where", "'uses ap") == ["uses apple_1", "uses apple_2", "uses apple"]
    assert offered("count", "prag", "--where", "lack")[:2] == ["lacks approach", "lacks drop"]
    assert offered("count", "prag", "--where", "'after 2: h") == []


def test_actions_and_entities_of_the_domain_are_offered() -> None:
    actions = [f"approach(panda,{name})" for name in ("apple_1", "apple_2", "box_1", "can_1")]
    assert offered("explain", "prag", "app") == actions
    assert offered("explain", "prag", "grasp(panda,can_1)", "'approach(panda,b") == ["approach(panda,box_1)"]
    assert offered("explain", "prag", "'grasp(panda,can_1) app")[0] == "grasp(panda,can_1) approach(panda,apple_1)"
    assert offered("task", "prag", "-n", "2", "--rank-of", "'approach(panda, c") == []
    assert offered("task", "prag", "-n", "2", "--rank-of", "'approach(panda,c") == ["approach(panda,can_1)"]
    assert offered("count", "prag", "--prefix", "approach,gr")[:2] == [
        "approach,grasp",
        "approach,grasp(panda,apple_1)",
    ]
    assert offered("sample", "prag", "--weight", "can") == ["can", "can_1"]
    assert offered("split", "prag", "--hold-out", "gras") == ["grasp", "graspable"]
    assert offered("explain", "hanoi", "-c", "discs=1", "move(disc(2)") == []
    assert len(offered("explain", "hanoi", "-c", "discs=4", "'move(disc(4)")) == 6


def test_what_cannot_be_read_offers_nothing(tmp_path: Path) -> None:
    (tmp_path / "broken.lp").write_text("action(.", encoding="utf-8")
    for words in (
        ("explain", "broken.lp", "a"), ("explain", "nowhere", "a"), ("explain", "-", "a"), ("count", "--prefix", "a"),
        ("explain", "hanoi", "-c", "discs", "m"), ("count", "nowhere/", "--where", "'uses a"),
        ("count", "prag", "--encodings", "/nowhere", "--rule", "n"), ("split", "prag", "tra"),
    ):  # fmt: skip
        assert asked(*words, cwd=tmp_path) == []


@pytest.mark.parametrize("words", [("count", "ta"), ("co",), ("count", "prag", "--rule", "n"), ("explain", "h")])
def test_completing_what_needs_no_domain_loads_no_solver(words: tuple[str, ...]) -> None:
    code = (
        "import sys\nfrom prag_asp.cli import main\ntry: main()\n"
        "finally: print(*sorted({'clingo', 'numpy'} & {*sys.modules}), file=sys.stderr)"
    )
    told = {"COMP_WORDS": "\n".join(["prag-asp", *words]), "COMP_CWORD": str(len(words))}
    env = {**os.environ, **told, "_PRAG_ASP_COMPLETE": "bash_complete"}
    done = subprocess.run([sys.executable, "-c", code], env=env, capture_output=True, text=True, check=False)
    assert done.stdout and done.stderr == "\n"


def test_each_shell_is_told_in_its_own_way() -> None:
    assert asked("explain", "prag", "approach(panda,c") == ["plain,'approach(panda,can_1)'"]
    assert asked("explain", "prag", "'approach(panda,c") == ["plain,approach(panda,can_1)"]
    assert asked("explain", "prag", "'approach(panda,c", shell="fish") == ["plain,approach(panda,can_1)"]
    assert asked("explain", "prag", "'approach(panda,c", shell="zsh") == ["plain", "approach(panda,can_1)", "_"]


@pytest.mark.parametrize("shell", ["bash", "zsh", "fish"])
def test_the_script_of_a_shell_asks_for_completions(shell: str) -> None:
    done = subprocess.run(
        [sys.executable, "-m", "prag_asp", "completion", shell], capture_output=True, text=True, check=True
    )
    assert f"_PRAG_ASP_COMPLETE={shell}_complete" in done.stdout and "prag-asp" in done.stdout
    assert ('split --max 1 ","' in done.stdout) == (shell == "fish")


class Terminal:
    """A bash that a user types into."""

    def __init__(self, file: int) -> None:
        self._file, self._shown = file, ""

    def type(self, keys: str, until: str) -> None:
        """Type, and wait until what is shown from then on fits a regular expression."""
        os.write(self._file, keys.encode())
        end, begin = time.monotonic() + PATIENCE, len(self._shown)
        while not re.search(until, self._shown[begin:]):
            assert time.monotonic() < end, f"{keys!r} shows no {until!r} but {self._shown[begin:]!r}"
            if select.select([self._file], [], [], 0.1)[0]:
                self._shown += os.read(self._file, 65536).decode(errors="replace")


@contextmanager
def bash() -> Iterator[Terminal]:
    """Start a bash in which prag-asp is a command with completion."""
    path = f"{warm_commands()}{os.pathsep}{os.environ['PATH']}"
    changed = {"PATH": path, "PS1": "$ ", "TERM": "dumb", "INPUTRC": "/dev/null"}
    file, end = pty.openpty()
    shell = subprocess.Popen(
        ["bash", "--norc", "--noprofile", "-i"],
        stdin=end, stdout=end, stderr=end, env={**os.environ, **changed}, start_new_session=True,
    )  # fmt: skip
    os.close(end)
    try:
        terminal = Terminal(file)
        terminal.type("bind 'set bell-style none'; stty columns 200; eval \"$(prag-asp completion bash)\"\n", r"\$ ")
        terminal.type("complete -p prag-asp\n", "-F _prag_asp_completion prag-asp")
        yield terminal
    finally:
        shell.kill()
        shell.wait()
        os.close(file)


def test_bash_completes_words_as_they_are_typed() -> None:
    with bash() as terminal:
        terminal.type("prag-asp cou\t", "count ")
        terminal.type("tablet\t", "tabletop ")
        terminal.type("-n 1\n", r"\s15\s+\$ ")
        terminal.type("prag-asp explain prag app\t", r"'approach\(panda,")
        terminal.type("can\t", r"can_1\)' ")
        terminal.type("'grasp(panda,can\t", r"_1\)' ")
        terminal.type("\n", r"\sa plan of prag\s+\$ ")
        terminal.type("prag-asp count prag -n 1 --where us\t", "'uses ")
        terminal.type("crat\t", "crate")
        terminal.type("_\t", "_1' ")
        terminal.type("\n", r"\s9\s+\$ ")
