"""Small datasets that several tests look at, and nobody changes."""

from __future__ import annotations

import json
import os
import shutil
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

from prag_asp import Dataset, Domain, TaskSpace, load_domain
from prag_asp.dataset import generate
from prag_asp.physics import Budget
from tests.sharing import automata_are_cached, shared_logic, small_pictures  # noqa: F401 - two are fixtures

POOR = Budget(1, 1)
"""A budget with which some tasks are not found."""

SHARES, HALVES = {"train": "3/4", "test": "1/4"}, {"train": "0.5", "test": "0.5"}
SMALL = {"tasks": 12, "seed": 5, "split": SHARES, "starts": 2, "budget": POOR, "shard": 4}
"""The request of the dataset `small`."""

Change = Callable[[Path], object]
"""Changes something in a folder."""


def with_json(name: str, change: Callable[[Any], object]) -> Change:
    """Return a function that changes the value of a JSON file in a folder."""

    def write(folder: Path) -> None:
        value = json.loads((folder / name).read_text())
        change(value)
        (folder / name).write_text(json.dumps(value))

    return write


@pytest.fixture(scope="package", autouse=True)
def few_pictures_and_no_flush() -> Iterator[None]:
    """Draw little, and leave it to the system when files reach the disk: no power is lost here."""
    with small_pictures(), pytest.MonkeyPatch.context() as patch:
        patch.setattr(os, "fsync", lambda descriptor: None)
        yield


@pytest.fixture(scope="package")
def tabletop() -> Domain:
    return load_domain("tabletop")


@pytest.fixture(scope="package")
def spaces(tabletop: Domain) -> TaskSpace:
    return TaskSpace(tabletop, range(1, 3))


@pytest.fixture(scope="package")
def small(spaces: TaskSpace, tmp_path_factory: pytest.TempPathFactory) -> Dataset:
    """Return 12 tasks in three shards and two parts, some of them refused, each from two initial states."""
    folder = tmp_path_factory.mktemp("data") / "small"
    return generate(spaces, folder, **SMALL)


@pytest.fixture
def copied(small: Dataset, tmp_path: Path) -> Path:
    return Path(shutil.copytree(small.folder, tmp_path / "copied"))


@pytest.fixture(scope="package")
def kitchen() -> TaskSpace:
    space = TaskSpace(load_domain("kitchen"), range(1, 4))
    assert space.count() == 14
    return space


@pytest.fixture(scope="package")
def numbers(kitchen: TaskSpace, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return the folder of a dataset without physics, of a domain that has weights."""
    folder = tmp_path_factory.mktemp("data") / "numbers"
    generate(kitchen, folder, tasks=6, seed=1, physics=False, shard=4)
    return folder
