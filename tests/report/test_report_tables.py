"""The tables of a report are right: exact counts, shares and expected frequencies agree with lists of whole spaces."""

from __future__ import annotations

import csv
import sys
from collections import Counter
from fractions import Fraction
from io import StringIO
from pathlib import Path

import pytest

from prag_asp import QueryError, TaskSpace, load_domain
from prag_asp.dataset import Record, write_line
from prag_asp.errors import LearningMissingError
from prag_asp.report import PhysicsOutcome, ReportSource, ReportTable, read_source, report_plots, report_tables
from prag_asp.report.outcome_tables import physics_tables
from prag_asp.report.report_table import csv_text, natural_order, shown_value
from prag_asp.report.task_tables import chosen_tasks, difficulty_tables


@pytest.fixture(scope="module")
def tables(source: ReportSource) -> dict[str, ReportTable]:
    return {table.name: table for table in report_tables(source, sample=20, seed=3)}


def test_counts_are_those_of_the_domain_and_the_published_one_stands_beside_the_exact_one(
    tables: dict[str, ReportTable],
) -> None:
    rows = tables["counts"].records()
    assert [row["plans"] for row in rows[:3]] == [48, 356, 2800]
    assert [row["tasks"] for row in rows[:3]] == [36, 265, 2092]
    assert [row["skeletons"] for row in rows[:3]] == [8, 30, 124]
    assert [row["given tasks"] for row in rows[:4]] == [0, 20, 20, 0]
    (last,) = [row for row in rows if row["published"] is not None]
    assert (last["length"], last["8^n"], last["published"]) == (15, 8**15, 190_000_000)
    assert last["skeletons that begin with approach"] == 191_264_896


def test_coverage_has_exact_denominators(source: ReportSource, tables: dict[str, ReportTable]) -> None:
    rows = {row["of"]: row for row in tables["coverage"].records()}
    assert rows["tasks of length 2"]["exact share"] == str(Fraction(20, 265))
    assert (rows["all tasks"]["given"], rows["all tasks"]["in the space"]) == (40, 265 + 2092)
    own = [task for task in source.tasks if len(task.plan) == 3]
    skeletons = {tuple(action.partition("(")[0] for action in task.plan) for task in own}
    assert (rows["skeletons of length 3"]["given"], rows["skeletons of length 3"]["in the space"]) == (
        len(skeletons),
        124,
    )
    parts = [rows[f"part {part}"] for part in ("train", "test")]
    assert [row["given"] for row in parts] == [32, 8] and sum(int(row["in the space"] or 0) for row in parts) == 2357


def test_expected_frequencies_are_the_means_over_a_list_of_the_whole_space(tables: dict[str, ReportTable]) -> None:
    listed = list(TaskSpace(load_domain("prag"), 2))
    means = Counter(action.name for task in listed for action in task.actions)
    rows = [row for row in tables["frequencies"].records() if row["length"] == 2 and row["feature"] == "names"]
    assert {row["value"]: Fraction(str(row["exact expected"])) for row in rows} == {
        name: Fraction(20 * number, len(listed)) for name, number in means.items()
    }
    assert sum(int(row["given"] or 0) for row in rows) == 40
    assert {row["feature"] for row in tables["frequency_tests"].records()} == {"names", "classes", "actions"}


def test_pass_rates_have_wilsons_intervals_and_efforts_add_up() -> None:
    outcomes = [
        PhysicsOutcome("", 2, "feasible", "3 x 3, kinematics", 1 + place % 2, "", {"x": 2}) for place in range(15)
    ]
    outcomes += [PhysicsOutcome("", 2, "not_found", "3 x 3, kinematics", 3, "x", {"x": 1}) for _ in range(133)]
    outcomes += [PhysicsOutcome("", 2, "trivial")]
    tables = {table.name: table for table in physics_tables(outcomes)}
    (row,) = tables["pass_rates"].records()
    assert (row["sampled"], row["trivial"], row["feasible"], row["not found"]) == (149, 1, 15, 133)
    assert (row["rate"], row["low"], row["high"]) == pytest.approx((15 / 148, 0.0624, 0.1605), abs=1e-4)
    efforts = tables["effort"].records()
    assert [(each["initial states"], each["feasible"], each["checked"]) for each in efforts] == [
        (1, 8, 148), (2, 15, 148), (3, 15, 148),
    ]  # fmt: skip
    assert tables["causes"].rows == (("x", 2, 30 + 133),)
    assert ("not found", "x", 2, 133) in tables["reasons"].rows
    assert list(physics_tables([])) == []


def test_pairs_and_map_are_of_a_sample_that_the_note_names(tables: dict[str, ReportTable]) -> None:
    assert sum(int(count or 0) for count in tables["distances"].column("pairs")) == 20 * 19 // 2
    assert "20 of 40 tasks, sampled uniformly with seed 3" in tables["distances"].note
    assert len(tables["map"].rows) == 20 and "of the variance" in tables["map"].note
    shortest = tables["difficulty"].records()
    assert all(int(row["shortest plan"] or 0) + int(row["detour"] or 0) == row["length"] for row in shortest)


def test_a_sample_is_uniform_in_order_and_repeatable(source: ReportSource) -> None:
    some = chosen_tasks(source.tasks, 10, 4)
    numbers = [task.number for task in some]
    assert numbers == sorted(set(numbers)) and len(numbers) == 10 and some == chosen_tasks(source.tasks, 10, 4)
    assert chosen_tasks(source.tasks, 40, 4) == list(source.tasks)


def test_every_figure_has_a_table_and_logarithms_of_counts(tables: dict[str, ReportTable]) -> None:
    plots = {plot.name: plot for plot in report_plots(tuple(tables.values()))}
    assert {plot.table for plot in plots.values()} <= set(tables)
    counts = {series.name: series for series in plots["counts"].series}
    assert counts["8^n"].heights[:2] == pytest.approx((0.90309, 1.80618), abs=1e-5)
    assert counts["published"].places == (15.0,)
    given, expected = plots["frequencies_names"].series
    assert sum(given.heights) == 100 and sum(expected.heights) == pytest.approx(100)
    assert [sum(plots[name].series[0].heights) for name in ("lengths", "entities")] == [40, 40]


def test_a_file_of_tasks_gives_the_same_tables_as_the_dataset(
    folder: Path, source: ReportSource, tables: dict[str, ReportTable], tmp_path: Path
) -> None:
    file = tmp_path / "tasks.jsonl"
    lines = [write_line(Record(task.task)) for task in source.tasks if task.task is not None]
    file.write_text("".join(f"{line}\n" for line in lines), encoding="utf-8")
    other = {table.name: table for table in report_tables(read_source(file), sample=20, seed=3)}
    for name in ("counts", "frequencies", "distances"):
        assert other[name] == tables[name]
    twice = tmp_path / "twice.jsonl"
    twice.write_text("".join(f"{line}\n" for line in (lines[0], *lines)), encoding="utf-8")
    rows = {row["of"]: row["given"] for row in report_tables(read_source(twice), sample=2)[1].records()}
    assert rows["all tasks"] == 40


def test_csv_reads_back_and_values_are_written_for_readers() -> None:
    table = ReportTable("t", "t", ("a", "b"), (('x,"y"\n', 10**40), (None, 0.1)))
    assert list(csv.reader(StringIO(csv_text(table), newline=""))) == [
        ["a", "b"],
        ['x,"y"\n', str(10**40)],
        ["", "0.1"],
    ]
    assert [shown_value(value) for value in (None, 1234567, 10**40, 0.123456)] == [
        "",
        "1,234,567",
        "41 digits",
        "0.1235",
    ]
    assert sorted(["cube_10", "cube_2", "a"], key=natural_order) == ["a", "cube_2", "cube_10"]


@pytest.mark.parametrize(
    ("content", "message"),
    [
        ("", r"t.jsonl: has no task"),
        ('{"domain": "prag", "act', r"t.jsonl:1: not a task"),
        ("[]\n", r"t.jsonl:1: not a task"),
    ],
)
def test_a_file_without_tasks_or_with_a_broken_line_is_named(tmp_path: Path, content: str, message: str) -> None:
    (tmp_path / "t.jsonl").write_text(content)
    with pytest.raises(QueryError, match=message):
        read_source(tmp_path / "t.jsonl")


def test_without_gymnasium_an_evaluation_says_what_to_install(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "evaluation.json").write_text("{}", encoding="utf-8")
    for name in [each for each in sys.modules if each == "gymnasium" or each.startswith("prag_asp.evaluation")]:
        monkeypatch.delitem(sys.modules, name)
    monkeypatch.setitem(sys.modules, "gymnasium", None)
    with pytest.raises(LearningMissingError, match="environments need Gymnasium"):
        read_source(tmp_path)


def test_states_that_are_too_many_to_be_listed_leave_a_note(
    source: ReportSource, monkeypatch: pytest.MonkeyPatch
) -> None:
    def refuse(*arguments: object) -> None:
        raise QueryError("the states are too many to be listed")

    monkeypatch.setattr("prag_asp.report.task_tables.ComplexityMeasure.of", refuse)
    (table,) = difficulty_tables(source)
    assert (table.rows, table.note) == ((), "the states are too many to be listed")


def test_sources_that_are_none_or_too_many_are_named(folder: Path, source: ReportSource, tmp_path: Path) -> None:
    (tmp_path / "empty").mkdir()
    with pytest.raises(QueryError, match=r"empty: is neither a dataset nor an evaluation"):
        read_source(tmp_path / "empty")
    with pytest.raises(QueryError, match="no such file or folder"):
        read_source(tmp_path / "missing")
    with pytest.raises(QueryError, match="both have tasks"):
        read_source(folder, folder)
    with pytest.raises(QueryError, match="needs a dataset"):
        read_source()
    task = source.tasks[0].task
    assert task is not None
    line = write_line(Record(task)).replace('"domain":"prag"', '"domain":"nowhere"')
    (tmp_path / "t.jsonl").write_text(line + "\n")
    with pytest.raises(QueryError, match=r"t.jsonl:1: a task of 'nowhere'; no such domain"):
        read_source(tmp_path / "t.jsonl")
