"""A new folder is there whole or not at all; what is written into a folder stays in it."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from prag_asp.errors import OutputError
from prag_asp.output import file_in, new_folder, whole_file


def grow(folder: Path) -> None:
    with new_folder(folder) as tree:
        (tree / "deep").mkdir()
        (tree / "deep" / "file").write_bytes(b"content")


def test_a_folder_is_there_in_one_stroke(tmp_path: Path) -> None:
    folder = tmp_path / "deeper" / "out"
    with new_folder(folder) as tree:
        (tree / "file").write_bytes(b"content")
        assert not folder.exists()
    assert {path.name: path.read_bytes() for path in folder.iterdir()} == {"file": b"content"}
    assert [*folder.parent.iterdir()] == [folder]


def test_an_empty_folder_becomes_it_and_any_other_is_left_alone(tmp_path: Path) -> None:
    (tmp_path / "out").mkdir()
    grow(tmp_path / "out")
    with pytest.raises(OutputError, match="already exists"):
        grow(tmp_path / "out")
    (tmp_path / "link").symlink_to(tmp_path / "nowhere")
    with pytest.raises(OutputError, match="already exists"):
        grow(tmp_path / "link")


def test_what_a_killed_run_has_left_goes_and_links_in_it_are_not_followed(tmp_path: Path) -> None:
    other = tmp_path / "other"
    other.mkdir()
    (other / "kept").write_bytes(b"kept")
    tree = tmp_path / "out.part" / "out"
    tree.mkdir(parents=True)
    (tree / "old").mkdir()
    (tree / "old" / "half").write_bytes(b"ha")
    (tree / "link").symlink_to(other)
    grow(tmp_path / "out")
    assert sorted(path.name for path in tmp_path.rglob("*")) == ["deep", "file", "kept", "other", "out"]
    assert (other / "kept").read_bytes() == b"kept"


def test_a_folder_of_somebody_else_is_left_alone(tmp_path: Path) -> None:
    tree = tmp_path / "out.part"
    tree.mkdir()
    (tree / "theirs").touch()
    with pytest.raises(OutputError, match="holds theirs, but has to be empty"):
        grow(tmp_path / "out")
    assert (tree / "theirs").exists()
    tree.rename(tmp_path / "moved")
    tree.symlink_to(tmp_path / "moved")
    with pytest.raises(OutputError, match="is a link"):
        grow(tmp_path / "out")


def test_a_second_run_waits_and_then_says_that_there_is_another(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("prag_asp.output.atomic_file.PATIENCE", 0.05)
    with new_folder(tmp_path / "out") as tree:
        (tree / "file").touch()
        with pytest.raises(OutputError, match="another run is writing it"):
            grow(tmp_path / "out")
        assert (tree / "file").exists()
    assert (tmp_path / "out" / "file").exists()


def test_what_fails_leaves_neither_a_tree_nor_a_file(tmp_path: Path) -> None:
    def fail() -> None:
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt), new_folder(tmp_path / "out") as tree:
        (tree / "deep").mkdir()
        fail()
    (tmp_path / "file").write_bytes(b"old")
    with pytest.raises(KeyboardInterrupt), whole_file(tmp_path / "file") as path:
        path.write_bytes(b"half")
        fail()
    assert {path.name: path.read_bytes() for path in tmp_path.iterdir()} == {"file": b"old"}
    with whole_file(tmp_path / "file") as path:
        path.write_bytes(b"new")
    assert (tmp_path / "file").read_bytes() == b"new"
    with pytest.raises(OutputError, match="is not a regular file"), whole_file(tmp_path):
        fail()


def test_only_regular_files_inside_a_folder_are_written(tmp_path: Path) -> None:
    own = tmp_path / "own"
    own.mkdir()
    (tmp_path / "victim").write_text("old")
    for target in ("../victim", "../new", "/dev/null", "a"):
        (own / "a").symlink_to(target)
        with pytest.raises(OutputError, match=r"a: (leads out of the folder|is not a regular file)"):
            file_in(own, "a")
        (own / "a").unlink()
    os.mkfifo(own / "pipe")
    with pytest.raises(OutputError, match="is not a regular file"):
        file_in(own, "pipe")
    assert file_in(own, "a") == own / "a"
    (own / "a").write_text("old")
    assert file_in(own, "a") == own / "a"
