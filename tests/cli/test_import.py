"""Files of PDDL on the command line: imported, and in place of a domain."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest

from prag_asp import load_domain
from prag_asp.pddl.syntax import parsing
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
            "factor 1/3: to the power of 2 it has no end as a dec",
        ),
        (["import", *reversed(FILES), "-o", "new"], "this is a problem, and a domain is needed here"),
        (["count", FILES[0], "-n", "1"], "one file of PDDL; give a domain, then its problem: DOMAIN.pddl PROBLEM.pddl"),
    ],
)
def test_what_cannot_be_imported_is_one_line(arguments: list[str], told: str, tmp_path: Path) -> None:
    (tmp_path / "there").mkdir()
    done = run(*arguments, cwd=tmp_path)
    assert done.returncode == 2 and told in done.stderr and done.stderr.count("\n") == 1
    assert not (tmp_path / "new").exists()


def test_without_the_package_it_is_said_how_to_get_it(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "pddl.parser", None)
    parsing._grammar.cache_clear()
    done = run("count", *FILES, "-n", "1", cwd=tmp_path)
    assert done.stderr == 'PDDL needs the package pddl; install it: pip install "prag_asp[pddl]"\n'


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
    done = run("export", "pddl", "prag", "-o", "open", cwd=tmp_path)
    assert done.returncode == 2 and "its world is open" in done.stderr and not (tmp_path / "open").exists()
