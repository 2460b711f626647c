"""A file of lines goes on where a run of the same was broken off, at whatever moment that was."""

from __future__ import annotations

import errno
import json
import os
from collections.abc import Callable
from pathlib import Path

import pytest

from prag_asp.errors import OutputError
from prag_asp.output import Lines, lines
from tests.chance import Chance
from tests.output.faults import Disk, content, killed

TOTAL = 12
TEXT = "".join(f"line {number} {'x' * number}\n" for number in range(1, TOTAL + 1)).encode()


def work(file: Path, run: str | None = "this", upto: int = TOTAL, told: list[int] | None = None) -> None:
    """Write lines, each third of them together with a step that has none; be broken off after some."""
    out = Lines(file, run)
    try:
        begun = out.state or {"step": 0}
        for step in range(begun["step"] + 1, TOTAL * 4 // 3 + 1):
            number = step - step // 4
            if told is not None:
                told.append(step)
            out.write(None if step % 4 == 0 else f"line {number} {'x' * number}", {"step": step})
            if out.lines == upto < TOTAL:
                raise KeyboardInterrupt
        out.finish()
    except BaseException:
        out.suspend()
        raise
    finally:
        out.close()


@pytest.fixture(params=[0.0, 1000.0], ids=["noted after each line", "noted at the end"])
def file(request: pytest.FixtureRequest, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setattr(lines, "INTERVAL", request.param)
    if request.param:
        monkeypatch.setattr(lines, "HELD", 40)
    return tmp_path / "file"


def test_a_run_that_is_broken_off_goes_on_where_it_was(file: Path) -> None:
    work(file)
    assert content(file.parent) == {"file": TEXT}
    for upto in range(1, TOTAL):
        file.write_bytes(b"old\n")
        with pytest.raises(KeyboardInterrupt):
            work(file, upto=upto)
        assert file.read_bytes() == b"old\n"
        assert TEXT.startswith((file.parent / "file.part").read_bytes())
        told: list[int] = []
        work(file, told=told)
        assert content(file.parent) == {"file": TEXT}
        assert len(told) <= TOTAL * 4 // 3 - upto


def test_another_run_begins_anew_and_one_without_a_name_leaves_nothing(file: Path) -> None:
    for run in ("other", None):
        with pytest.raises(KeyboardInterrupt):
            work(file, upto=5)
        told: list[int] = []
        work(file, run, told=told)
        assert told[0] == 1 and content(file.parent) == {"file": TEXT}
    with pytest.raises(KeyboardInterrupt):
        work(file, None, upto=5)
    assert content(file.parent) == {"file": TEXT}


def every_failure(file: Path, write: Callable[[], None], check: Callable[[bool], None]) -> int:
    """Let the disk fail at each of its operations, once and from then on; return how many there are."""
    with Disk().working() as disk:
        write()
    total = len(disk.asked)
    for code in (errno.ENOSPC, errno.EIO):
        for times in (1, 10**6):
            for number in range(1, total + 1):
                file.write_bytes(b"old\n")
                ended = True
                try:
                    with Disk(number, times, code).working():
                        write()
                except OutputError:
                    ended = False
                check(ended)
                write()
                assert content(file.parent) == {"file": TEXT}
    return total


def test_at_each_failure_of_the_disk_the_old_file_stays_or_the_new_one_is_whole(file: Path) -> None:
    def check(ended: bool) -> None:
        assert file.read_bytes() in ((TEXT,) if ended else (TEXT, b"old\n"))

    assert every_failure(file, lambda: work(file), check) >= 6


def test_at_each_moment_of_a_kill_the_old_file_stays_and_the_run_goes_on(file: Path) -> None:
    number = 0
    while True:
        number += 1
        file.write_bytes(b"old\n")
        if not killed(number, lambda: work(file)):
            break
        assert file.read_bytes() in (TEXT, b"old\n")
        if number % 2:  # and once more, in the middle of going on
            killed(4, lambda: work(file))
        work(file)
        assert content(file.parent) == {"file": TEXT}
    assert number > 6


def test_what_was_cut_or_changed_since_is_not_believed(
    file: Path, monkeypatch: pytest.MonkeyPatch, chance: Chance
) -> None:
    monkeypatch.setattr(os, "fsync", lambda descriptor: None)
    random = chance.generator(5)
    part, note = file.parent / "file.part", file.parent / "file.run"
    for _ in range(chance.examples(150)):
        with pytest.raises(KeyboardInterrupt):
            work(file, upto=random.randint(2, 9))
        victim = random.choice([part, note])
        damaged = bytearray(victim.read_bytes())
        if random.random() < 0.5:
            del damaged[random.randrange(len(damaged)) :]
        else:
            damaged[random.randrange(len(damaged))] ^= 1 << random.randrange(8)
        victim.write_bytes(damaged)
        work(file)
        assert content(file.parent) == {"file": TEXT}


@pytest.mark.parametrize("note", [b"", b"[1]", b'{"run": "this"}', b"[" * 10**5, b"\xff", b"[0,1,2,3,4,5,6]"])
def test_a_note_that_is_none_is_as_if_it_was_not_there(tmp_path: Path, note: bytes) -> None:
    (tmp_path / "file.run").write_bytes(note)
    (tmp_path / "file.part").write_bytes(b"torn")
    work(tmp_path / "file")
    assert content(tmp_path) == {"file": TEXT}


def test_what_waits_does_not_grow_with_what_was_written(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(lines, "HELD", 1000)
    out = Lines(tmp_path / "file", "this")
    for number in range(10_000):
        out.write(f"line {number}")
        assert len(out._written.waiting) < 200
    out.finish()
    out.close()
    assert (tmp_path / "file").read_text().splitlines()[-1] == "line 9999"


def test_the_note_says_how_far_the_run_is(tmp_path: Path) -> None:
    with pytest.raises(KeyboardInterrupt):
        work(tmp_path / "file", upto=5)
    _, version, run, size, _, count, state = json.loads((tmp_path / "file.run").read_text())
    assert (version, run, count, state) == (1, "this", 5, {"step": 6})
    assert size == (tmp_path / "file.part").stat().st_size
