from __future__ import annotations

import io
import json
import sys
import time
from pathlib import Path

import pytest

from prag_asp.cli import terminal
from tests.commands import PRAG, ok, run
from tests.processes import gone, interrupt, interruptible, terminate
from tests.processes import workers as at_work


@pytest.fixture(scope="module")
def many(tmp_path_factory: pytest.TempPathFactory) -> str:
    """A file with 800 tasks, each twenty times: more than can be validated before a test interrupts it."""
    file = tmp_path_factory.mktemp("many") / "tasks.jsonl"
    arguments = ["sample", "tabletop", "-n", "4", "--no-physics", "--count", "800", "--format", "jsonl"]
    ok(*arguments, "-o", str(file))
    file.write_text(20 * file.read_text())
    return str(file)


def test_pass_rates_stand_beside_their_budget_and_above_the_causes(tmp_path: Path) -> None:
    file = tmp_path / "tasks.jsonl"
    text = ok("sample", "prag", "-n", "4", "--no-physics", "--count", "40", "--format", "jsonl", cwd=tmp_path)
    file.write_text(text)
    done = run("validate", str(file), "--budget", "1x1")
    statuses = [line.split("\t")[1] for line in done.stdout.splitlines()]
    passed = statuses.count("feasible")
    assert done.returncode == 1 and 10 < passed < 40 == len(statuses)
    first, *table = done.stderr.splitlines()
    assert first == f"40 tasks, {passed} passed ({100 * passed / 40:.1f} %, budget 1 x 1, kinematics)"
    rows = [[cell.strip() for cell in line.strip("│").split("│")] for line in table if line.startswith("│")]
    assert sum(int(tasks) for _, tasks, _ in rows) == 40 - passed == sum(int(attempts) for *_, attempts in rows)
    assert {cause for cause, *_ in rows} == {
        line.split("\t")[2] for line in done.stdout.splitlines() if "\tnot" in line
    }


def test_invalid_tasks_among_others_keep_their_places(tmp_path: Path) -> None:
    arguments = ["sample", "prag", "-n", "3", "--no-physics", "--count", "12", "--format", "jsonl"]
    tasks = [json.loads(line) for line in ok(*arguments).splitlines()]
    for place in (0, 3, 4, 11):
        tasks[place]["goal"] = {}
        tasks[place]["states"][0] = {}
    file = tmp_path / "tasks.jsonl"
    file.write_text("\n".join(map(json.dumps, tasks)))
    for more in ((), ("--workers", "2"), ("--witness-only",)):
        done = run("validate", str(file), *more)
        lines = done.stdout.splitlines()
        assert [number for number, line in enumerate(lines) if "\tinvalid\tits states" in line] == [0, 3, 4, 11]
        assert [line.split("\t")[0] for line in lines] == [str(number) for number in range(1, 13)]


def test_a_line_that_is_no_task_is_told_alone_however_many_were_checked_before(tmp_path: Path) -> None:
    file = tmp_path / "tasks.jsonl"
    task = ok("sample", "prag", "-n", "1", "--count", "1", "--no-physics", "--format", "jsonl", cwd=tmp_path)
    file.write_text(f"{task}{{\n")
    done = run("validate", str(file), "--budget", "1x1")
    assert (done.returncode, len(done.stdout.splitlines())) == (2, 1)
    assert done.stderr.startswith(f"{file}:2: not a task: it is not JSON") and done.stderr.count("\n") == 1


def test_a_file_of_a_domain_that_is_a_folder_is_checked_from_anywhere(tmp_path: Path) -> None:
    home, elsewhere = tmp_path / "home", tmp_path / "elsewhere"
    home.mkdir()
    elsewhere.mkdir()
    assert run("new", "mine", cwd=home).returncode == 0
    ok("sample", "mine", "-n", "2", "--count", "2", "--format", "jsonl", "-o", "tasks.jsonl", cwd=home)
    for cwd, file in ((home, "tasks.jsonl"), (elsewhere, str(home / "tasks.jsonl"))):
        assert ok("validate", file, "--witness-only", cwd=cwd) == "1\tfeasible\n2\tfeasible\n"
    moved = elsewhere / "tasks.jsonl"
    (home / "tasks.jsonl").rename(moved)
    done = run("validate", str(moved), cwd=elsewhere)
    assert done.returncode == 2 and "name it with --domain" in done.stderr and "mine" in done.stderr
    assert len(done.stderr.splitlines()) == 1
    assert ok("validate", str(moved), "--domain", str(home / "mine"), cwd=elsewhere).count("feasible") == 2


@pytest.mark.parametrize("drawn", [("--budget", "1x1"), ("--no-physics",)])
def test_a_verdict_does_not_depend_on_where_the_task_stands_nor_on_the_workers(
    tmp_path: Path, drawn: tuple[str, ...]
) -> None:
    tight = ("--seed", "3", "--budget", "1x1")
    lines = ok(
        *["sample", "tabletop", "-n", "4", "--count", "24", "--format", "jsonl", "--seed", "3"], *drawn
    ).splitlines()
    for name, listed in (("there", lines), ("back", lines[::-1])):
        (tmp_path / name).write_text("".join(f"{line}\n" for line in listed))
    there, back, together = (
        run("validate", name, *tight, *options, cwd=tmp_path).stdout.splitlines()
        for name, options in (("there", ()), ("back", ()), ("there", ("--workers", "2")))
    )
    told = [line.split("\t")[1:] for line in there]
    assert together == there and told == [line.split("\t")[1:] for line in back][::-1]
    passed = sum(status == "feasible" for status, *_ in told)
    assert 5 < passed < 24 if drawn == ("--no-physics",) else passed == 24


def test_an_interrupted_validation_keeps_its_lines_and_says_how_far_it_came(tmp_path: Path, many: str) -> None:
    with interruptible([*PRAG, "validate", many, "--workers", "2"], tmp_path) as process:
        assert process.stdout is not None
        first = process.stdout.readline()
        time.sleep(1)
        err = interrupt(process)
    assert first == "1\tfeasible\n"
    assert process.returncode == 130
    assert "interrupted" in err and "budget 10 x 10" in err and "Traceback" not in err


@pytest.mark.parametrize("delay", [0.0, 0.2])
def test_workers_that_are_just_being_started_leave_an_interruption_to_their_parent(
    tmp_path: Path, many: str, delay: float
) -> None:
    with interruptible([*PRAG, "validate", many, "--workers", "2"], tmp_path) as process:
        until = time.monotonic() + 300
        while len(at_work(process.pid)) < 2 and time.monotonic() < until:
            time.sleep(0.01)
        time.sleep(delay)
        err = interrupt(process)
    assert process.returncode == 130
    assert "interrupted" in err and "Traceback" not in err


@pytest.mark.parametrize("workers", ["1", "2"])
def test_a_validation_that_is_told_to_end_ends_as_an_interrupted_one_and_its_workers_with_it(
    tmp_path: Path, many: str, workers: str
) -> None:
    with interruptible([*PRAG, "validate", many, "--workers", workers], tmp_path) as process:
        assert process.stdout is not None
        assert process.stdout.readline() == "1\tfeasible\n"
        helpers = at_work(process.pid)
        err = terminate(process)
    assert process.returncode == 143
    assert err.startswith(tuple("123456789")) and "budget 10 x 10" in err and err.endswith("terminated\n")
    assert len(helpers) == (2 if workers == "2" else 0)
    assert gone(helpers)


def test_a_sample_that_is_terminated_has_printed_whole_lines_and_prints_its_tally() -> None:
    command = [*PRAG, "sample", "tabletop", "-n", "4", "--count", "100000", "--format", "jsonl"]
    with interruptible(command, Path()) as process:
        assert process.stdout is not None
        assert json.loads(process.stdout.readline())["witness"]
        err = terminate(process)
    assert process.returncode == 143 and err.endswith("terminated\n")
    assert int(err.split(" sampled, ")[1].split()[0]) >= 1


class _Screen(io.StringIO):
    def isatty(self) -> bool:
        return True


def _shown(monkeypatch: pytest.MonkeyPatch, patience: float) -> str:
    screen = _Screen()
    monkeypatch.setattr(sys, "stderr", screen)
    monkeypatch.setattr(terminal, "PATIENCE", patience)
    monkeypatch.setenv("COLUMNS", "100")
    monkeypatch.setenv("TERM", "xterm")
    with terminal.progress() as tell:
        tell("[exploring] 7 states")
        tell("30 tasks, 20 passed", 30, 40)
    return screen.getvalue()


def test_what_takes_long_shows_how_far_it_is(monkeypatch: pytest.MonkeyPatch) -> None:
    shown = _shown(monkeypatch, -1.0)
    assert "[exploring] 7 states" in shown and "30 tasks, 20 passed" in shown and "━━━━" in shown
    assert _shown(monkeypatch, 1000.0) == ""
