"""Parts of a dataset that several machines make, and the whole that is merged of them: the bytes of one machine."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from functools import partial
from pathlib import Path
from typing import Any

import pytest

from prag_asp import Dataset, OutputError, QueryError, TaskSpace
from prag_asp.dataset import generate, merge, verify
from prag_asp.dataset.making.executors import LocalExecutor
from prag_asp.dataset.validation_jobs import JobResult, ValidationJob, ValidationSetup
from prag_asp.errors import NotFound
from tests.dataset.conftest import HALVES, SMALL, with_json
from tests.output.faults import Disk, content, killed

SAMPLES = 2
"""At how many moments a merge is broken off, of all at which it asks something of the disk."""


Make = Callable[..., list[Path]]


@pytest.fixture(scope="module")
def plain(kitchen: TaskSpace) -> Make:
    """Return what makes the whole, or all parts of so many, without physics."""

    def make(folder: Path, of: int | None = None, only: str | None = None, **more: Any) -> list[Path]:
        asked = {"tasks": 10, "seed": 3, "weights": {}, "physics": False, "shard": 2, "split": HALVES, "trivial": True}
        asked.update(more)
        numbers = [only] if of is None else [f"{number}/{of}" for number in range(1, of + 1)]
        found = []
        for part in numbers:
            found.append(folder / (part or "whole").replace("/", "-"))
            generate(kitchen, found[-1], part=part, **asked)
        return found

    return make


@pytest.mark.parametrize(
    "more",
    [
        {},
        {"evenly": True, "shard": 3},
        {"weights": None},
        {"over": "skeletons", "weights": {}},
        {"split": None, "tasks": 14},
    ],
    ids=str,
)
def test_parts_share_the_draws_and_are_merged_to_the_bytes_of_one_machine(
    plain: Make, tmp_path: Path, more: dict[str, Any]
) -> None:
    (whole,) = plain(tmp_path, **more)
    parts = plain(tmp_path, 3, **more)
    taken = [{(len(task), str(task)) for task in Dataset.open(part).tasks()} for part in parts]
    assert sum(map(len, taken)) == len(set().union(*taken)) >= Dataset.open(whole).count()
    merged = merge(parts[::-1], tmp_path / "merged")
    assert content(merged.folder) == content(whole)


def test_a_part_says_which_it_is_is_found_by_rank_and_verified_by_itself(
    kitchen: TaskSpace, plain: Make, tmp_path: Path
) -> None:
    for number, folder in enumerate(plain(tmp_path, 2), 1):
        data = Dataset.open(folder)
        assert data.manifest.spec.part == f"{number}/2"
        assert f"This is part {number}/2 of a dataset" in (folder / "README.md").read_text()
        assert data.count() == 6 and list(verify(folder)) == []
        for entry in data.entries():
            assert data.by_rank(len(entry.task), entry.rank) == entry
            assert kitchen.at(len(entry.task)).index(entry.task) == entry.rank


def test_a_merge_validates_only_draws_that_no_part_has_validated(
    small: Dataset, spaces: TaskSpace, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    parts = [tmp_path / str(number) for number in (1, 2, 3)]
    for number, folder in enumerate(parts, 1):
        generate(spaces, folder, **SMALL, part=f"{number}/3")
    looked: list[tuple[str, int]] = []
    really = LocalExecutor.run

    def counted(self: LocalExecutor, jobs: Iterator[ValidationJob], setup: ValidationSetup) -> Iterator[JobResult]:
        for found, job in zip(really(self, iter(given := list(_bounded(jobs))), setup), given, strict=True):
            looked.append((setup.part, job.number))
            yield found

    monkeypatch.setattr(LocalExecutor, "run", counted)
    merged = merge(parts, tmp_path / "merged")
    assert content(merged.folder) == content(small.folder)
    done = {
        (part.name, own * 3 + number)
        for number, folder in enumerate(parts)
        for part in Dataset.open(folder).manifest.parts
        for own in range(part.draws)
    }
    assert looked and not done & {*looked}


def _bounded(draws: Iterator[ValidationJob]) -> Iterator[ValidationJob]:
    """Yield a few draws: those that parts lack have no end, and a list is to be made of them."""
    for _, draw in zip(range(8), draws, strict=False):
        yield draw


def test_recordings_come_along_with_the_numbers_of_the_whole(spaces: TaskSpace, tmp_path: Path) -> None:
    def make(folder: Path, part: str | None = None) -> Path:
        generate(spaces.at(1), folder, tasks=2, seed=2, demonstrate=True, part=part)
        return folder

    parts = [make(tmp_path / str(number), f"{number}/2") for number in (1, 2)]
    merged = merge(parts, tmp_path / "merged")
    assert content(merged.folder) == content(make(tmp_path / "whole"))
    (parts[0] / "demonstrations" / "train" / "000001.npz").write_bytes(b"")
    with pytest.raises(
        QueryError, match=r"000001.npz: differs from the file that was written; generate the dataset again"
    ):
        merge(parts, tmp_path / "damaged")


def test_parts_that_grow_are_merged_into_the_same_folder(plain: Make, tmp_path: Path) -> None:
    for tasks in (6, 12):
        parts = plain(tmp_path, 2, tasks=tasks)
        merge(parts, tmp_path / "merged")
    (whole,) = plain(tmp_path, tasks=12)
    assert content(tmp_path / "merged") == content(whole)


def test_a_merge_reports_missing_tasks_and_parts_that_are_complete_do_not(plain: Make, tmp_path: Path) -> None:
    parts = plain(tmp_path, 3, tasks=20)
    with pytest.raises(NotFound, match="only 7 of 10 tasks for train found in 7 draws, the whole space"):
        merge(parts, tmp_path / "merged")
    assert Dataset.open(tmp_path / "merged").count() == 14


def test_parts_that_cannot_be_merged_are_refused_in_one_line(kitchen: TaskSpace, plain: Make, tmp_path: Path) -> None:
    one, two, three = plain(tmp_path, 3)
    (whole,) = plain(tmp_path)
    (other,) = plain(tmp_path / "other", seed=4, only="2/3")
    (more,) = plain(tmp_path / "more", tasks=12, only="2/3")
    (half,) = plain(tmp_path / "half", only="1/2")

    def refused(match: str, parts: Sequence[Path], folder: Path = tmp_path / "merged") -> None:
        with pytest.raises((QueryError, OutputError), match=match) as error:
            merge(parts, folder)
        assert len(error.value.lines) == 1

    refused("no parts to merge; name the folders of all of them", [])
    refused("2 parts missing: 1/3, 3/3; name the folders of all 3", [two])
    refused("is part 2/3, and so is .*; name each part once", [one, two, two])
    refused("whole: is a whole dataset, not a part of one; leave it out", [one, whole])
    refused("not belong to the same dataset as .*: one made with a different value of seed .4.$", [one, other, three])
    refused("one made for 12 tasks, not 10; run the same --tasks for all", [one, more, three])
    refused("one of 2 parts, not of 3", [one, half])
    refused("is one of the parts; give a new folder", [one, two, three], two)
    refused("is not a dataset, because it has no dataset.json", [one, two, tmp_path / "none"])
    refused(r"holds 1-3, and is not a dataset; give a new folder", [one, two, three], whole.parent)
    shard = three / "data" / "train-00000.parquet"
    assert not (tmp_path / "merged").exists()
    shard.write_bytes(shard.read_bytes()[:-1] + b"?")
    refused("cannot be read|differs from its record in dataset.json", [one, two, three])
    with_json("dataset.json", lambda manifest: manifest["spec"].update(part="4/3"))(two)
    refused("part 4/3: write K/N", [one, two])


def test_a_merge_that_is_broken_off_goes_on_to_the_same_bytes(plain: Make, tmp_path: Path) -> None:
    (whole,), parts = plain(tmp_path), plain(tmp_path, 3)
    work = partial(merge, parts)
    with Disk().working() as counted:
        work(tmp_path / "counted")
    assert content(tmp_path / "counted") == content(whole)
    for time, number in enumerate(range(9, len(counted.asked), len(counted.asked) // SAMPLES)):
        folder = tmp_path / str(number)
        if time % 2:
            with Disk(number).working(), pytest.raises(OutputError):
                work(folder)
        else:
            assert killed(number, partial(work, folder))
        assert content(work(folder).folder) == content(whole)
