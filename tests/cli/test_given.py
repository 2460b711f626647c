"""Constants, files and standard input on the command line."""

from __future__ import annotations

import io
import json
import subprocess
import sys
from pathlib import Path

import pytest

from prag_asp import TaskSpace, load_domain
from prag_asp.cli import cli
from prag_asp.program.paths import shipped_domains
from tests.cli.conftest import Told

HANOI = shipped_domains()["hanoi"] / "domain.lp"
LAMPS = "class(lamp).\n#const lamps = 2.\nentity(lamp(1..lamps), lamp).\nfluent(lit(L)) :- is_a(L,lamp).\n"
ACTIONS = (
    "action(press(L)) :- is_a(L,lamp).\nprecondition(press(L), lit(L), false) :- action(press(L)).\n"
    "postcondition(press(L), lit(L), true) :- action(press(L)).\n"
    "action(dim(L)) :- is_a(L,lamp).\nprecondition(dim(L), lit(L), true) :- action(dim(L)).\n"
    "postcondition(dim(L), lit(L), false) :- action(dim(L)).\n"
)


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    (tmp_path / "lamps.lp").write_text(LAMPS, encoding="utf-8")
    (tmp_path / "actions.lp").write_text(ACTIONS, encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    return tmp_path


def test_a_constant_is_set_on_every_command_that_takes_a_domain(told: Told) -> None:
    four = TaskSpace(load_domain("hanoi", constants={"discs": 4}), 3)
    constant = ("-c", "discs=4")
    assert told("count", "hanoi", "-n", "3", *constant) == f"{four.count()}\n"
    assert told("count", "hanoi", "-n", "9", "--const", "discs = 1") == "256\n"
    assert told("enumerate", "hanoi", "-n", "3", *constant).split("\n")[0] == str(four[0])
    assert told("check", "hanoi", *constant).startswith("hanoi (discs=4): ok; closed world, 7 entities")
    assert "the tasks of hanoi (discs=4) of length 2" in told("export", "hanoi", "-n", "2", *constant)
    assert told("explain", "hanoi", *constant) == "a plan of hanoi (discs=4)\n"
    assert "disc(4)" in told("task", "hanoi", "-n", "3", "--index", "0", *constant)
    assert "disc(4)" in told("stats", "hanoi", "-n", "15", *constant)
    assert told("split", "hanoi", "-n", "3", "all=1", *constant) == f"all  {four.count()}\n"


def test_a_constant_that_is_not_there_or_not_written_so_is_told(told: Told) -> None:
    assert told("count", "hanoi", "-n", "3", "-c", "dics=4", code=2) == (
        "constant dics: hanoi has no such #const; did you mean discs?\n"
    )
    for wrong in ("discs", "=4", ""):
        message = f"--const {wrong}: write NAME=VALUE, such as discs=4\n"
        assert told("count", "hanoi", "-n", "3", "-c", wrong, code=2) == message
    assert "'X' is not a term" in told("count", "hanoi", "-n", "3", "-c", "discs=X", code=2)


def test_tasks_of_a_file_are_checked_with_the_constants_they_name(
    told: Told, folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    told("new", "mine")
    logic = folder / "mine" / "domain.lp"
    text = logic.read_text(encoding="utf-8").replace("entity((cube_1; cube_2), cube).", "entity(cube(1..cubes), cube).")
    logic.write_text(f"#const cubes = 1.\n{text}", encoding="utf-8")
    settings = folder / "mine" / "domain.toml"
    settings.write_text(settings.read_text(encoding="utf-8").replace("cube_1 = 1\n", ""), encoding="utf-8")
    two = told("sample", "mine", "-n", "3", "--count", "3", "-c", "cubes=2", "--format", "jsonl", "--seed", "4")
    three = told("sample", "mine", "-n", "3", "--count", "2", "-c", "cubes=3", "--format", "jsonl")
    plain = told("sample", "mine", "-n", "2", "--count", "1", "--format", "jsonl")
    assert [json.loads(line)["constants"] for line in two.splitlines()] == [{"cubes": "2"}] * 3
    assert "constants" not in plain
    (folder / "tasks.jsonl").write_text(two + three + plain, encoding="utf-8")
    assert told("validate", "tasks.jsonl", "--witness-only").count("feasible") == 6
    assert told("validate", "tasks.jsonl", "--domain", "mine", "--witness-only").count("feasible") == 6
    (folder / "tasks.jsonl").write_text(two, encoding="utf-8")
    assert told("render", "tasks.jsonl", "1", "-o", "strip.png", "--size", "64x48") == "strip.png\n"
    (folder / "tasks.jsonl").write_text(two.replace('"cubes"', '"cube"'), encoding="utf-8")
    assert told("validate", "tasks.jsonl", code=2) == (
        "tasks.jsonl:1: constant cube: mine has no such #const; did you mean cubes?\n"
    )
    (folder / "tasks.jsonl").write_text(two, encoding="utf-8")
    assert cli.main(["validate", "tasks.jsonl", "--witness-only", "-c", "cubes=1"]) == 1
    assert "\tinvalid\t" in capsys.readouterr().out  # what the command line says goes before the file


def test_learned_rules_are_written_for_the_folder_as_it_is(told: Told, folder: Path) -> None:
    warehouse = Path(__file__).parents[2] / "examples" / "warehouse"
    logic, settings = warehouse / "domain.lp", str(warehouse / "domain.toml")
    arguments = ("-n", "2", "--count", "0")
    for more in (("--settings", settings), ()):
        message = told("learn", str(logic), *arguments, "--settings", settings, "--write", *more, code=2)
        assert message == "--write writes learned.lp into a domain's folder, but domain has none; give a folder\n"
    message = told("learn", str(warehouse), *arguments, "--settings", settings, "--write", code=2)
    assert message == "--write writes rules for the unchanged folder; leave --settings out\n"
    assert told("learn", str(logic), *arguments, "--settings", settings) == told(
        "learn", str(warehouse), *arguments
    ).replace("scene of warehouse", "scene of domain")
    assert not (warehouse / "learned.lp").exists()


def test_files_are_given_one_after_another(told: Told) -> None:
    counted = told("count", "lamps.lp", "actions.lp", "--length", "3")
    assert counted == f"{TaskSpace(load_domain(text=LAMPS + ACTIONS), 3).count()}\n"
    assert told("count", "--length", "3", "actions.lp", "lamps.lp") == counted
    assert told("check", "actions.lp", "lamps.lp", "-c", "lamps=1").startswith(
        "actions (lamps=1): ok; open world, 1 entity"
    )
    plan = "press(lamp(1)) dim(lamp(1))"
    assert told("explain", "lamps.lp", "actions.lp", plan) == "a plan of lamps\n"
    assert told("split", "lamps.lp", "actions.lp", "one=1/2", "two=1/2", "--length", "2").split()[::2] == ["one", "two"]
    rank = told("task", "lamps.lp", "actions.lp", "-n", "2", "--rank-of", plan)
    assert (
        told("task", "lamps.lp", "actions.lp", "-n", "2", "--index", rank.strip(), "--format", "text").strip() == plan
    )


def test_a_domain_may_come_from_standard_input(told: Told, monkeypatch: pytest.MonkeyPatch) -> None:
    def given(text: str) -> None:
        monkeypatch.setattr(sys, "stdin", io.TextIOWrapper(io.BytesIO(text.encode())))

    given(ACTIONS)
    assert told("count", "lamps.lp", "-", "-n", "2") == told("count", "lamps.lp", "actions.lp", "-n", "2")
    given(LAMPS + ACTIONS)
    assert told("explain", "-", "press(lamp(1))") == "a plan of stdin\n"
    given(LAMPS + ACTIONS + "spare(1).")
    assert told("count", "-", "-n", "2", "--strict", code=2).startswith("<stdin>:11: unknown predicate spare/1")


def test_standard_input_is_read_once_for_all_tasks_of_a_file(
    told: Told, folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    logic, settings = shipped_domains()["tabletop"] / "domain.lp", str(shipped_domains()["tabletop"] / "domain.toml")
    options = ("--settings", settings)
    monkeypatch.setattr(sys, "stdin", io.TextIOWrapper(io.BytesIO(logic.read_bytes())))
    lines = told("sample", "-", "-n", "2..3", "--count", "4", "--format", "jsonl", *options).splitlines()
    assert {json.loads(line)["domain"] for line in lines} == {"stdin"}
    (folder / "tasks.jsonl").write_text(
        "\n".join([*lines, lines[0].replace('"stdin"', '"other"'), lines[1]]), encoding="utf-8"
    )
    monkeypatch.setattr(sys, "stdin", io.TextIOWrapper(io.BytesIO(logic.read_bytes())))
    checked = told("validate", "tasks.jsonl", "--domain", "-", "--witness-only", *options)
    assert [line.split("\t")[1] for line in checked.splitlines()] == ["feasible"] * 6


def test_a_pipe_and_python_m_run_the_command(folder: Path) -> None:
    command = f"cat '{HANOI}' | {sys.executable} -m prag_asp count - --length 3 -c discs=1"
    done = subprocess.run(["sh", "-c", command], capture_output=True, text=True, check=False)
    assert (done.returncode, done.stdout, done.stderr) == (0, "4\n", "")


def test_words_that_are_no_domain_are_told(told: Told) -> None:
    assert told("count", "hanoi", "prag", "-n", "2", code=2) == (
        "hanoi prag: hanoi is not a file that ends in .lp; give one name or folder, or files alone\n"
    )
    assert "did you mean press?" in told("explain", "lamps.lp", "actions.lp", "pres", code=2)
    assert "Missing argument 'DOMAIN..." in told("count", "-n", "2", code=64)
    assert "no such domain" in told("split", "a=1", "b=1", "-n", "2", code=2)


def test_settings_beside_a_file_are_not_read_and_a_note_says_so(
    told: Told, folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (folder / "domain.lp").write_text(LAMPS + ACTIONS, encoding="utf-8")
    (folder / "domain.toml").write_text("[weights]\npress = 0\n", encoding="utf-8")
    sample = ("-n", "1", "--count", "20")
    assert "press" not in told("sample", ".", *sample)
    assert "press" not in told("sample", "domain.lp", *sample, "--settings", "domain.toml")
    assert cli.main(["sample", "domain.lp", *sample]) == 0
    out, err = capsys.readouterr()
    assert "press" in out
    assert err.startswith("note: domain.toml is not read with a file; give its folder, or --settings domain.toml\n")
