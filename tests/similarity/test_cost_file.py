"""Costs from a file give the edit distance of a table by hand; files that are wrong are answered with their line."""

from __future__ import annotations

from fractions import Fraction
from pathlib import Path

import pytest

from prag_asp import QueryError, TaskSpace, load_domain
from prag_asp.similarity import read_costs
from prag_asp.similarity.background import Background
from prag_asp.task import Task
from tests.commands import ok, run

COSTS = """
insert = 0.8
[actions.move]
follow = "1/5"
transform = 0.3
[arguments.apple]
can = 0.25
[arguments.bowl_1]
crate_1 = 0.5
"""
SPACE = TaskSpace(load_domain("prag"), 3)


def task(*actions: str) -> Task:
    return next(SPACE.tasks_of_plans([actions]))


def read(tmp_path: Path, text: str, *tasks: Task, background: Background = SPACE.background) -> object:
    file = tmp_path / "costs.toml"
    file.write_text(text)
    return read_costs(file, tasks or SPACE.sample(20, seed=0), background)


def test_distances_are_those_of_the_costs_by_hand(tmp_path: Path) -> None:
    one = task("move(panda,apple_1,bowl_1)", "rotate(panda,apple_1,straight)", "drop(panda,apple_1)")
    other = task("follow(panda,can_1,crate_1)", "rotate(panda,can_1,straight)", "drop(panda,can_1)")
    metric = read(tmp_path, COSTS, one, other)
    # 1/5 for the name, 1/4 for the object and 1/2 for the place; then 1/4 twice
    assert one.distance(other, metric, within=SPACE) == Fraction(19, 20) + Fraction(1, 2)
    third = task("transform(panda,can_1,crate_1)", "rotate(panda,can_1,straight)", "drop(panda,can_1)")
    assert other.distance(third, read(tmp_path, COSTS, one, other, third), within=SPACE) == 1  # follow is far from it
    nearer = COSTS.replace("transform = 0.3", "transform = 0")
    assert one.distance(one, read(tmp_path, nearer, one), within=SPACE) == 0


def test_costs_that_are_no_metric_name_the_actions_that_show_it(tmp_path: Path) -> None:
    tasks = [task(f"{name}(panda,apple_1,bowl_1)", "drop(panda,apple_1)", "grasp(panda,apple_1)")
             for name in ("move", "follow", "transform")]  # fmt: skip
    metric = read(tmp_path, COSTS, *tasks)
    assert not metric.axioms
    assert "by transform(panda,apple_1,bowl_1) costs more than by way of move(panda,apple_1" in metric.summary
    fits = COSTS + "[actions.follow]\ntransform = 0.5\n"
    assert read(tmp_path, fits, *tasks).axioms
    both = COSTS + "[actions.follow]\nmove = 0.3\ntransform = 0.5\n"
    assert "but the reverse costs" in read(tmp_path, both, *tasks).summary


@pytest.mark.parametrize(
    ("text", "refused"),
    [
        ("insrt = 1", "costs.toml:1: no key 'insrt'; did you mean insert?"),
        ("insert = -1", "costs.toml:1: insert: -1 is negative"),
        ("replace = 'x'", "costs.toml:1: replace: 'x' is not an exact number"),
        ("[actions]\nmove = 1", "costs.toml:2: actions.move: is not a table; write it like [actions.NAME] with OTHER"),
        ("actions = 2", "costs.toml:1: actions: is not a table"),
        ("[actions.move]\nfolow = 1", "costs.toml:2: no action 'folow'; did you mean follow?"),
        ("[arguments.pear]\ncan = 1", "costs.toml:1: no class or argument 'pear'"),
        ("[arguments.apple_1]\ncan_1 = 0.5", "though they are interchangeable; give both the same cost"),
        ("=", "costs.toml:1: not TOML"),
    ],
)
def test_files_that_are_wrong_are_answered(text: str, refused: str, tmp_path: Path) -> None:
    with pytest.raises(QueryError) as caught:
        read(tmp_path, text)
    assert refused in str(caught.value)


def test_the_command_takes_a_file_of_costs(tmp_path: Path) -> None:
    (tmp_path / "costs.toml").write_text(COSTS)
    arguments = ("similarity", "--domain", "prag", "-n", "3", "0", "900", "--costs", str(tmp_path / "costs.toml"))
    assert ok(*arguments).startswith("custom costs: distance ")
    for more, refused in (
        (("--metric", "goal"), "leave --metric goal out"),
        (("--costs", "no.toml"), "cannot be read"),
    ):
        done = run(*arguments, *more)
        assert done.returncode == 2 and refused in done.stderr
