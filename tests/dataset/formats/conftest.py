"""Datasets with recordings, which several forms are written from."""

from __future__ import annotations

from pathlib import Path

import pytest

from prag_asp import Dataset, TaskSpace, load_domain
from prag_asp.dataset import generate
from prag_asp.physics import Staging

SIZE, RATE = (48, 35), 5
"""Width and height that differ, one of them odd, and pictures a second."""


@pytest.fixture(scope="package")
def filmed(tmp_path_factory: pytest.TempPathFactory) -> Dataset:
    """Return a dataset with two parts, each with a task of two actions that two cameras have filmed."""
    folder = tmp_path_factory.mktemp("formats") / "filmed"
    staging = Staging(("front", "wrist"), SIZE, RATE)
    shares = {"train": "1/2", "test": "1/2"}
    return generate(
        TaskSpace(load_domain("tabletop"), 2), folder, tasks=2, split=shares, demonstrate=True, staging=staging
    )


@pytest.fixture(scope="package")
def arms(tmp_path_factory: pytest.TempPathFactory) -> Dataset:
    """Return a dataset of two robots without cameras, one task from two first states."""
    folder = tmp_path_factory.mktemp("formats") / "arms"
    return generate(TaskSpace(load_domain("two_arms"), 1), folder, tasks=1, starts=2, demonstrate=True)


@pytest.fixture(scope="package")
def told(tmp_path_factory: pytest.TempPathFactory) -> Dataset:
    """Return a dataset without physics, whose entities are terms."""
    folder = tmp_path_factory.mktemp("formats") / "told"
    return generate(TaskSpace(load_domain("hanoi"), 2), folder, tasks=2, physics=False)


def of(folder: Path) -> dict[str, bytes]:
    """Return the files below a folder, by their paths."""
    return {str(path.relative_to(folder)): path.read_bytes() for path in folder.rglob("*") if path.is_file()}
