"""A run is resumed from its journal, at whatever moment it was interrupted or killed."""

from __future__ import annotations

import errno
import os
from collections.abc import Callable
from pathlib import Path

import pytest

from prag_asp.errors import OutputError
from prag_asp.output import Journal, journal
from tests.chance import Chance
from tests.output.faults import Disk, content, killed

TOTAL = 12
LINES = [f"line {number} {'x' * number}".encode() for number in range(TOTAL)]


def work(file: Path, run: str = "this", upto: int = TOTAL, resumed: list[int] | None = None) -> None:
    """Write lines after those that are there; be interrupted after some, or end with an empty journal."""
    notes = Journal(file, run)
    try:
        assert notes.lines == LINES[: len(notes.lines)]
        if resumed is not None:
            resumed.append(len(notes.lines))
        for line in LINES[len(notes.lines) : upto]:
            notes.write(line)
        if upto < TOTAL:
            raise KeyboardInterrupt
        notes.clear()
    finally:
        notes.close()


@pytest.fixture(params=[0.0, 1000.0], ids=["flushed after each line", "not flushed"])
def file(request: pytest.FixtureRequest, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setattr(journal, "INTERVAL", request.param)
    return tmp_path / "file.part"


def test_an_interrupted_run_is_resumed_where_it_was_and_a_finished_one_leaves_nothing(file: Path) -> None:
    work(file)
    assert content(file.parent) == {}
    for upto in range(1, TOTAL):
        with pytest.raises(KeyboardInterrupt):
            work(file, upto=upto)
        resumed: list[int] = []
        work(file, resumed=resumed)
        assert resumed == [upto] and content(file.parent) == {}


def test_another_run_begins_anew(file: Path) -> None:
    with pytest.raises(KeyboardInterrupt):
        work(file, upto=5)
    resumed: list[int] = []
    work(file, "other", resumed=resumed)
    assert resumed == [0] and content(file.parent) == {}


def every_failure(file: Path, check: Callable[[int], None]) -> int:
    """Let the disk fail at each of its operations, once and from then on; return how many there are."""
    with Disk().working() as disk:
        work(file)
    total = len(disk.asked)
    for code in (errno.ENOSPC, errno.EIO):
        for times in (1, 10**6):
            for number in range(1, total + 1):
                with Disk(number, times, code).working(), pytest.raises(OutputError, match=r"file\.part: cannot be"):
                    work(file)
                resumed: list[int] = []
                work(file, resumed=resumed)
                check(resumed[0])
                assert content(file.parent) == {}
    return total


def test_at_each_failure_of_the_disk_the_lines_before_it_are_there(file: Path) -> None:
    found: list[int] = []
    assert every_failure(file, found.append) >= TOTAL + 3
    assert {*range(1, TOTAL)} <= {*found}


def test_at_each_moment_of_a_kill_the_lines_before_it_are_there(file: Path) -> None:
    number, before = 0, 0
    while True:
        number += 1
        if not killed(number, lambda: work(file)):
            break
        resumed: list[int] = []
        if number % 2:  # and once more, while it is being resumed
            killed(3, lambda: work(file))
        work(file, resumed=resumed)
        assert content(file.parent) == {}
        before = max(before, resumed[0])
    assert number > TOTAL and before >= TOTAL - 1


def test_what_was_cut_or_changed_since_is_not_believed(
    file: Path, monkeypatch: pytest.MonkeyPatch, chance: Chance
) -> None:
    monkeypatch.setattr(os, "fsync", lambda descriptor: None)
    random = chance.generator(5)
    for _ in range(chance.examples(150)):
        with pytest.raises(KeyboardInterrupt):
            work(file, upto=random.randint(2, 9))
        damaged = bytearray(file.read_bytes())
        if random.random() < 0.5:
            del damaged[random.randrange(len(damaged)) :]
        else:
            damaged[random.randrange(len(damaged))] ^= 1 << random.randrange(8)
        file.write_bytes(damaged)
        work(file)  # which compares the lines that are believed
        assert content(file.parent) == {}


@pytest.mark.parametrize("damaged", [b"", b"torn", b"00000000this\n", b"\xff" * 10**5, b"\n\n"])
def test_a_file_that_is_no_journal_is_as_if_it_was_not_there(tmp_path: Path, damaged: bytes) -> None:
    (tmp_path / "file.part").write_bytes(damaged)
    resumed: list[int] = []
    work(tmp_path / "file.part", resumed=resumed)
    assert resumed == [0] and content(tmp_path) == {}


def test_two_runs_do_not_write_one_journal_at_once(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("prag_asp.output.atomic_file.PATIENCE", 0.05)
    first = Journal(tmp_path / "file.part", "this")
    with pytest.raises(OutputError, match="another run is writing it"):
        Journal(tmp_path / "file.part", "this")
    first.close()
    work(tmp_path / "file.part")
