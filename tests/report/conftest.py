"""A dataset without physics, made once, and sources of plain values."""

from __future__ import annotations

import os
from collections.abc import Iterator
from pathlib import Path

import pytest

from prag_asp import TaskSpace, load_domain
from prag_asp.dataset import generate
from prag_asp.report import ReportSource, read_source


@pytest.fixture(scope="package", autouse=True)
def no_flush() -> Iterator[None]:
    """Leave it to the system when files reach the disk: no power is lost here."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(os, "fsync", lambda descriptor: None)
        yield


@pytest.fixture(scope="package")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return the folder of 40 tasks of the domain prag, in two parts."""
    folder = tmp_path_factory.mktemp("data") / "some"
    space = TaskSpace(load_domain("prag"), (2, 3))
    generate(space, folder, tasks=40, seed=1, split={"train": 0.8, "test": 0.2}, physics=False, evenly=True)
    return folder


@pytest.fixture(scope="package")
def source(folder: Path) -> ReportSource:
    return read_source(folder)
