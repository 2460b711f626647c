"""Datasets without the tasks of earlier ones: disjoint, exhaustive, and otherwise the same sample."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from prag_asp import Dataset, OutputError, QueryError, TaskSpace, load_domain
from prag_asp.dataset import generate, merge, verify
from prag_asp.dataset.stored_scenarios import read_earlier
from prag_asp.errors import NotFound
from prag_asp.space.parts.ranked_tasks import RankRange, ShuffledRanks
from prag_asp.space.parts.shuffle import Shuffle
from prag_asp.space.sampling.rank_order import EvenOrder, RemainingOrder
from tests.chance import Chance
from tests.commands import ok, run

HALVES = {"train": "1/2", "test": "1/2"}


@pytest.fixture(scope="module")
def space() -> TaskSpace:
    return TaskSpace(load_domain("hanoi"), (1, 2, 3, 4))


def words(data: Dataset) -> list[str]:
    return [str(task) for task in data.tasks()]


def test_an_order_without_some_numbers_is_the_rest_in_the_same_order(chance: Chance) -> None:
    rng = chance.generator(7)
    for _ in range(chance.examples(20)):
        sizes = [rng.randint(1, 6) for _ in range(3)]
        order = EvenOrder(
            tuple(ShuffledRanks(Shuffle(size, rng.randint(0, 9)), RankRange(range(size))) for size in sizes)
        )
        excluded = sorted(rng.sample(range(order.size), rng.randint(0, order.size)))
        rest = RemainingOrder(order, tuple(excluded))
        expected = [order[number] for number in range(order.size) if number not in excluded]
        assert [rest[number] for number in range(rest.size)] == expected
        for number in range(order.size):
            stretch, rank = order[number]
            assert rest.number(stretch, rank) == (expected.index((stretch, rank)) if number not in excluded else None)


@pytest.mark.parametrize(
    "request_",
    [
        {},
        {"split": HALVES},
        {"evenly": True},
        {"over": "skeletons"},
        {"split": HALVES, "skeletons": True, "physics": False},
        {"temperature": "2", "weights": {"move": 3}},
    ],
)
def test_the_rest_of_a_sample_is_the_sample_without_the_first_tasks(
    space: TaskSpace, tmp_path: Path, request_: dict[str, Any]
) -> None:
    if "skeletons" in request_:
        space = TaskSpace(load_domain("prag"), 2)
    options: dict[str, Any] = {"seed": 4, "trivial": True, **request_}
    few, many = (2, 4) if "skeletons" in options else (8, 14)
    first = generate(space, tmp_path / "first", tasks=few, **options)
    more = generate(space, tmp_path / "more", tasks=many, **options)
    known = read_earlier(first.folder)
    again = generate(space, tmp_path / "again", tasks=many - few, excluded=known, shard=2, **options)
    assert not {*words(first)} & {*words(again)}
    assert all(again.by_rank(len(entry.task), entry.rank) == entry for entry in again.entries())
    if "skeletons" not in options:
        for name in first.parts:
            later = words(more.part(name))[first.part(name).count() :]
            assert words(again.part(name))[: len(later)] == later[: again.part(name).count()]
    assert list(verify(again.folder)) == []
    with pytest.raises(OutputError, match="made with a different value of excluded"):
        generate(space, again.folder, tasks=many, shard=2, **options)


def test_all_of_a_space_can_be_excluded_step_by_step_and_by_machines(space: TaskSpace, tmp_path: Path) -> None:
    ids = tmp_path / "ids"
    ids.write_text(ok("sample", "hanoi", "-n", "1..4", "--distinct", "--count", "9", "--format", "scenario"), "utf-8")
    arguments = ["hanoi", "-n", "1..4", "--trivial", "--except", str(ids)]
    rest = space.count() - 9
    ok("generate", *arguments, "--tasks", str(rest), "-o", str(tmp_path / "rest"))
    whole = Dataset.open(tmp_path / "rest")
    excluded = {(each.length, each.rank) for each in read_earlier(ids)}
    assert not excluded & {(each.length, each.rank) for each in read_earlier(whole.folder)}
    assert whole.count() == rest == len({*words(whole)}) and len(excluded) == 9
    for number in (1, 2):
        ok("generate", *arguments, "--tasks", str(rest), "--part", f"{number}/2", "-o", str(tmp_path / f"{number}"))
    merged = merge([tmp_path / "1", tmp_path / "2"], tmp_path / "merged")
    assert (merged.folder / "dataset.json").read_bytes() == (whole.folder / "dataset.json").read_bytes()
    done = run("generate", *arguments, "--except", str(tmp_path / "rest"), "--tasks", "1", "-o", str(tmp_path / "none"))
    assert done.returncode == 2 and "there are no tasks to sample" in done.stderr
    with pytest.raises(QueryError, match="the scenario has other conditions"):
        generate(space.where("nontrivial"), tmp_path / "x", tasks=1, excluded=read_earlier(ids))
    with pytest.raises(NotFound, match="the whole space"):
        generate(space, tmp_path / "y", tasks=rest + 1, trivial=True, excluded=read_earlier(ids))
    assert next(iter(read_earlier(whole.folder))) == whole.scenario(0).task
