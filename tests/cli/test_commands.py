"""The command line on good input and on bad."""

from __future__ import annotations

import json
import subprocess
from pathlib import Path

import pytest

from prag_asp import TaskSpace, load_domain, load_scene
from prag_asp.dataset.jsonl import read_lines
from prag_asp.physics import Witness, check_witness
from tests.commands import PRAG, ok, ok_apart, run
from tests.processes import interrupt, interruptible, until_it_works


def test_count_prints_the_integer_alone_and_a_table_upto_a_length() -> None:
    assert ok_apart("count", "prag", "--length", "15", "--by", "skeleton", "--prefix", "approach") == "191264896\n"
    assert ok("count", "prag", "-n", "15", "--by", "skeleton") == "4266036480\n"
    text = ok("count", "prag", "--length", "7000", "--by", "skeleton").strip()
    assert len(text) > 4300 and text.isdigit(), "thousands of digits are printed"
    assert ok("count", "prag", "-n", "3", "--by", "skeleton", "--upto").split() == [
        "length", "skeletons", "1", "8", "2", "30", "3", "124",
    ]  # fmt: skip


@pytest.mark.parametrize("engine", ["automaton", "clingo", "auto"])
def test_engines_and_prefixes_with_actions_agree(engine: str) -> None:
    # Two steps are left: drop, then 2 ways on; or 3 x 2 ways to carry and 2 to turn, each with 9 ways on.
    prefix = "approach(panda, can_1),grasp"
    assert ok("count", "prag", "-n", "4", "--by", "plan", "--prefix", prefix, "--engine", engine) == "74\n"


def test_rules_are_added_by_name_and_with_arguments() -> None:
    plain = int(ok("count", "prag", "-n", "4"))
    assert int(ok("count", "prag", "-n", "4", "--rule", "no_undo")) < plain
    assert int(ok("count", "prag", "-n", "4", "--rule", "at_most(move,0)")) < plain


def test_enumerate_prints_each_task_once_in_order() -> None:
    lines = ok("enumerate", "prag", "-n", "2").splitlines()
    assert len(lines) == len(set(lines)) == 265
    assert ok("enumerate", "prag", "-n", "2", "--limit", "3").splitlines() == lines[:3]
    assert ok("enumerate", "prag", "-n", "2", "--engine", "clingo").splitlines() == lines
    assert len(ok("enumerate", "prag", "-n", "2", "--by", "skeleton").splitlines()) == 30


def test_enumerate_writes_tasks_as_json() -> None:
    (line,) = ok("enumerate", "hanoi", "-n", "2", "--limit", "1", "--format", "jsonl").splitlines()
    task = json.loads(line)
    assert task["actions"] == ["move(disc(1),left,middle)", "move(disc(1),middle,left)"]
    assert task["entities"]["disc(1)"] == "disc"
    assert task["states"][1] == task["initial"]


def test_sample_gives_the_same_bytes_with_one_worker_and_with_two(tmp_path: Path) -> None:
    arguments = ["sample", "tabletop", "--length", "2", "--count", "4", "--seed", "7", "--format", "jsonl"]
    one, two = (run(*arguments, "--workers", workers) for workers in "12")
    assert one == two and one.returncode == 0
    assert "4 passed" in one.stderr and "budget" in one.stderr
    domain = load_domain("tabletop")
    scene = load_scene(domain)
    space = TaskSpace(domain, 2, engine="clingo")
    records = list(read_lines(one.stdout.splitlines(), "stdout"))
    assert len(records) == 4
    for record in records:
        assert record.task in space
        assert record.verdict is not None and record.verdict["status"] == "feasible"
        assert record.witness is not None
        assert check_witness(record.task, Witness.from_json(record.witness), scene) == []
    file = tmp_path / "tasks.jsonl"
    file.write_text(one.stdout)
    assert ok("validate", str(file), "--witness-only", "--workers", "2", cwd=tmp_path).count("feasible") == 4
    assert ok("validate", str(file), cwd=tmp_path).count("feasible") == 4


def test_validate_finds_an_invalid_plan_and_a_wrong_witness(tmp_path: Path) -> None:
    lines = ok("sample", "tabletop", "-n", "2", "--count", "3", "--format", "jsonl").splitlines()
    tasks = [json.loads(line) for line in lines]
    tasks[0]["actions"].reverse()
    for moment in tasks[1]["witness"]["moments"]:
        for pose in moment["poses"].values():
            pose[0][2] += 0.5
    tasks[2]["witness"] = None
    tasks.append({**tasks[1], "witness": {"moments": 3}})
    tasks.append({**tasks[1], "goal": {}})
    file = tmp_path / "tasks.jsonl"
    file.write_text("\n".join(map(json.dumps, tasks)))
    done = run("validate", str(file), "--witness-only")
    assert done.returncode == 1
    assert [line.split("\t")[1] for line in done.stdout.splitlines()] == [
        "invalid", "witness_fails", "not_found", "witness_fails", "invalid",
    ]  # fmt: skip
    assert "5 tasks, 0 passed" in done.stderr


def test_sample_without_physics_follows_weights_and_seed() -> None:
    arguments = ["sample", "prag", "-n", "6", "--no-physics", "--count", "20", "--weight", "rotate=0"]
    text = ok(*arguments)
    assert "rotate" not in text and len(text.splitlines()) == 20
    assert ok_apart(*arguments) == text != ok(*arguments, "--seed", "1")


def test_sample_uses_the_language_of_the_domain() -> None:
    text = ok("sample", "prag", "-n", "1", "--no-physics", "--count", "30", "--format", "sentences")
    assert "grasp can 1" in text.splitlines() and "(" not in text
    assert ok("enumerate", "blocks", "-n", "1", "--limit", "1", "--format", "sentences") == "pick up a\n"


def test_tasks_are_told_to_somebody_who_sees_the_scene(tmp_path: Path) -> None:
    arguments = ["sample", "tabletop", "-n", "2", "--no-physics", "--count", "3", "--format", "instructions"]
    told = ok(*arguments)
    assert len(told.splitlines()) == 3 and "_" not in told and told.count(".") >= 3
    assert ok(*arguments) == told and ok(*arguments, "--level", "default", "--language", "en") == told
    german = ok(*arguments, "--language", "de", "--level", "exact")
    assert all(line.startswith("Erstens: ") for line in german.splitlines())
    lines = ok("task", "tabletop", "-n", "2", "--index", "100", "--format", "instructions").splitlines()
    assert [line.split()[0] for line in lines] == ["vague", "default", "exact", "1", "2"]
    named = ok("task", "blocks", "-n", "1", "--index", "0", "--format", "instructions").splitlines()[-1]
    assert named == "named    a: not visually distinguishable from other objects"
    ok(
        *["split", "blocks", "a=0.5", "b=0.5", "-n", "3", "--count", "2", "--format", "instructions", "-o", "parts"],
        cwd=tmp_path,
    )
    assert len((tmp_path / "parts" / "a.txt").read_text().splitlines()) == 2


@pytest.mark.parametrize(
    ("arguments", "told"),
    [
        (
            ["sample", "hanoi", "-n", "1", "--format", "instructions", "--language", "de"],
            "hanoi has no sentences in 'de'",
        ),
        (["sample", "hanoi", "-n", "1", "--language", "de"], "--language de goes with --format instructions"),
        (["enumerate", "hanoi", "-n", "1", "--level", "exact"], "--level exact goes with --format instructions"),
        (["task", "hanoi", "-n", "1", "--index", "0", "--language", "en"], "got --format full"),
    ],
)
def test_a_language_that_is_not_spoken_is_told_in_one_line(arguments: list[str], told: str) -> None:
    done = run(*arguments)
    assert done.returncode == 2 and told in done.stderr and done.stderr.count("\n") == 1 and not done.stdout


def test_new_writes_a_domain_that_checks_counts_and_validates(tmp_path: Path) -> None:
    ok("new", "mine", cwd=tmp_path)
    assert ok("check", "mine", cwd=tmp_path).startswith("mine: ok")
    counts = {ok("count", "mine", "-n", "4", "--engine", engine, cwd=tmp_path) for engine in ("automaton", "clingo")}
    assert len(counts) == 1 and int(counts.pop()) > 0
    assert len(ok("sample", "mine", "-n", "4", "--count", "5", cwd=tmp_path).splitlines()) == 5
    again = run("new", "mine", cwd=tmp_path)
    assert again.returncode == 2 and len(again.stderr.splitlines()) == 1


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["count", "tabeltop", "-n", "3"], "did you mean tabletop?"),
        (["count", "prag", "-n", "-1"], "at least 0"),
        (["count", "prag", "-n", "3", "--prefix", "aproach"], "did you mean approach?"),
        (["count", "prag", "-n", "3", "--prefix", "approach(panda"], "not a list of terms"),
        (["count", "prag", "-n", "3", "--by", "skeleton", "--prefix", "grasp(panda,can_1)"], "single action"),
        (["count", "prag", "-n", "3", "--engine", "smt"], "no engine 'smt'"),
        (["count", "prag", "-n", "3", "--rule", "no_redo"], "no such rule"),
        (["count", "prag", "-n", "3", "--rule", "../step"], "no such rule"),
        (["count", "prag", "-n", "3", "--rule", "at_most(grasp,x)"], "at most x times"),
        (["count", "prag", "-n", "3", "--encodings", "/nowhere"], "encodings has no contract.lp"),
        (["sample", "prag", "-n", "3", "--weight", "grasp"], "KEY=WEIGHT"),
        (["sample", "prag", "-n", "3", "--weight", "gras=2"], "did you mean grasp?"),
        (["sample", "prag", "-n", "3", "--weight", "grasp=-2"], "below 0"),
        (["sample", "prag", "-n", "3", "--weight", "apple_1=2"], "interchangeable"),
        (["sample", "blocks", "-n", "3", "--physics"], "no [scene]"),
        (["enumerate", "prag", "-n", "3", "--by", "skeleton", "--format", "jsonl"], "cannot be printed as jsonl"),
        (["sample", "blocks", "-n", "3", "--tier", "settling"], "--tier needs physics"),
        (["sample", "prag", "-n", "3", "--no-physics", "--demonstrate", "recorded"], "--demonstrate needs physics"),
        (["sample", "prag", "-n", "3", "--no-physics", "--budget", "2x2"], "--budget needs physics"),
        (["validate", "/nowhere.jsonl"], "No such file"),
        (["new", "9 lives"], "9 lives"),
    ],
)
def test_bad_input_is_answered_by_a_line_and_exit_code_2(arguments: list[str], words: str, tmp_path: Path) -> None:
    done = run(*arguments, cwd=tmp_path)
    assert words in done.stderr
    assert "Traceback" not in done.stderr and done.stdout == ""
    assert done.returncode == 2


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["count", "prag", "-n", "3", "--by", "world"], "Invalid value for '--by'"),
        (["count", "prag"], "Missing option"),
        (["count", "prag", "-n", "3", "--bye"], "No such option"),
        (["cuont", "prag", "-n", "3"], "No such command"),
    ],
)
def test_wrong_usage_has_an_exit_code_of_its_own(arguments: list[str], words: str) -> None:
    done = run(*arguments)
    assert words in done.stderr and (done.returncode, done.stdout) == (64, "")


def test_a_file_that_holds_no_tasks_is_named_with_its_line(tmp_path: Path) -> None:
    file = tmp_path / "tasks.jsonl"
    for text, words in (
        ("", "no tasks in it"),
        ("{}\n", ":1: not a task"),
        ("\n[1]\n", ":2: not a task"),
        ("[" * 99_999, ":1: not a task"),
    ):
        file.write_text(text)
        done = run("validate", str(file))
        assert done.returncode == 2 and words in done.stderr and "Traceback" not in done.stderr


def test_a_folder_that_cannot_be_written_is_named(tmp_path: Path) -> None:
    done = run("sample", "prag", "-n", "2", "--no-physics", "-o", str(tmp_path / "missing" / "x.jsonl"))
    assert done.returncode == 4 and "cannot be written" in done.stderr and len(done.stderr.splitlines()) == 1


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="needs a device that is always full")
def test_a_full_disk_ends_with_one_line() -> None:
    done = run("enumerate", "prag", "-n", "3", "-o", "/dev/full")
    assert done.returncode == 4 and done.stderr.count("\n") == 1 and "No space left" in done.stderr
    with Path("/dev/full").open("w") as full:
        code = subprocess.run([*PRAG, "enumerate", "prag", "-n", "3"], stdout=full, stderr=subprocess.PIPE, check=False)
    assert code.returncode == 4 and b"Traceback" not in code.stderr and b"No space left" in code.stderr


@pytest.mark.parametrize(
    "arguments",
    [
        ["enumerate", "prag", "-n", "9", "-o", "out.txt"],
        ["sample", "tabletop", "-n", "6", "--count", "100000", "--workers", "2", "-o", "out.txt"],
    ],
)
def test_an_interruption_ends_quickly_and_leaves_no_file(arguments: list[str], tmp_path: Path) -> None:
    with interruptible([*PRAG, *arguments], tmp_path) as process:
        until_it_works(process)
        err = interrupt(process)
    assert process.returncode == 130
    assert "interrupted" in err and "Traceback" not in err
    assert not [*tmp_path.iterdir()]
