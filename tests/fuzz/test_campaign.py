"""A short campaign finds nothing, and a campaign would find what it looks for."""

from __future__ import annotations

import ctypes
import faulthandler
import os
import subprocess
import sys
import time
from dataclasses import replace
from pathlib import Path

import pytest

from tests.chance import Chance
from tests.fuzz.campaign import attempt, keep
from tests.fuzz.isolated import Limits, Ran, run
from tests.fuzz.judged import fault
from tests.fuzz.kinds import KINDS, mutant
from tests.fuzz.kinds.caches import COUNT, OTHERS_MAY_WRITE, forged, kept
from tests.fuzz.kinds.texts import SEEDS
from tests.fuzz.mutant import SECRET, Mutant
from tests.fuzz.shrink import shrunk

ROOT = Path(__file__).parents[2]
PLAIN = Mutant("logic", 0, {}, (("check", "own"),), placed=True)


@pytest.mark.slow
def test_mutants_of_all_kinds_are_answered_as_they_have_to_be(tmp_path: Path, chance: Chance) -> None:
    count, seed = chance.examples(50), chance.seed(0)
    command = [
        sys.executable,
        "-m",
        "tests.fuzz",
        "--count",
        f"{count}",
        "--seed",
        f"{seed}",
        "--findings",
        str(tmp_path),
    ]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    assert f"{count} mutants of the seed {seed}" in done.stdout and "nothing is wrong" in done.stdout


def test_a_mutant_of_a_number_is_the_same_each_time_and_all_kinds_are_among_few() -> None:
    found = [mutant(number, 3) for number in range(50)]
    first = found[:15]
    assert first == [mutant(number, 3) for number in range(15)] != [mutant(number, 4) for number in range(15)]
    assert {each.kind for each in found} == set(KINDS)


def ran(code: int = 0, out: str = "ok\n", err: str = "", **others: object) -> Ran:
    return Ran(code, out.encode(), err.encode(), 1.0, 10**8, **others)  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("result", "arguments", "what"),
    [
        (ran(), "check", ""),
        (ran(2, "", "a.lp:3: what; do\n"), "check", ""),
        (ran(2, "", "a.lp:3: what; do\na.lp:4: what; do\n"), "check", ""),
        (ran(2, "", "2 warnings about a; see prag-asp check a\na.lp:3: what; do\n"), "check", ""),
        (ran(1, "1\tinvalid\n", "1 task, 0 passed\n"), "validate", ""),
        (ran(2, "", "what; do\n"), "check", "placeless"),
        (ran(2, "", "a.lp:3: what; do\nand more\n"), "check", "lines"),
        (ran(2, "", "a.lp:3: what; do\na.lp:3: what; do\n"), "check", "lines"),
        (ran(2, "", ""), "check", "silence"),
        (ran(0, ""), "check", "silence"),
        (ran(1, "1\tinvalid\n", ""), "count", "silence"),
        (ran(2, "", f"a.lp:3: {'x' * 500}\n"), "check", "long"),
        (ran(2, "", "a.lp:3: \x1b[31m; do\n"), "check", "control"),
        (ran(2, "", "a.lp:3: \u202e; do\n"), "check", "control"),
        (ran(0, f"{SECRET}\n"), "check", "leak"),
        (ran(1, "", 'Traceback (most recent call last):\n  File "/x/prag_asp/a.py", line 3\nValueError: x\n'), "check",
         "traceback prag_asp/a.py:3 ValueError"),
        (ran(-11, "", ""), "check", "signal 11"),
        (ran(hung=True), "check", "hang"),
        (ran(outlived=True), "check", "outlived"),
        (ran(1, "", "MemoryError\n"), "check", "memory"),
        (ran(77, "", "a.lp:3: x\n"), "check", "code 77"),
        (ran(5, "", "a.lp:3: x\n"), "check", "code 5"),
        (ran(64, "", "prag-asp check: x\n"), "check", ""),
    ],
)  # fmt: skip
def test_each_way_to_answer_badly_is_found(result: Ran, arguments: str, what: str) -> None:
    found = fault(result, (arguments,), PLAIN)
    assert found.startswith(what) if what else not found


def crash() -> None:
    faulthandler.disable()  # it would tell of this crash among the results of the tests
    ctypes.string_at(0)


def test_a_process_that_crashes_waits_or_takes_too_much_is_ended_and_told(tmp_path: Path) -> None:
    limits = Limits(1.0, 3 * 10**8)
    raised = run(lambda: {}["no"], tmp_path, limits)
    assert raised.code == 1 and b"Traceback" in raised.err
    assert run(crash, tmp_path, limits).code == -11
    assert run(lambda: time.sleep(600), tmp_path, limits).hung
    assert b"MemoryError" in run(lambda: print(len(bytes(10**9))), tmp_path, limits).err  # noqa: T201
    assert run(lambda: sys.exit(3), tmp_path, limits).code == 3
    busy = run(lambda: [None for _ in iter(int, 1)], tmp_path, Limits(1.0, 10**10))
    assert busy.hung or busy.code


def test_what_a_command_prints_is_read_and_where_it_stands_is_its_own(tmp_path: Path) -> None:
    def work() -> None:
        print(Path.cwd(), os.environ["OWN"], sys.stdin.read())  # noqa: T201

    found = run(work, tmp_path, Limits(), b"given", {"OWN": "yes"})
    assert (found.code, found.out.decode()) == (0, f"{tmp_path} yes given\n") and "OWN" not in os.environ


def test_a_finding_is_made_smaller_and_kept_with_its_command(tmp_path: Path) -> None:
    text = "".join(f"class(c{i}).\n" for i in range(40)) + f"{SECRET} {SECRET}.\n"
    odd = Mutant("logic", 8, {"own/domain.lp": text.encode(), "own/other": b"x"}, (("check", "own"),))
    finding = attempt(odd, Limits()).finding
    assert finding is not None and finding.what.startswith("leak")
    least = shrunk(finding, Limits(), seconds=600)
    assert least.signature == finding.signature and "own/other" not in least.mutant.files
    assert len(least.mutant.files["own/domain.lp"]) < len(text) / 5
    folder = keep(least, tmp_path)
    assert (folder / "own" / "own" / "domain.lp").exists() and "prag-asp check own" in (folder / "run.sh").read_text()


def test_what_a_mutant_keeps_is_believed_where_nobody_else_can_write(chance: Chance) -> None:
    files = {f"own/{path.name}": path.read_bytes() for path in (SEEDS / "closed").iterdir()}
    files |= {f"kept/{name}": forged(content, chance.generator(0)) for name, content in kept(SEEDS / "closed").items()}
    commands = (("check", "own"), (*COUNT, "--no-cache"), COUNT)
    ours = Mutant("cache", 0, files, commands, variables={"PRAG_ASP_CACHE": "kept"})
    finding = attempt(ours, Limits()).finding
    assert finding is not None and finding.what.startswith("differ")
    for path in ("kept", next(name for name in files if name.startswith("kept/"))):
        assert attempt(replace(ours, special={path: OTHERS_MAY_WRITE}), Limits()).finding is None
