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


def trees(tmp_path: Path) -> list[Node]:
    """Return the syntax trees of all tasks, read by a parser of their own."""
    tables.grammar.cache_clear()
    return [
        parse(*each) for texts in TASKS.values() for each in zip(written(tmp_path, *texts), tables.KINDS, strict=True)
    ]


def test_kept_tables_read_the_same(folder: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    first = trees(tmp_path)
    (kept,) = folder.iterdir()
    monkeypatch.setattr(tables, "_build_parser", lambda: pytest.fail("the tables were made anew"))
    assert trees(tmp_path) == first
    content = kept.read_bytes()
    monkeypatch.undo()
    monkeypatch.setenv("PRAG_ASP_CACHE", str(folder))
    for wrong in (content[:-9], content.replace(b"action_def", b"action_fed"), b""):
        kept.write_bytes(wrong)
        assert trees(tmp_path) == first
        assert read_cached(kept, tables.LARGEST), "what is damaged is made anew"


@pytest.mark.parametrize("content", [b"{}", b"[]", b"null", b'{"data": {}, "memo": {}}', b"\xff", b"7"])
def test_tables_of_another_form_are_made_anew(content: bytes, folder: Path, tmp_path: Path) -> None:
    first = trees(tmp_path)
    (path,) = folder.iterdir()
    assert write_cached(path, content)
    assert trees(tmp_path) == first


def test_without_a_cache_nothing_is_kept(folder: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PRAG_ASP_CACHE", "")
    assert trees(tmp_path)
    assert not folder.exists()
