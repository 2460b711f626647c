"""Feasible tasks and rechecked files for users of Python: lazily, counted, and as the command has them."""

from __future__ import annotations

from itertools import islice
from pathlib import Path

import pytest

from prag_asp import Domain, OutputError, QueryError, SceneError, TaskSpace, load_domain, load_scene
from prag_asp.dataset import Record, Tally, feasible, read_tasks, recheck, write_line
from prag_asp.physics import Budget, Demonstration, Witness, check_witness


@pytest.fixture(scope="module")
def records(tabletop: Domain) -> list[Record]:
    return list(islice(feasible(TaskSpace(tabletop, 2), seed=3), 4))


@pytest.fixture
def file(records: list[Record], tmp_path: Path) -> Path:
    path = tmp_path / "tasks.jsonl"
    path.write_text("".join(f"{write_line(record)}\n" for record in records), encoding="utf-8")
    return path


def test_feasible_tasks_are_those_of_the_draw_that_pass_in_its_order(tabletop: Domain, records: list[Record]) -> None:
    drawn = iter(TaskSpace(tabletop, 2).stream(seed=3))
    for record in records:
        assert any(task == record.task for task in drawn)
        assert record.verdict is not None and record.verdict["status"] == "feasible"
        assert check_witness(record.task, Witness.from_json(record.witness or {}), load_scene(tabletop)) == []


def test_draws_are_made_one_by_one_and_all_are_counted(tabletop: Domain) -> None:
    tally, seen = Tally(), list[int]()
    found = list(
        feasible(
            TaskSpace(tabletop, 3), seed=1, budget=Budget(1, 1), draws=12, tally=tally,
            progress=lambda: seen.append(tally.seen),
        )
    )  # fmt: skip
    assert tally.seen == 12 and tally.passed == len(found) < 12 and seen == [*range(1, 13)]
    assert sum(tally.reasons.values()) == 12 - len(found) and tally.causes
    tally = Tally()
    endless = feasible(TaskSpace(tabletop, 2), seed=3, tally=tally)
    assert tally.seen == 0
    next(endless)
    assert 1 <= tally.seen < 5
    endless.close()


def test_a_wrong_request_is_refused_at_once(tabletop: Domain) -> None:
    with pytest.raises(QueryError, match="juggle"):
        feasible(TaskSpace(tabletop, 2), seed=3, weights={"juggle": 2})
    with pytest.raises(SceneError, match=r"no \[scene\]"):
        feasible(TaskSpace(load_domain("hanoi"), 2), seed=3)
    with pytest.raises(OutputError, match="cannot be created"):
        feasible(TaskSpace(tabletop, 2), seed=3, demonstrate="/dev/null/folder")


def test_demonstrations_are_recorded_and_named(tabletop: Domain, tmp_path: Path) -> None:
    folder = tmp_path / "new" / "recordings"
    (record,) = islice(feasible(TaskSpace(tabletop, 1), seed=2, demonstrate=folder), 1)
    assert record.verdict is not None and record.verdict["budget"]["tier"] == "demonstration"
    assert Demonstration.load(folder / record.verdict["demonstration"]).success


def test_a_file_is_rechecked_without_naming_its_domain(file: Path, records: list[Record]) -> None:
    outcomes = list(recheck(file))
    assert [outcome.status for outcome in outcomes] == ["feasible"] * len(records)
    assert [outcome.record.task for outcome in outcomes] == [record.task for record in records]
    assert [record.task for record in read_tasks(file)] == [record.task for record in records]


def test_witnesses_alone_are_checked_and_a_false_one_fails(file: Path) -> None:
    read = list(read_tasks(file))
    # The witness of one task is none of another.
    mixed = [read[0], Record(read[1].task, read[1].verdict, read[0].witness)]
    assert read[0].task.actions != read[1].task.actions
    good, bad = recheck(mixed, witness_only=True)
    assert good.status == "feasible" and bad.status == "witness_fails" and bad.reason


def test_tasks_that_miss_a_condition_are_invalid(file: Path, tabletop: Domain, records: list[Record]) -> None:
    condition = f"begins {records[0].task.actions[0]}"
    statuses = [outcome.status for outcome in recheck(file, tabletop, where=[condition], witness_only=True)]
    expected = ["feasible" if r.task.actions[0] == records[0].task.actions[0] else "invalid" for r in records]
    assert statuses == expected and "invalid" in statuses
