"""Small datasets that several tests look at, and nobody changes."""

from __future__ import annotations

import os
from collections.abc import Iterator
from pathlib import Path

import pytest

from prag_asp import Dataset, Domain, TaskSpace, load_domain
from prag_asp.dataset import generate
from prag_asp.dataset.pages import strips
from prag_asp.physics import Budget
from tests.sharing import shared_logic, small_pictures  # noqa: F401 - one is a fixture

POOR = Budget(1, 1)
"""A budget with which some tasks are not found."""


@pytest.fixture(scope="package", autouse=True)
def few_pictures() -> Iterator[None]:
    """Draw little."""
    with small_pictures(), pytest.MonkeyPatch.context() as patch:
        patch.setattr(strips, "STRIPS", 1)
        patch.setattr(strips, "STATES", 2)
        yield


@pytest.fixture(scope="package", autouse=True)
def nothing_flushed() -> Iterator[None]:
    """Leave it to the system when files reach the disk: no power is lost here."""
    with pytest.MonkeyPatch.context() as patch:
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
    shares = {"train": "3/4", "test": "1/4"}
    return generate(spaces, folder, tasks=12, seed=5, split=shares, starts=2, budget=POOR, shard=4)


@pytest.fixture(scope="package")
def numbers(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return the folder of a dataset without physics, of a domain that has weights."""
    folder = tmp_path_factory.mktemp("data") / "numbers"
    generate(TaskSpace(load_domain("kitchen"), range(1, 4)), folder, tasks=6, seed=1, physics=False, shard=4)
    return folder
