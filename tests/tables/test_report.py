"""A report collects every problem of a table, each once, with its line and its remedy."""

from __future__ import annotations

from pathlib import Path

import pytest

from prag_asp.errors import QueryError
from prag_asp.tables.report import TableEntry, TableReport, path_text, shown
from prag_asp.tables.toml_text import key_line, parse_toml

TEXT = """title = 3
[parts.train]
taskss = 1
lengths = { low = 1, high = 99 }
"a b" = [0, 7]
"""


def entry_of(text: str) -> TableEntry:
    return TableEntry(TableReport(), (), parse_toml(Path("x.toml"), text))


def test_all_problems_are_raised_at_once_with_their_lines() -> None:
    root = entry_of(TEXT)
    train = root.at("parts").at("train")
    train.require_known(("tasks", "lengths", "a b"))
    assert root.at("title").matching("[a-z]+", "a word") is None
    assert train.at("lengths").at("high").number(0, 10, "steps") is None
    assert train.at("a b").at(1).choice(("1", "2")) is None
    train.at("tasks").needs("a number of tasks")
    assert not train.is_sound and root.at("parts").at("test").is_sound
    with pytest.raises(QueryError) as caught:
        root.report.raise_problems(QueryError, Path("x.toml"), TEXT)
    assert caught.value.lines == (
        "x.toml:3: parts.train.taskss: unknown key; did you mean tasks?",
        "x.toml:1: title: needs a word; got 3",
        "x.toml:4: parts.train.lengths.high: needs a number from 0 to 10 (steps); got 99",
        "x.toml:5: parts.train.a b[1]: needs one of 1, 2; got 7",
    ), "a key that is there under a similar name is no second problem"


def test_a_report_without_problems_raises_nothing() -> None:
    root = entry_of("a = [1, 2.5]\nb = 4\n")
    assert root.at("b").number(0, 9, "metres") == 4.0
    assert root.at("c", [0.0, 1.0]).numbers(2, "two numbers") == (0.0, 1.0)
    assert next(root.at("a").items()).value == 1
    assert root.section("none").value == {} and list(root.at("b").entries()) == []
    root.report.raise_problems(QueryError, Path("x.toml"), "")


@pytest.mark.parametrize("value", [True, float("nan"), float("inf"), "1", None, [1], 2e9])
def test_what_is_no_number_is_reported(value: object) -> None:
    entry = TableEntry(TableReport(), ("a",), value)
    assert entry.number(-1e12, 1e12, "metres") is None
    assert TableEntry(entry.report, ("b",), [value]).numbers(1, "one number") is None
    assert len(entry.report.problems) == 2


def test_errors_of_a_block_become_problems_of_its_key() -> None:
    report = TableReport()
    with report.errors_at("parts", "train"):
        raise QueryError("one; fix it", "two; mend it")
    assert list(map(str, report.problems)) == ["parts.train: one; fix it", "parts.train: two; mend it"]


def test_a_missing_value_and_one_of_another_kind_are_told_with_what_is_needed() -> None:
    root = entry_of("a = 3")
    assert not root.at("a").is_table("like { b = 1 }") and not root.at("c").is_table("")
    assert list(map(str, root.report.problems)) == [
        "a: needs a table like { b = 1 }; got 3",
        "c: missing; write a table",
    ]


def test_a_path_has_keys_and_positions_and_shows_blank_keys() -> None:
    assert path_text(("scene", "boxes", 1, "x")) == "scene.boxes[1].x"
    assert path_text(("weights", "")) == 'weights.""'
    assert shown([0] * 99) == "a list of 99" and shown(True) == "true" and shown("a" * 99).endswith("...")


def test_the_line_of_a_key_is_that_of_the_nearest_table_where_it_is_missing() -> None:
    assert key_line(TEXT, ("parts", "train", "lengths", "low")) == 4
    assert key_line(TEXT, ("parts", "train", "seed")) == 2
    assert key_line(TEXT, ("parts", "train", "a b", 1, "x")) == 5
    assert key_line(TEXT, ("weights",)) == 1
