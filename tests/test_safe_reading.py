"""Files are read where they are files, of a bounded size, and in their folder; nothing else is waited for."""

from __future__ import annotations

import io
import os
from pathlib import Path

import pytest

from prag_asp import safe_reading
from prag_asp.safe_reading import Refused, is_inside, lines_of, open_binary, open_text, read_bytes


def test_a_file_is_read_and_one_that_the_user_names_may_be_a_link(tmp_path: Path) -> None:
    (tmp_path / "a").write_bytes(b"abc")
    (tmp_path / "b").symlink_to("a")
    assert (
        read_bytes(tmp_path / "a")
        == read_bytes(tmp_path / "b")
        == read_bytes(tmp_path / "b", within=tmp_path)
        == b"abc"
    )
    assert read_bytes(os.devnull) == b""


def test_neither_a_device_nor_a_pipe_without_a_writer_is_read_or_waited_for(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe")
    for target in ("/dev/zero", "/dev/random", "/dev/full", tmp_path / "pipe"):
        link = tmp_path / f"link to {Path(target).name}"
        link.symlink_to(target)
        for path in (target, link):
            with pytest.raises(Refused, match="it is not a regular file"):
                read_bytes(path)


def test_a_pipe_that_is_open_already_is_read_as_a_shell_hands_it_over() -> None:
    ours, theirs = os.pipe()
    os.write(theirs, b"line\n")
    os.close(theirs)
    with open_text(f"/dev/fd/{ours}") as stream:
        assert list(lines_of(stream)) == ["line\n"]
    os.close(ours)


def test_a_name_with_a_null_character_leads_nowhere(tmp_path: Path) -> None:
    assert not is_inside(tmp_path / "null\0", tmp_path)
    with pytest.raises(Refused, match="a character that no path has"):
        read_bytes(tmp_path / "null\0", within=tmp_path)


@pytest.mark.parametrize("name", ["../outside", "link", "links/outside", "/etc/passwd"])
def test_what_leads_out_of_its_folder_is_not_read(tmp_path: Path, name: str) -> None:
    folder = tmp_path / "own"
    folder.mkdir()
    (tmp_path / "outside").write_text("secret")
    (folder / "link").symlink_to("../outside")
    (folder / "links").symlink_to("..")
    assert not is_inside(folder / name, folder)
    with pytest.raises(Refused, match="it leads out of the folder"):
        read_bytes(folder / name, within=folder)


def test_a_folder_that_is_itself_reached_by_a_link_is_the_folder(tmp_path: Path) -> None:
    (tmp_path / "real").mkdir()
    (tmp_path / "real" / "a").write_bytes(b"abc")
    (tmp_path / "own").symlink_to("real")
    assert read_bytes(tmp_path / "own" / "a", within=tmp_path / "own") == b"abc"


def test_links_in_a_circle_and_folders_are_told(tmp_path: Path) -> None:
    (tmp_path / "loop").symlink_to("loop")
    for name in ("loop", "", "nothing", "x" * 300, "a\0b"):
        with pytest.raises(OSError):
            read_bytes(tmp_path / name)


def test_no_more_is_read_than_is_allowed(tmp_path: Path) -> None:
    path = tmp_path / "huge"
    with path.open("wb") as file:
        file.truncate(10**12)
    with pytest.raises(Refused, match="it is larger than 64 MB"):
        read_bytes(path)
    path.write_bytes(b"1234")
    assert read_bytes(path, at_most=4) == b"1234"
    with pytest.raises(Refused, match="larger"):
        read_bytes(path, at_most=3)


def test_a_file_that_says_it_is_empty_is_bounded_all_the_same() -> None:
    with pytest.raises(Refused, match="larger"):
        read_bytes("/proc/self/status", at_most=10)


def test_a_line_without_an_end_comes_in_one_bounded_piece(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(safe_reading, "LONGEST_LINE", 4)
    assert list(lines_of(io.StringIO("ab\nabc\n" + "x" * 100))) == ["ab\n", "abc\n", "xxxxx"]


def test_an_open_file_is_no_other_one_than_was_checked(tmp_path: Path) -> None:
    (tmp_path / "a").write_bytes(b"abc")
    with open_binary(tmp_path / "a") as file:
        assert not os.get_inheritable(file.fileno())
