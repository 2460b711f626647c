"""What is written into a folder stays in it."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from prag_asp.errors import OutputError
from prag_asp.output import file_in


def test_a_file_in_a_folder_may_be_there_or_not(tmp_path: Path) -> None:
    assert file_in(tmp_path, "a") == tmp_path / "a"
    (tmp_path / "a").write_text("old")
    assert file_in(tmp_path, "a") == tmp_path / "a"


@pytest.mark.parametrize("target", ["../victim", "../new", "/dev/null", "a"])
def test_a_link_that_leads_elsewhere_or_nowhere_is_not_written_to(tmp_path: Path, target: str) -> None:
    (tmp_path / "own").mkdir()
    (tmp_path / "victim").write_text("old")
    (tmp_path / "own" / "a").symlink_to(target)
    with pytest.raises(OutputError, match=r"a: (leads out of the folder|is no regular file)"):
        file_in(tmp_path / "own", "a")


def test_a_pipe_is_not_written_to(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "a")
    with pytest.raises(OutputError, match="is no regular file"):
        file_in(tmp_path, "a")
