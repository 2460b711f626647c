"""``prag-asp generate`` and ``sample --distinct``: what they print, and how they answer mistakes."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from prag_asp import Dataset
from tests.commands import ok, run
from tests.output.faults import content

KITCHEN = ("kitchen", "-n", "1..3", "--no-physics")


def test_a_data_set_is_written_and_its_parts_are_printed(tmp_path: Path) -> None:
    make = ("generate", *KITCHEN, "--uniform", "--split", "train=1/2, test=1/2", "--shard", "2", "-o", "data")
    assert ok(*make, "--tasks", "6", cwd=tmp_path) == "train  3 of 7\ntest   3 of 7\n"
    done = run(*make, "--tasks", "8", cwd=tmp_path)
    assert done.stdout == "train  4 of 7\ntest   4 of 7\n" and "data: already has 6 tasks" in done.stderr
    ok(*make[:-1], "once", "--tasks", "8", cwd=tmp_path)
    assert content(tmp_path / "data") == content(tmp_path / "once")
    assert Dataset.open(tmp_path / "data").count() == 8


def test_refused_tasks_are_told_and_several_lengths_come_evenly(tmp_path: Path) -> None:
    make = ("generate", "tabletop", "-n", "1..2", "--seed", "3", "--evenly", "--budget", "1x1", "-o", "data")
    done = run(*make, "--tasks", "6", "--shard", "5", cwd=tmp_path)
    assert done.returncode == 0 and "rejected: " in done.stderr
    told = json.loads((tmp_path / "data" / "dataset.json").read_text())
    drawn = [each["drawn"] for each in told["parts"][0]["lengths"]]
    assert abs(drawn[0] - drawn[1]) <= 1


def test_what_is_held_out_is_in_the_test_part_alone(tmp_path: Path) -> None:
    make = ("generate", "prag", "-n", "2", "--no-physics", "--hold-out", "can_1", "--tasks", "10", "-o", "data")
    assert ok(*make, cwd=tmp_path).splitlines()[0].startswith("train  8 of ")
    data = Dataset.open(tmp_path / "data")
    assert not any("can_1" in str(task) for task in data.part("train").tasks())
    assert all("can_1" in str(task) for task in data.part("test").tasks()) and data.part("test").count() == 2


@pytest.mark.parametrize(
    ("arguments", "code", "line"),
    [
        (("--tasks", "15", "--uniform", "--trivial"), 1, "14 of 15 tasks for train found in 14 draws, the whole space"),
        (("--tasks", "13", "--uniform"), 1, "only 12 of 13 tasks for train found in 14 draws, 2 of them trivial"),
        (("--tasks", "1", "--split", "train"), 2, "--split train: write different names with their shares"),
        (("--tasks", "1", "--split", "a=0.5,a=0.5"), 2, "write different names"),
        (("--tasks", "1", "--split", "a=0.5,b=0.6"), 2, "add up to 1"),
        (("--tasks", "1", "--split", "a=0.5,b=x"), 2, "share of 'b': 'x' is not an exact number"),
        (("--tasks", "1", "--evenly"), 2, "--uniform"),
        (("--tasks", "1", "--evenly", "--uniform", "--over", "goals"), 2, "leave out --over goals or --evenly"),
        (("--tasks", "1", "--demonstrate"), 2, "--demonstrate needs physics"),
        (("--tasks", "1", "--starts", "2"), 2, "--starts needs physics"),
        (("--tasks", "1", "--tier", "transit"), 2, "--tier needs physics"),
        (("--tasks", "1", "--hold-out", "unicorn"), 2, "unicorn"),
        (("--tasks", "0",), 64, "0 is not in the range"),
        (("--tasks", "1", "--part", "4/3"), 2, "part 4/3: write K/N, with K from 1 to N"),
        (("--tasks", "1", "--part", "third"), 2, "part third: write K/N, such as 3/64"),
        (("--tasks", "1", "--on", "moon"), 64, "'moon' is not 'ray'"),
        (("--tasks", "1", "--seed", str(2**63)), 2, "seed 9223372036854775808: give one from 0 to"),
        (("--tasks", "1", "--where", "uses apple", "--where", "avoids apple"), 2, "no tasks to sample"),
        (("--tasks", "1", "--weight", "juggle=2"), 2, "juggle"),
    ],
    ids=str,
)  # fmt: skip
def test_mistakes_are_answered_in_one_line(arguments: tuple[str, ...], code: int, line: str, tmp_path: Path) -> None:
    done = run("generate", *KITCHEN, *arguments, "-o", "data", cwd=tmp_path)
    told = [each for each in done.stderr.splitlines() if each != "data: holds the tasks that were found"]
    assert done.returncode == code and len(told) == 1 and line in told[0], done.stderr
    assert code == 1 or not (tmp_path / "data").exists()


def test_parts_are_merged_and_one_that_is_missing_is_told(tmp_path: Path) -> None:
    make = ("generate", *KITCHEN, "--uniform", "--tasks", "6", "--shard", "2")
    for number in (1, 2):
        assert ok(*make, "--part", f"{number}/2", "-o", str(number), cwd=tmp_path) == "train  3 of 7\n"
    assert ok("merge", "2", "1", "-o", "merged", cwd=tmp_path) == "train  6 of 14\n"
    ok(*make, "-o", "whole", cwd=tmp_path)
    assert content(tmp_path / "merged") == content(tmp_path / "whole")
    done = run("merge", "2", "-o", "other", cwd=tmp_path)
    assert (done.returncode, done.stderr) == (2, "1 part missing: 1/2; name the folders of all 2\n")


def test_a_folder_with_something_else_is_left_alone(tmp_path: Path) -> None:
    (tmp_path / "data").mkdir()
    (tmp_path / "data" / "mine.txt").write_text("mine")
    done = run("generate", *KITCHEN, "--tasks", "1", "-o", "data", cwd=tmp_path)
    assert (done.returncode, done.stderr) == (4, "data: holds mine.txt, and is not a dataset; give a new folder\n")
    assert content(tmp_path / "data") == {"mine.txt": b"mine"}


def test_distinct_draws_no_task_twice_and_tells_when_none_is_left(tmp_path: Path) -> None:
    sample = ("sample", *KITCHEN, "--distinct", "--seed", "4", "--uniform")
    lines = ok(*sample, "--count", "14").splitlines()
    assert len({*lines}) == 14 and ok(*sample, "--count", "5").splitlines() == lines[:5]
    done = run(*sample, "--count", "15", "-o", "few.txt", cwd=tmp_path)
    assert (done.returncode, done.stderr) == (1, "only 14 of 15 tasks: there are no others\n")
    done = run("sample", "blocks", "-n", "3", "--distinct", "--weight", "stack=0", "--count", "99", cwd=tmp_path)
    assert done.returncode == 1 and done.stderr.endswith(" of 99 tasks: there are no others of positive weight\n")
    weighted = ok("sample", *KITCHEN, "--distinct", "--weight", "open=1000", "--count", "3").splitlines()
    assert len({*weighted}) == 3 and all(line.count("open") == 2 for line in weighted)
    feasible = ok("sample", "tabletop", "-n", "1", "--distinct", "--count", "3").splitlines()
    assert len({*feasible}) == 3
    assert len({*ok(*sample, "--over", "skeletons", "--count", "14").splitlines()}) == 14
    done = run(*sample, "--by", "plan")
    assert done.returncode == 2 and "leave --by plan out" in done.stderr
