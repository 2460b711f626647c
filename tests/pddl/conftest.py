"""One folder for the random tasks of a file: each task overwrites the one before."""

from __future__ import annotations

from pathlib import Path

import pytest

from prag_asp.pddl import size


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("pddl")


@pytest.fixture
def all_large(monkeypatch: pytest.MonkeyPatch) -> None:
    """Treat all actions as those with many instances."""
    monkeypatch.setattr(size, "LARGE", 0)
