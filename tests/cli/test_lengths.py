"""Ranges of lengths on the command line."""

from __future__ import annotations

import json

import pytest

from prag_asp import TaskSpace, load_domain
from tests.cli.conftest import Told


def test_a_range_of_lengths_counts_as_a_table(told: Told) -> None:
    table = told("count", "hanoi", "--length", "2..10", "--by", "skeleton")
    assert table.splitlines()[:2] == ["length  skeletons", "     2  1"] and len(table.splitlines()) == 10
    assert told("count", "hanoi", "--length", "1..4") == told("count", "hanoi", "--length", "4", "--upto")
    assert told("count", "hanoi", "--length", "3..3") == "length  tasks\n     3  8\n"
    assert told("count", "hanoi", "--length", "1..3", "--prefix", "move,move").split()[2:] == [
        "1",
        "0",
        "2",
        "3",
        "3",
        "8",
    ]


def test_a_range_of_lengths_lists_the_shortest_first(told: Told) -> None:
    lines = told("enumerate", "hanoi", "-n", "1..3").splitlines()
    assert lines == [line for length in "123" for line in told("enumerate", "hanoi", "-n", length).splitlines()]
    assert told("enumerate", "hanoi", "-n", "1..3", "--limit", "4").splitlines() == lines[:4]
    written = told("enumerate", "hanoi", "-n", "0..2", "--format", "jsonl").splitlines()
    assert written == [
        line for length in "012" for line in told("enumerate", "hanoi", "-n", length, "--format", "jsonl").splitlines()
    ]


def test_a_range_of_lengths_is_drawn_from_as_one_space(told: Told) -> None:
    drawn = told("sample", "prag", "-n", "1..4", "--count", "40", "--seed", "9", "--no-physics")
    expected = TaskSpace(load_domain("prag"), range(1, 5)).sample(40, seed=9)
    assert drawn.splitlines() == list(map(str, expected))
    assert (
        told("sample", "prag", "-n", "1..4", "--count", "9", "--seed", "9", "--no-physics").splitlines()
        == (drawn.splitlines()[:9])
    )
    one = told("sample", "prag", "-n", "4..4", "--count", "9", "--seed", "9", "--no-physics")
    assert one == told("sample", "prag", "-n", "4", "--count", "9", "--seed", "9", "--no-physics")
    conditioned = ("sample", "prag", "-n", "2..3", "--count", "9", "--no-physics", "--where", "has at least 2 grasp")
    assert all(line.count("grasp(") >= 2 for line in told(*conditioned).splitlines())


def test_several_lengths_are_given_with_commas(told: Told) -> None:
    assert told("count", "hanoi", "-n", "3,1").splitlines() == [
        line for line in told("count", "hanoi", "-n", "1..3").splitlines() if not line.strip().startswith("2")
    ]
    assert told("enumerate", "hanoi", "-n", "0..1,3") == "".join(told("enumerate", "hanoi", "-n", n) for n in "013")


def test_physics_keeps_the_feasible_tasks_of_all_lengths(told: Told) -> None:
    arguments = ("sample", "tabletop", "-n", "1..2", "--count", "6", "--seed", "2", "--format", "jsonl")
    tasks = [json.loads(line) for line in told(*arguments).splitlines()]
    assert len(tasks) == 6 and all(task["verdict"]["status"] == "feasible" for task in tasks)
    drawn = [" ".join(task["actions"]) for task in tasks]
    expected = TaskSpace(load_domain("tabletop"), range(1, 3)).sample(40, seed=2)
    places = [list(map(str, expected)).index(plan) for plan in drawn]
    assert places == sorted(places)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["count", "hanoi", "-n", "6..3"], "--length 6..3: the first is above the last; write 3..6"),
        (["count", "hanoi", "-n", "3.."], "--length 3..: write a whole number, such as 4, A..B for all"),
        (["count", "hanoi", "-n", "-1..3"], "--length -1..3: write a whole number"),
        (["count", "hanoi", "-n", "-1"], "--length -1: a plan has at least 0 actions"),
        (["count", "hanoi", "-n", "1,3..4,4"], "--length 1,3..4,4: the length 4 occurs twice; give each length once"),
        (["count", "hanoi", "-n", "1,"], "--length 1,: write a whole number"),
        (["task", "hanoi", "-n", "1,3", "--index", "0"], "several lengths, but one is needed"),
        (["count", "hanoi", "-n", "1..3", "--upto"], "--upto counts all lengths from 1; leave it out with"),
        (["count", "hanoi", "-n", f"1..{10**30}"], "a plan has at most 1,000,000 actions"),
        (["count", "hanoi", "-n", "1000001"], "--length 1000001: a plan has at most 1,000,000 actions"),
        (["stats", "hanoi", "-n", "1..3"], "--length 1..3: several lengths, but one is needed; give a number"),
        (["task", "hanoi", "-n", "1..3", "--index", "0"], "several lengths, but one is needed"),
        (["split", "hanoi", "-n", "1..3", "a=1"], "several lengths, but one is needed"),
        (["export", "hanoi", "-n", "1..3"], "several lengths, but one is needed"),
        (["export", "hanoi", "-n", "-1"], "at least 0 actions"),
        (["learn", "tabletop", "-n", "x"], "--length x: write a whole number, such as 4\n"),
        (["sample", "hanoi", "-n", "1..3", "--over", "goals"], "over goals, tasks of one length are sampled"),
    ],
)  # fmt: skip
def test_lengths_that_make_no_sense_are_told(arguments: list[str], message: str, told: Told) -> None:
    error = told(*arguments, code=2)
    assert message in error and len(error.splitlines()) == 1
