"""Parts of suites that are far from others: as a list of all plans says, with weights and splits, and verified."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from prag_asp import Dataset, QueryError, TaskSpace
from prag_asp.dataset import ApartSpec, count_suite, generate, generate_suite, verify
from prag_asp.dataset.suites import verifying
from tests.analysis.test_neighbours import edits
from tests.commands import run
from tests.dataset.suites.test_suites import suite_of

FAR = """
domain = "shelves"
lengths = "1..4"
physics = false

[parts.train]
lengths = "1..2"
where = "lacks wash"
tasks = 4

[parts.far]
where = "has wash"
tasks = 3
distance = { train = 2 }

[parts.others]
where = "has at least 2 wash"
distance = { train = 3, far = 1 }
tasks = 1
"""


def far(space: TaskSpace, where: str, others: TaskSpace, distance: int) -> set[tuple[str, ...]]:
    """Return the tasks that satisfy a condition and are far from all plans of another space."""
    plans = list(others.enumerate("plan"))
    tasks = space.where(where).enumerate("task")
    return {task for task in tasks if all(edits(task, plan) >= distance for plan in plans)}


def test_sizes_are_those_of_a_list_and_verify_proves_the_distances(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    suite = suite_of(tmp_path, FAR.partition("[parts.others]")[0])
    space = TaskSpace(suite.domain, range(1, 5))
    expected = far(space, "has wash", TaskSpace(suite.domain, range(1, 3)).where("lacks wash"), 2)
    figures = count_suite(suite)
    assert 0 < figures.size("far") == len(expected) < space.where("has wash").count()
    assert space.at(3).symmetries.order == 4 and [each.tasks for each in figures.shared] == [0]
    generate_suite(suite, tmp_path / "bench")
    assert not list(verify(tmp_path / "bench"))
    data = Dataset.open(tmp_path / "bench" / "far")
    assert {tuple(map(str, task.actions)) for task in data.tasks()} <= expected
    assert all(data.by_rank(len(entry.task), entry.rank) == entry for entry in data.entries())
    card = (tmp_path / "bench" / "README.md").read_text()
    assert "Each task of far is at least 2 edits from all tasks of train." in card
    done = run("suite", str(tmp_path / "suite.toml"), "--count")
    assert "distance: far  at least 2 edits from all tasks of train" in done.stdout
    monkeypatch.setattr(verifying, "space_of", lambda suite, part, **_: TaskSpace(suite.domain, range(1, 5)))
    assert re.search(
        r"far: row 0: is 0 edits from a task of train, not 2", "\n".join(map(str, verify(tmp_path / "bench")))
    )


def test_several_distances_hold_together(tmp_path: Path) -> None:
    suite = suite_of(tmp_path, FAR)
    space, dry = TaskSpace(suite.domain, range(1, 5)), TaskSpace(suite.domain, range(1, 3)).where("lacks wash")
    expected = far(space, "has at least 2 wash", dry, 3)
    assert count_suite(suite_of(tmp_path, FAR.replace(", far = 1", ""))).size("others") == len(expected) > 0
    with pytest.raises(QueryError, match="1 task requested for others, but its space has 0"):
        count_suite(suite)  # all tasks of this part satisfy the conditions of the other one


def test_weights_lengths_in_turn_and_splits_keep_the_distance(tmp_path: Path) -> None:
    suite = suite_of(tmp_path, FAR)
    space = TaskSpace(suite.domain, range(1, 5)).where("has wash")
    apart = [ApartSpec(2, [1, 2], ["lacks wash"])]
    expected = far(space, "has wash", apart[0].space(space), 2)
    for number, request in enumerate((
        {"weights": {"wash": 5}}, {"evenly": True}, {"split": {"a": 0.5, "b": 0.5}}, {"over": "skeletons"},
    )):  # fmt: skip
        folder = tmp_path / str(number)
        data = generate(space, folder, tasks=len(expected), apart=apart, trivial=True, **request)
        assert {tuple(map(str, task.actions)) for task in data.tasks()} == expected, request
        assert sum(int(part.size) for part in data.manifest.parts) == len(expected) and not list(verify(folder))
    for request in ({"cover": 1}, {"split": {"a": 0.5, "b": 0.5}, "skeletons": True}):
        with pytest.raises(QueryError, match="far from others are sampled"):
            generate(space, tmp_path / "new", tasks=3, apart=apart, **request)


@pytest.mark.parametrize(
    ("old", "new", "told"),
    [
        ("{ train = 2 }", "{ tarin = 2 }", r":14: parts.far.distance.tarin: .*did you mean train"),
        ("{ train = 2 }", "{ train = 0 }", r":14: parts.far.distance.*from 1"),
        ("{ train = 2 }", "{ far = 2 }", r":14: parts.far.distance.far: "),
        ("{ train = 2 }", "{ train = 2 }\nskeletons = true\nsplit = { a = 0.5, b = 0.5 }", r":15: .*leave it out"),
    ],
)
def test_mistakes_are_told_with_their_lines(tmp_path: Path, old: str, new: str, told: str) -> None:
    with pytest.raises(QueryError) as error:
        suite_of(tmp_path, FAR.replace(old, new, 1))
    assert re.search(told, str(error.value)), error.value
