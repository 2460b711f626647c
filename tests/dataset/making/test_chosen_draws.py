"""Datasets whose tasks cover combinations or are far apart reach what a list says, also after rejections."""

from __future__ import annotations

import json
import shutil
from collections.abc import Callable, Iterator
from functools import partial
from itertools import combinations, pairwise
from pathlib import Path
from typing import Any

import pytest

from prag_asp import Dataset, QueryError, Task, TaskSpace, load_domain
from prag_asp.analysis.covering import combination_text, combinations_of
from prag_asp.dataset import generate, verify
from prag_asp.dataset.making.executors import LocalExecutor
from prag_asp.dataset.store.draw_results import DrawResult
from prag_asp.dataset.validation_jobs import JobResult, ValidationJob, ValidationSetup
from prag_asp.errors import NotFound
from tests.chance import Chance
from tests.commands import ok, run
from tests.output.faults import Disk, content, killed

SPACE = TaskSpace(load_domain("prag"), 3)
COVER: dict[str, Any] = {"cover": 2, "seed": 3, "physics": False, "shard": 3}
DIVERSE: dict[str, Any] = {"diverse": 20, "candidates": 60, "seed": 3, "physics": False, "shard": 3}


def covered(tasks: Iterator[Task] | list[Task], strength: int = 2) -> set[str]:
    classes = SPACE.domain.facts.entity_names
    return {
        combination_text(each)
        for task in tasks
        for action in task.actions
        for each in combinations_of(action, classes, strength)
    }


def rejecting(monkeypatch: pytest.MonkeyPatch, bad: Callable[[Task], bool]) -> None:
    """Have the executor reject some tasks, as if they were trivial."""

    def validated(_: object, jobs: Iterator[ValidationJob], setup: ValidationSetup) -> Iterator[JobResult]:
        for job in jobs:
            assert isinstance(job.drawn, Task)
            left_out = bad(job.drawn) or job.drawn.trivial
            yield JobResult(DrawResult(setup.part, job.number, None, [], left_out).to_json(), ())

    monkeypatch.setattr(LocalExecutor, "run", validated)


def others(folder: Path) -> list[str]:
    """Return the findings that do not come from tasks which only these tests reject."""
    return [str(each) for each in verify(folder) if "left out, but not trivial" not in str(each)]


def test_all_combinations_are_covered_and_more_tasks_are_sampled(tmp_path: Path) -> None:
    data = generate(SPACE, tmp_path / "few", **COVER)
    cover, few = data.manifest.cover, data.count()
    assert cover and not cover.missing and cover.reachable == cover.covered == len(covered(SPACE.tasks()))
    assert covered(list(data.tasks())) == covered(SPACE.tasks()) and data.manifest.parts[0].requested == few
    assert not list(verify(tmp_path / "few"))
    whole = generate(SPACE, tmp_path / "whole", tasks=few + 20, **COVER)
    assert whole.count() == few + 20 == len({task.actions for task in whole.tasks()})
    assert not list(verify(tmp_path / "whole"))
    generate(SPACE, tmp_path / "few", tasks=few + 20, **COVER)
    assert content(tmp_path / "few") == content(tmp_path / "whole")
    with pytest.raises(QueryError, match="already; request at least as many"):
        generate(SPACE, tmp_path / "few", **COVER)


def test_rejected_tasks_are_replaced_where_others_have_the_same_combinations(
    chance: Chance, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    everything = list(SPACE.tasks())
    for number in range(chance.examples(1)):
        generator = chance.generator(number)
        actions = sorted({str(action) for task in everything for action in task.actions})
        bad = set(generator.sample(actions, 5))
        rejects = lambda task, bad=bad: any(str(action) in bad for action in task.actions)  # noqa: E731
        rejecting(monkeypatch, rejects)
        folder = tmp_path / str(number)
        data = generate(SPACE, folder, **{**COVER, "seed": number})
        possible = covered([task for task in everything if not (rejects(task) or task.trivial)])
        cover = data.manifest.cover
        assert cover and set(cover.missing) == covered(everything) - possible, number
        assert covered(list(data.tasks())) == possible and cover.covered == len(possible)
        assert others(folder) == []
        before = content(folder)
        generate(SPACE, folder, **{**COVER, "seed": number})  # tries again what is missing, in vain
        assert content(folder) == before


def test_tasks_far_apart_are_those_of_a_farthest_first_traversal_without_the_rejected_ones(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    data = generate(SPACE, tmp_path / "all", **DIVERSE)
    drawn = generate(SPACE, tmp_path / "drawn", tasks=60, seed=3, physics=False)
    given = list(drawn.tasks())

    def apart(one: Task, other: Task) -> float:
        return one.distance(other, metric="levenshtein-classes", within=SPACE)

    chosen = list(data.tasks())
    (figures,) = (data.manifest.diverse or {}).values()
    given = given[: figures.candidates]
    assert chosen[0].actions == given[0].actions
    nearest = [float("inf")] * len(given)
    for before, task in pairwise(chosen):
        nearest = [min(least, apart(each, before)) for least, each in zip(nearest, given, strict=True)]
        assert nearest[[each.actions for each in given].index(task.actions)] == pytest.approx(max(nearest))
    assert figures.separation == pytest.approx(min(apart(*pair) for pair in combinations(chosen, 2)))
    assert figures.radius == pytest.approx(max(min(apart(task, each) for each in chosen) for task in given))
    assert not list(verify(tmp_path / "all"))
    bad = {task.actions for task in chosen[::3]}
    rejecting(monkeypatch, lambda task: task.actions in bad)
    again = generate(SPACE, tmp_path / "rejected", **DIVERSE)
    assert again.count() == 20 and bad.isdisjoint(task.actions for task in again.tasks())
    assert others(tmp_path / "rejected") == []
    rejecting(monkeypatch, lambda task: str(task.actions[0]) != str(chosen[0].actions[0]))
    with pytest.raises(NotFound, match="all nontrivial candidates; raise --candidates"):
        generate(SPACE, tmp_path / "lacking", **DIVERSE)


@pytest.mark.parametrize("request_", [{**COVER, "cover": 1}, DIVERSE], ids=["cover", "diverse"])
def test_a_killed_run_goes_on_to_the_same_bytes(
    request_: dict[str, Any], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    rejecting(monkeypatch, lambda task: "can_1" in str(task.actions[0]))

    def make(folder: Path) -> None:
        generate(SPACE.at(2), folder, **request_)

    make(tmp_path / "whole")
    whole = content(tmp_path / "whole")
    with Disk().working() as counted:
        make(tmp_path / "counted")
    for number in range(2, len(counted.asked), len(counted.asked) // 2):
        folder = tmp_path / str(number)
        assert killed(number, partial(make, folder))
        make(folder)
        assert content(folder) == whole
        shutil.rmtree(folder)


def test_a_run_that_a_limit_of_draws_ended_goes_on(tmp_path: Path) -> None:
    generate(SPACE.at(2), tmp_path / "whole", **COVER)
    few = generate(SPACE.at(2), tmp_path / "few", max_draws=2, **COVER)
    assert few.manifest.cover and few.manifest.cover.missing and not list(verify(tmp_path / "few"))
    before = content(tmp_path / "few")
    generate(SPACE.at(2), tmp_path / "few", max_draws=2, **COVER)
    assert content(tmp_path / "few") == before
    generate(SPACE.at(2), tmp_path / "few", **COVER)
    assert content(tmp_path / "few") == content(tmp_path / "whole")


def test_figures_that_do_not_hold_are_found(tmp_path: Path) -> None:
    for name, request, change in (
        ("cover", {**COVER, "shard": 50}, lambda told: told["cover"].update(covered=1)),
        (
            "diverse",
            {**DIVERSE, "diverse": 3, "candidates": 10},
            lambda told: told["diverse"]["train"].update(separation=9.0),
        ),
    ):
        generate(SPACE.at(1), tmp_path / name, **request)
        file = tmp_path / name / "dataset.json"
        told = json.loads(file.read_text())
        change(told)
        file.write_text(json.dumps(told))
        assert f"{name} does not match the tasks" in "".join(map(str, verify(tmp_path / name)))


def test_the_command_says_what_is_reached_and_what_contradicts(tmp_path: Path) -> None:
    make = ("generate", "prag", "-n", "2", "--no-physics", "-o", "data")
    done = run(*make, "--cover", "1", cwd=tmp_path)
    assert "the tasks cover 16 of 16 reachable combinations of 1 factor" in done.stderr, done.stderr
    assert Dataset.open(tmp_path / "data").manifest.spec.cover == 1 and "ok" in ok("verify", str(tmp_path / "data"))
    done = run(*make[:-1], "far", "--diverse", "3", "--candidates", "8", cwd=tmp_path)
    assert "train: tasks at least 2 apart (levenshtein-classes)" in done.stderr, done.stderr
    for options, refused in (
        ((), "the number of tasks is missing; give --tasks K, --cover T or --diverse K"),
        (("--cover", "2", "--diverse", "2"), "leave cover or diverse out"),
        (("--cover", "2", "--split", "a=0.5,b=0.5"), "leave split out"),
        (("--cover", "2", "--part", "1/2"), "leave part 1/2 out"),
        (("--cover", "2", "--weight", "grasp=2"), "leave weights out"),
        (("--diverse", "2", "--tasks", "3"), "leave tasks out"),
        (("--diverse", "5", "--candidates", "3"), "candidates 3: give a number from 5 to 100000"),
        (("--tasks", "5", "--candidates", "30"), "add diverse"),
        (("--diverse", "5", "--strata", "length"), "--diverse"),
        (("--cover", "2", "--length", "1..2", "-o", "new"), "a space of the lengths 1..2: choose one"),
    ):
        done = run(*make, *options, cwd=tmp_path)
        assert done.returncode == 2 and refused in done.stderr, (options, done.stderr)
