"""The tables of the grammar are kept for the next run, and believed only where they are whole."""

from __future__ import annotations

from pathlib import Path

import pytest

from prag_asp.output.cache_files import read_cached, write_cached
from prag_asp.pddl.syntax import lark_grammar as tables
from prag_asp.pddl.syntax.nodes import Node
from prag_asp.pddl.syntax.parsing import parse
from tests.pddl.imports import written
from tests.pddl.tasks import TASKS


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("PRAG_ASP_CACHE", str(tmp_path / "cache"))
    return tmp_path / "cache"


def trees(folder: Path, *names: str) -> list[Node]:
    """Return the syntax trees of tasks, read by a parser of their own."""
    tables.grammar.cache_clear()
    found = []
    for name in names:
        for path, kind in zip(written(folder, *TASKS[name]), tables.KINDS, strict=True):
            found.append(parse(path, kind))
    return found


def test_cached_tables_read_the_same(folder: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    first = trees(tmp_path, *TASKS)
    assert len(list(folder.iterdir())) == 1
    monkeypatch.setattr(tables, "_build_parser", lambda: pytest.fail("the tables were built again"))
    assert trees(tmp_path, *TASKS) == first


def test_tables_that_are_damaged_or_of_another_form_are_built_again(folder: Path, tmp_path: Path) -> None:
    first = trees(tmp_path, "blocks")
    (cached,) = folder.iterdir()
    content = cached.read_bytes()
    for damaged in (content[:-9], content.replace(b"action_def", b"action_fed"), b""):
        cached.write_bytes(damaged)
        assert trees(tmp_path, "blocks") == first
        assert read_cached(cached, tables.LARGEST)
    for other in (b"{}", b"[]", b"null", b'{"data": {}, "memo": {}}', b"\xff", b"7"):
        assert write_cached(cached, other)
        assert trees(tmp_path, "blocks") == first


def test_without_a_cache_nothing_is_written(folder: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PRAG_ASP_CACHE", "")
    assert trees(tmp_path, "blocks")
    assert not folder.exists()
