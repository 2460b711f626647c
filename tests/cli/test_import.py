"""Files of PDDL on the command line: imported, and in place of a domain."""

from __future__ import annotations

import io
import json
import sys
from pathlib import Path

import pytest

from prag_asp import TaskSpace, load_domain
from tests.commands import run
from tests.pddl.forward import Search

EXAMPLE = Path(__file__).parents[2] / "examples" / "pddl"
FILES = (str(EXAMPLE / "domain.pddl"), str(EXAMPLE / "problem.pddl"))


def test_an_import_is_a_domain_with_the_same_plans(tmp_path: Path) -> None:
    done = run("import", *FILES, "-o", "new", "--cost-factor", "1/2", cwd=tmp_path)
    assert done.returncode == 0
    assert done.stderr == "costs of 28 actions became weights\nwrote new; try: prag-asp check new\n"
    loaded = load_domain(tmp_path / "new")
    weights = loaded.settings.weights
    assert (weights["go(hall,office)"], weights["pick_up(p1,hall,left)"], loaded.warnings) == (1 / 4, 1 / 2, ())
    counts = Search(*(Path(file).read_text() for file in FILES)).count(8)
    for given in (["new"], FILES):
        found = run("count", *given, "-n", "0..8", "--by", "plan", cwd=tmp_path)
        assert [int(line.split()[1]) for line in found.stdout.splitlines()[1:]] == counts


def test_one_file_with_domain_and_problem_is_imported(tmp_path: Path) -> None:
    (tmp_path / "both.pddl").write_text("".join(Path(file).read_text() for file in FILES))
    done = run("import", "both.pddl", "-o", "new", cwd=tmp_path)
    assert (done.returncode, done.stderr) == (0, "wrote new; try: prag-asp check new\n")
    counts = [run("count", *given, "-n", "7..9", cwd=tmp_path).stdout for given in (["new"], FILES)]
    assert counts[0] == counts[1] != ""


@pytest.mark.parametrize(
    ("arguments", "told"),
    [
        (["import", *FILES, "-o", "there"], "there: exists already; choose another name, or remove it first\n"),
        (
            ["import", *FILES, "-o", "new", "--cost-factor", "2"],
            "factor 2: write a number above 0 and at most 1, such as",
        ),
        (
            ["import", *FILES, "-o", "new", "--cost-factor", "1/3"],
            "factor 1/3: its power 2 has no finite decimal expansion",
        ),
        (["import", *reversed(FILES), "-o", "new"], "this is a problem, but a domain is needed"),
        (["count", FILES[0], "-n", "1"], "one file of PDDL; give a domain, then its problem: DOMAIN.pddl PROBLEM.pddl"),
    ],
)
def test_what_cannot_be_imported_is_one_line(arguments: list[str], told: str, tmp_path: Path) -> None:
    (tmp_path / "there").mkdir()
    done = run(*arguments, cwd=tmp_path)
    assert done.returncode == (4 if "exists" in told else 2)
    assert told in done.stderr and done.stderr.count("\n") == 1
    assert not (tmp_path / "new").exists()


def test_a_domain_and_a_task_are_exported_as_pddl(tmp_path: Path) -> None:
    assert run("export", "pddl", "blocks", "-o", "out", cwd=tmp_path).stdout == "out\n"
    files = ("out/domain.pddl", "out/problem.pddl")
    counts = [run("count", *given, "-n", "3", "--by", "plan", cwd=tmp_path).stdout for given in (["blocks"], files)]
    assert counts == ["52\n", "52\n"]
    plan = "pick_up(a) stack(a,b)"
    assert run("export", "pddl", "blocks", "--plan", plan, "--positive", "-o", "task", cwd=tmp_path).returncode == 0
    assert (tmp_path / "task" / "plan.txt").read_text().splitlines()[0] == "(pick_up a)"
    assert "(not (" not in (tmp_path / "task" / "problem.pddl").read_text()
    task = ("task/domain.pddl", "task/problem.pddl")
    assert run("count", *task, "-n", "2", "--by", "plan", cwd=tmp_path).stdout == "1\n"
    done = run("export", "pddl", "blocks", "-o", "out", cwd=tmp_path)
    assert done.stderr == "out: exists already; choose another name, or remove it first\n"
    for given, word in (((), "(when "), (("--unconditional",), "-2\n")):
        asked = ("blocks", "--rule", "at_most(stack,1)", *given, "-o", f"once{len(given)}")
        assert run("export", "pddl", *asked, cwd=tmp_path).returncode == 0
        assert word in (tmp_path / asked[-1] / "domain.pddl").read_text()
    done = run("export", "pddl", "prag", "-o", "open", cwd=tmp_path)
    assert (
        done.returncode == 2
        and "add --rule closed_world, state one" in done.stderr
        and not (tmp_path / "open").exists()
    )


def test_tasks_are_exported_by_rank_and_from_files(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    given = ("export", "pddl", "blocks")
    assert run(*given, "-n", "4", "--index", "3..5", "-o", "ranks", cwd=tmp_path).stdout == "ranks\n"
    assert run(*given, "-n", "4", "--index", "4", "-o", "one", cwd=tmp_path).returncode == 0
    plans = [(tmp_path / "ranks" / f"plan_{rank}.txt").read_text().splitlines() for rank in (3, 4, 5)]
    tasks = TaskSpace(load_domain("blocks"), 4)[3:6]
    told = [[f"({action.name} {' '.join(action.arguments)})" for action in task.actions] for task in tasks]
    assert plans == told
    for kind in ("domain", "problem"):
        assert (tmp_path / "one" / f"{kind}.pddl").read_text() == (tmp_path / "ranks" / f"{kind}_4.pddl").read_text()
    run("sample", "blocks", "-n", "3", "--count", "2", "--seed", "1", "--format", "jsonl", "-o", "t", cwd=tmp_path)
    assert run(*given, "--tasks", "t", "-o", "file", "--positive", cwd=tmp_path).returncode == 0
    monkeypatch.setattr(sys, "stdin", io.StringIO((tmp_path / "t").read_text()))
    assert run(*given, "--tasks", "-", "-o", "same", "--positive", cwd=tmp_path).stdout == "same\n"
    for number in (1, 2):
        texts = [(tmp_path / "file" / f"{kind}_{number}.pddl").read_text() for kind in ("domain", "problem")]
        search = Search(*texts)
        state = search.start
        for step in (tmp_path / "file" / f"plan_{number}.txt").read_text().splitlines():
            state = dict(search.after(state))[tuple(step.strip("()").split())]
        assert search.holds(search.goal, state, {})
        assert texts[1] == (tmp_path / "same" / f"problem_{number}.pddl").read_text()


@pytest.mark.parametrize(
    ("arguments", "told"),
    [
        (["--index", "3"], "--length and --index go together: the rank of a task of length N; give both"),
        (["-n", "3"], "--length and --index go together"),
        (["-n", "3", "--index", "x"], "--index x: write a rank from 0, such as 7, or A..B for all from A to B"),
        (["-n", "3", "--index", "5..3"], "--index 5..3: the first is above the last; write 3..5"),
        (["-n", "3", "--index", "0..9000000"], "--index 0..9000000: more than 1,000,000 tasks; export fewer at once"),
        (["-n", "3", "--index", "999"], "--index 999: the space has 4 tasks, ranked from 0"),
        (
            ["-n", "3", "--index", "1", "--plan", "pick_up(a)"],
            "--plan and --index both select tasks; leave one of them",
        ),
        (["--where", "loop-free"], "--where is for tasks; select some with --plan, --index or --tasks"),
        (["--tasks", "other"], "other:1: the file says that it is of 'hanoi', but it is read as one of 'blocks'"),
        (["--tasks", "wrong"], "wrong:1: no task of blocks of length 1: put_down(a); see prag-asp explain"),
        (["--tasks", "empty"], "empty: no task; write some with prag-asp sample --format jsonl"),
        (["--tasks", "missing"], "missing: "),
    ],
)
def test_tasks_that_are_none_are_refused_in_one_line(arguments: list[str], told: str, tmp_path: Path) -> None:
    for name, domain, plan in (("other", "hanoi", ["move(d1,p1,p2)"]), ("wrong", "blocks", ["put_down(a)"])):
        line = {"domain": domain, "actions": plan, "entities": {}, "initial": {}, "goal": {}}
        (tmp_path / name).write_text(json.dumps({**line, "subgoals": [{}], "states": [{}]}))
    (tmp_path / "empty").write_text("")
    done = run("export", "pddl", "blocks", *arguments, "-o", "new", cwd=tmp_path)
    assert done.returncode == (4 if "exists" in told else 2)
    assert told in done.stderr and done.stderr.count("\n") == 1
    assert not list(tmp_path.glob("new*"))
