"""Audits of suites written for this test, and of LIBERO where its files are there."""

from __future__ import annotations

import json
import os
import re
from importlib.util import find_spec
from pathlib import Path

import pytest

from prag_asp import QueryError
from prag_asp.audit import BenchmarkAudit, audit
from prag_asp.audit.audit_report import audit_text
from tests.bddl.problems import CAMP, TIDY
from tests.commands import run
from tests.docs.pages import DOCS

STACK = """(define (problem {name}) (:domain robosuite)
  (:language {language})
  (:fixtures table_1 - table stove_1 - stove)
  (:objects mug_1 mug_2 - mug plate_1 - plate bowl_1 - bowl)
  (:regions (left_region (:target table_1) (:ranges ((0 0 0.1 0.1)))) (cook_region (:target stove_1)))
  (:init (on mug_1 table_1_left_region) (on mug_2 {second}) (on plate_1 table_1) (on bowl_1 table_1) {more})
  (:goal {goal}))
"""


def problem(
    goal: str,
    *,
    language: str = "put the mug on the plate",
    second: str = "plate_1",
    more: str = "(on stove_1 table_1)",
) -> str:
    return STACK.format(name="p", goal=goal, language=language, second=second, more=more)


def write(folder: Path, **texts: str) -> Path:
    folder.mkdir(parents=True)
    for name, text in texts.items():
        (folder / f"{name}.bddl").write_text(text)
    return folder


@pytest.fixture(scope="module")
def suites(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("suites")
    write(
        folder / "train",
        first=problem("(and (on mug_1 plate_1))"),
        other_number=problem("(and (on mug_2 plate_1))", second="table_1"),
        on_stove=problem("(and (turnon stove_1) (on bowl_1 stove_1_cook_region))", language="heat the bowl"),
    )
    write(
        folder / "test",
        same=problem("(on mug_1 plate_1)", second="bowl_1"),
        every=problem("(forall (?x - plate) (exists (?y - bowl) (on ?y ?x)))", language="serve the bowl"),
        both=problem("(and (on mug_1 plate_1) (on bowl_1 plate_1))", second="bowl_1"),
    )
    return folder


@pytest.fixture(scope="module")
def result(suites: Path) -> BenchmarkAudit:
    return audit(suites / "train", suites / "test", train=["train"])


def test_goals_and_starts_are_counted_up_to_renaming(result: BenchmarkAudit) -> None:
    assert [(each.suite, each.problems, each.goals, each.tasks) for each in (*result.suites, result.total)] == [
        ("train", 3, 2, 3),
        ("test", 3, 3, 3),
        ("all", 6, 4, 6),
    ]
    assert result.same == (("train/first", "train/other_number", "test/same"),)
    assert [(each.test, each.goals, each.tasks) for each in result.overlaps] == [("train", 2, 0), ("test", 1, 0)]


def test_each_test_problem_has_its_nearest_training_problem(result: BenchmarkAudit) -> None:
    nearest = {each.problem: (each.nearest, each.distance, each.same_start) for each in result.nearest}
    assert nearest == {
        "test/same": ("train/first", 0, False),
        "test/every": ("train/first", 2, False),
        "test/both": ("train/first", 1, False),
    }


def test_combinations_have_an_exact_denominator(result: BenchmarkAudit) -> None:
    found = result.combinations
    assert found.classes == ("bowl", "mug")
    assert found.targets == ("on cook_region of stove", "on plate")
    assert found.occurring == {("bowl", "on cook_region of stove"), ("bowl", "on plate"), ("mug", "on plate")}
    assert found.possible == len(found.present) == 4
    assert found.reachable == found.present
    assert result.findings == ()


def test_the_same_start_is_recognized_under_other_numbers(tmp_path: Path) -> None:
    swapped = problem("(and (on mug_1 plate_1))").replace("mug_1", "mug_x").replace("mug_2", "mug_1")
    write(tmp_path / "one", a=problem("(and (on mug_1 plate_1))"))
    write(tmp_path / "two", b=swapped.replace("mug_x", "mug_2"))
    found = audit(tmp_path / "one", tmp_path / "two", reach=False)
    assert [(each.nearest, each.distance, each.same_start) for each in found.nearest] == [
        ("two/b", 0, True),
        ("one/a", 0, True),
    ]
    assert found.combinations.reachable is None


@pytest.mark.parametrize(
    ("kind", "text", "message"),
    [
        ("unreadable", "(define (problem p)", "p.bddl:1: the file ends while 1 '.' is open"),
        ("unreadable", problem("(on cup_1 plate_1)"), "cup_1 is not an object, fixture or region"),
        ("remark", problem("(on mug_1 plate_1)").replace("(:init", "(:lens a)\n(:init"), "p.bddl:6: .:lens .... is n"),
        ("contradictory-start", problem("(on mug_1 plate_1)", more="(on mug_1 bowl_1)"), "mug_1 is at 2 places"),
        ("contradictory-start", problem("(on mug_1 plate_1)", more="(not (on mug_2 plate_1))"), "and its negation"),
        ("contradictory-start", problem("(on mug_1 plate_1)", second="mug_2"), "mug_2 is on mug_2"),
        ("true-at-start", problem("(on mug_2 plate_1)"), "the goal is true in the initial state"),
        ("unreachable-goal", problem("(and (on mug_1 plate_1) (on mug_1 bowl_1))"), "mug_1 is at 2 places in the goal"),
        ("unreachable-goal", problem("(and (on stove_1 plate_1) (on mug_1 plate_1))"), ""),
        ("unreachable-goal", problem("(and (on mug_1 bowl_1) (not (on mug_1 bowl_1)))"), "the goal has both "),
        ("unchecked-goal", problem("(on mug_1 bowl_1)", more="(on mug_1 plate_1)"), "the invariants forbid it"),
        ("silent-language", problem("(on mug_1 plate_1)", language="wipe the window"), "names none of .*: mug, plate"),
        ("unused-object", problem("(on mug_1 plate_1)").replace("bowl_1 -", "bowl_1 bowl_2 -"), "bowl_2 is in no fact"),
    ],
)  # fmt: skip
def test_a_mistake_is_found(kind: str, text: str, message: str, tmp_path: Path) -> None:
    found = audit(write(tmp_path / "suite", p=text)).findings
    assert kind in {each.kind for each in found}
    assert any(re.search(message, str(each)) for each in found)


def test_a_problem_of_very_many_objects_does_not_stop_an_audit(tmp_path: Path) -> None:
    mugs = " ".join(f"mug_{number}" for number in range(3, 300))
    many = problem("(on mug_1 plate_1)").replace("mug_1 mug_2 -", f"mug_1 mug_2 {mugs} -")
    write(tmp_path / "suite", many=many, few=problem("(on mug_1 plate_1)"))
    found = audit(tmp_path / "suite")
    (finding,) = [each for each in found.findings if each.kind == "unchecked-goal"]
    assert finding.place.endswith("many.bddl:1") and "301 objects that can be moved" in finding.text
    assert any("of these, known to be reachable by actions" in line for line in audit_text(found))
    assert found.combinations.reachable


def test_goals_that_are_too_alike_are_refused_by_name(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("prag_asp.audit.goal_distance.MOST_STEPS", 5)
    chain = problem("(and (on mug_1 mug_2) (on mug_2 plate_1) (on bowl_1 mug_1))")
    write(tmp_path / "one", p=chain)
    write(tmp_path / "two", p=chain.replace("(on mug_2 plate_1) (on", "(on mug_1 plate_1) (on"))
    with pytest.raises(QueryError, match="one/p and two/p: goals of 3 and 3 facts have too many renamings"):
        audit(tmp_path / "one", tmp_path / "two", reach=False)


def test_the_command_prints_a_table_json_and_a_page(suites: Path) -> None:
    done = run("audit", "train", "test", "--train", "train", "--full", "-o", "report.html", cwd=suites)
    assert done.returncode == 0
    assert "  all        6     6      4                          6" in done.stdout
    assert "2 classes and 2 targets; 75.0 % of the pairs are in some goal." in done.stdout
    page = (suites / "report.html").read_text()
    assert '<td class="left">test/both</td><td class="left">train/first</td><td>1</td>' in page
    assert "://" not in page
    values = json.loads(run("audit", "train", "test", "--no-reach", "--format", "json", cwd=suites).stdout)
    assert values["total"] == {"suite": "all", "files": 6, "problems": 6, "goals": 4, "tasks": 6}
    assert values["combinations"]["reachable"] is None


def test_mistakes_end_the_command_with_code_1(tmp_path: Path) -> None:
    write(tmp_path / "suite", p=problem("(on mug_2 plate_1)"))
    done = run("audit", "suite", "--no-reach", cwd=tmp_path)
    assert done.returncode == 1
    assert "true-at-start" in done.stdout


def test_a_folder_without_problems_and_an_unknown_suite_are_refused(tmp_path: Path) -> None:
    (tmp_path / "empty").mkdir()
    with pytest.raises(QueryError, match="no problems in this folder"):
        audit(tmp_path / "empty")
    with pytest.raises(QueryError, match="no such folder"):
        audit(tmp_path / "missing")
    (tmp_path / "one.bddl").write_text(TIDY)
    with pytest.raises(QueryError, match=r"one\.bddl: a file, but audits are of folders; give "):
        audit(tmp_path / "one.bddl")
    with pytest.raises(QueryError, match="no suite 'tarin'"):
        audit(write(tmp_path / "train", a=TIDY), train=["tarin"])


def test_problems_of_behavior_are_audited(tmp_path: Path) -> None:
    dialect = "; the predicates\n(define (domain omnigibson) (:predicates (cooked ?x)))"
    write(tmp_path / "camps", a=CAMP, b=CAMP.replace("bottle.n.01_1", "bottle.n.01_3"), dialect=dialect)
    found = audit(tmp_path / "camps")
    assert (found.total.goals, found.total.tasks, found.findings) == (1, 1, ())


def libero() -> Path | None:
    """Return the folder of the suites of LIBERO: that of the environment, or that of the installed package."""
    if "LIBERO_BDDL" in os.environ:
        return Path(os.environ["LIBERO_BDDL"])
    spec = find_spec("libero")
    homes = map(Path, spec.submodule_search_locations or ()) if spec else ()
    return next((folder for home in homes for folder in home.rglob("bddl_files")), None)


@pytest.mark.skipif(libero() is None, reason="LIBERO is not installed, and LIBERO_BDDL names no folder of its suites")
def test_the_figures_of_libero_come_out() -> None:
    folder = libero()
    assert folder is not None
    names = ("libero_10", "libero_90", "libero_goal", "libero_object", "libero_spatial")
    found = audit(*(folder / name for name in names), train=["libero_90"])
    assert (found.total.files, found.total.problems, found.total.goals, found.total.tasks) == (130, 130, 83, 130)
    assert {each.suite: each.goals for each in found.suites}["libero_spatial"] == 1
    in_90 = {each.test: each.goals for each in found.overlaps if each.train == "libero_90"}
    assert in_90 == {"libero_10": 2, "libero_goal": 5, "libero_object": 7, "libero_spatial": 10}
    assert (len(found.combinations.occurring), found.combinations.possible) == (60, 550)
    assert found.findings == ()
    page = (DOCS / "guides" / "audit.md").read_text(encoding="utf-8")
    _, shown, _ = re.split(r"(?m)^```(?:text)?\n", page, maxsplit=2)
    assert shown.splitlines()[1:] == [*audit_text(found)]
