"""A file is the old one or the new one, whatever fails and whenever its writer is killed."""

from __future__ import annotations

import errno
import os
import resource
import stat
from pathlib import Path

import pytest

from prag_asp.domain.scaffold import write_new_domain
from prag_asp.errors import OutputError
from prag_asp.output import replace_file
from prag_asp.output.atomic_file import AtomicFile
from tests.output.faults import Disk, content, killed

OLD, NEW = b"old\n" * 1000, b"new\n" * 3000


def operations(work: object) -> int:
    with Disk().working() as disk:
        work()  # type: ignore[operator]
    return len(disk.asked)


@pytest.mark.parametrize("old", [None, OLD])
def test_at_each_failure_of_the_disk_a_file_is_the_old_one_or_the_new_one(tmp_path: Path, old: bytes | None) -> None:
    file = tmp_path / "file"
    total = operations(lambda: replace_file(file, NEW))
    assert total == 6
    for code in (errno.ENOSPC, errno.EIO):
        for times in (1, 99):
            for number in range(1, total + 1):
                file.unlink(missing_ok=True)
                if old is not None:
                    file.write_bytes(old)
                with (
                    Disk(number, times, code).working(),
                    pytest.raises(OutputError, match="file: cannot be written"),
                ):
                    replace_file(file, NEW)
                found = content(tmp_path)
                # Only the folder is still to be flushed when the last one fails.
                assert found == ({"file": NEW} if number == total else {"file": old} if old is not None else {})
                replace_file(file, NEW)
                assert content(tmp_path) == {"file": NEW}


def test_at_each_moment_of_a_kill_a_file_is_the_old_one_or_the_new_one(tmp_path: Path) -> None:
    file = tmp_path / "file"
    number = 0
    while True:
        number += 1
        file.write_bytes(OLD)
        if not killed(number, lambda: replace_file(file, NEW)):
            break
        assert file.read_bytes() == (NEW if number == 6 else OLD)
        replace_file(file, NEW)
        assert content(tmp_path) == {"file": NEW}
    assert number == 7


def test_a_new_domain_is_whole_or_not_there(tmp_path: Path) -> None:
    whole = content(write_new_domain("mine", tmp_path / "reference"))
    total = operations(lambda: write_new_domain("mine", tmp_path / "counted"))
    for number in range(1, total + 1):
        for times in (1, 99, None):
            home = tmp_path / f"{number} {times}"
            if times is None:
                assert killed(number, lambda home=home: write_new_domain("mine", home))
            else:
                with Disk(number, times).working(), pytest.raises(OutputError):
                    write_new_domain("mine", home)
            assert not (home / "mine").exists() or content(home / "mine") == whole
            if not (home / "mine").exists():
                write_new_domain("mine", home)
            assert content(home) == {f"mine/{name}": text for name, text in whole.items()}


def test_other_files_where_a_new_domain_is_made_are_left_alone(tmp_path: Path) -> None:
    (tmp_path / "mine.part").mkdir()
    (tmp_path / "mine.part" / "thesis.tex").write_text("all of it")
    with pytest.raises(OutputError, match=r"mine.part: holds thesis.tex"):
        write_new_domain("mine", tmp_path)
    assert content(tmp_path) == {"mine.part/thesis.tex": b"all of it"}


def test_a_file_keeps_its_permissions_and_a_new_one_has_those_of_the_mask(tmp_path: Path) -> None:
    before = os.umask(0o027)
    try:
        replace_file(tmp_path / "new", b"")
        replace_file(tmp_path / "own", b"", mode=0o600)
    finally:
        os.umask(before)
    (tmp_path / "old").write_bytes(OLD)
    (tmp_path / "old").chmod(0o604)
    replace_file(tmp_path / "old", NEW)
    modes = {path.name: stat.S_IMODE(path.stat().st_mode) for path in tmp_path.iterdir()}
    assert modes == {"new": 0o640, "own": 0o600, "old": 0o604}


def test_a_link_is_followed_or_replaced_as_asked(tmp_path: Path) -> None:
    (tmp_path / "file").write_bytes(OLD)
    (tmp_path / "link").symlink_to("file")
    replace_file(tmp_path / "link", NEW)
    assert (tmp_path / "link").is_symlink() and (tmp_path / "file").read_bytes() == NEW
    replace_file(tmp_path / "link", OLD, follow=False)
    assert not (tmp_path / "link").is_symlink() and (tmp_path / "file").read_bytes() == NEW


def test_nobody_writes_through_a_link_that_lies_where_a_part_does(tmp_path: Path) -> None:
    (tmp_path / "secret").write_bytes(OLD)
    (tmp_path / "file.part").symlink_to("secret")
    with pytest.raises(OutputError, match="file: cannot be written"):
        replace_file(tmp_path / "file", NEW)
    os.mkfifo(tmp_path / "other.part")
    with pytest.raises(OutputError, match=r"other\.part: is not a regular file"):
        replace_file(tmp_path / "other", NEW)
    assert (tmp_path / "secret").read_bytes() == OLD


def test_two_runs_do_not_write_one_file_at_once(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("prag_asp.output.atomic_file.PATIENCE", 0.1)
    held = AtomicFile(tmp_path / "file")
    with pytest.raises(OutputError, match=r"file\.part: another run is writing it; wait"):
        replace_file(tmp_path / "file", NEW)
    held.close()
    replace_file(tmp_path / "file", NEW)
    assert content(tmp_path) == {"file": NEW}


def test_a_limit_on_the_size_of_files_is_told_and_leaves_the_old_one(tmp_path: Path) -> None:
    file = tmp_path / "file"
    file.write_bytes(OLD)
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (5000, before[1]))
    try:
        with pytest.raises(OutputError, match="File too large; free some space"):
            replace_file(file, NEW)
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)
    assert content(tmp_path) == {"file": OLD}
