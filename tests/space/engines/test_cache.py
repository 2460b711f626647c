"""A cache that is believed only where it is whole, its own, and of this very program."""

from __future__ import annotations

import json
import os
import zlib
from collections.abc import Iterator
from dataclasses import replace
from io import BytesIO
from pathlib import Path

import numpy as np
import pytest

from prag_asp import Domain, TaskSpace, load_domain
from prag_asp.logic.domain_logic import DomainLogic
from prag_asp.output.cache_files import cache_folder
from prag_asp.space.engines import cache, stored_automata
from prag_asp.space.engines.automaton_engine import AutomatonEngine
from prag_asp.space.engines.cache import CacheEntry, read_entry, write_entry
from prag_asp.space.limits import Limits
from tests.domains import domain_of
from tests.logic.symmetry.test_unit_symmetry import SAUCERS

KEY = "0123"
ENTRY = CacheEntry(
    {"letters": ["a", "b"], "horizon": None},
    {"offsets": np.arange(3), "flags": np.array([[True, False]]), "none": np.zeros((0, 4), dtype=np.int32)},
)


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """A cache of its own, where everything is worth keeping."""
    monkeypatch.setenv("PRAG_ASP_CACHE", str(tmp_path / "cache"))
    monkeypatch.setattr("prag_asp.space.engines.automaton_engine.WORTH_KEEPING", 0)
    return tmp_path / "cache"


def files(folder: Path) -> list[Path]:
    return sorted(folder.iterdir()) if folder.exists() else []


def test_what_is_written_is_read_back(folder: Path) -> None:
    assert write_entry(folder, KEY, ENTRY)
    found = read_entry(folder, KEY, ENTRY.arrays)
    assert found is not None and found.texts == ENTRY.texts
    assert list(found.arrays) == list(ENTRY.arrays)
    for name, array in ENTRY.arrays.items():
        assert np.array_equal(found.arrays[name], array) and found.arrays[name].dtype == array.dtype
    assert [path.name for path in files(folder)] == [f"{KEY}.arrays"]


def test_every_single_damage_is_noticed(folder: Path) -> None:
    write_entry(folder, KEY, ENTRY)
    path = files(folder)[0]
    content = path.read_bytes()
    for place in range(len(content)):
        path.write_bytes(content[:place] + bytes([content[place] ^ 1]) + content[place + 1 :])
        assert read_entry(folder, KEY, ENTRY.arrays) is None
        path.write_bytes(content[:place])
        assert read_entry(folder, KEY, ENTRY.arrays) is None
    path.write_bytes(content + b"\0")
    assert read_entry(folder, KEY, ENTRY.arrays) is None
    path.write_bytes(content)
    assert read_entry(folder, KEY, ENTRY.arrays) is not None


def test_numpy_reads_the_file_without_pickle(folder: Path) -> None:
    write_entry(folder, KEY, ENTRY)
    with np.load(files(folder)[0], allow_pickle=False) as archive:
        assert set(archive.files) == {*ENTRY.arrays, "header"}
        assert np.array_equal(archive["flags"], ENTRY.arrays["flags"])


@pytest.mark.parametrize("damage", ["pickle", "no archive", "no header", "the format of before"])
def test_what_only_looks_like_an_entry_is_not_believed(folder: Path, damage: str) -> None:
    folder.mkdir()
    buffer = BytesIO()
    if damage == "pickle":
        header = np.frombuffer(json.dumps({"key": KEY, "texts": {}}).encode(), np.uint8)
        np.savez(buffer, header=header, offsets=np.array([print], dtype=object))
    elif damage == "no header":
        np.savez(buffer, offsets=np.arange(3))
    else:
        buffer.write(b"PK\3\4 and nothing else" if damage == "no archive" else b"prag_asp cache 1\n" + bytes(60))
    content = buffer.getvalue()
    (folder / f"{KEY}.arrays").write_bytes(content + zlib.crc32(content).to_bytes(4, "little"))
    assert read_entry(folder, KEY, ENTRY.arrays) is None


def test_a_file_under_the_key_of_another_is_not_believed(folder: Path) -> None:
    write_entry(folder, KEY, ENTRY)
    files(folder)[0].rename(folder / "4567.arrays")
    assert read_entry(folder, "4567", ENTRY.arrays) is None


def test_the_folder_stays_small_and_keeps_what_was_read_last(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    for number in range(4):
        write_entry(folder, str(number), ENTRY)
        os.utime(folder / f"{number}.arrays", (number, number))
    read_entry(folder, "0", ENTRY.arrays)
    size = files(folder)[0].stat().st_size
    monkeypatch.setattr(cache, "LARGEST_FOLDER", 3 * size)
    write_entry(folder, "4", ENTRY)
    assert [path.stem for path in files(folder)] == ["0", "3", "4"]
    monkeypatch.setattr(cache, "LARGEST_FILE", 10)
    assert not write_entry(folder, "5", ENTRY)


def test_a_folder_that_cannot_be_written_is_no_error(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    assert not write_entry(tmp_path / "file" / "cache", KEY, ENTRY)
    assert read_entry(tmp_path / "file" / "cache", KEY, ENTRY.arrays) is None


def test_the_folder_is_the_users_own_or_none(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PRAG_ASP_CACHE", "")
    assert cache_folder() is None
    monkeypatch.setenv("PRAG_ASP_CACHE", "/somewhere")
    assert cache_folder() == Path("/somewhere")
    monkeypatch.delenv("PRAG_ASP_CACHE")
    monkeypatch.setenv("XDG_CACHE_HOME", "/xdg")
    assert cache_folder() == Path("/xdg/prag_asp")
    monkeypatch.setenv("XDG_CACHE_HOME", "")
    monkeypatch.setenv("HOME", "/home/me")
    assert cache_folder() == Path("/home/me/.cache/prag_asp")


CUPS = """
class(cup). entity(cup_1,cup). entity(cup_2,cup). fluent(clean). initially(clean,true).
action(wash(C)) :- entity(C,cup). action(dry(C)) :- entity(C,cup).
"""


def answers(space: TaskSpace) -> list[object]:
    return [
        [space.count(by) for by in ("plan", "task", "skeleton")],
        space.count("task", ["grasp"]),
        list(space.enumerate("task"))[:50],
        str(space[17]),
        space.index(space[17]),
        [str(task) for task in space.sample(5, seed=1)],
    ]


def test_a_second_run_answers_the_same_without_grounding_a_step(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def domain() -> Domain:
        return replace(load_domain("prag"))  # which has no ground step yet

    fresh = answers(TaskSpace(domain(), 3, limits=Limits(cached=False)))
    assert not files(folder)
    assert answers(TaskSpace(domain(), 3)) == fresh
    assert len(files(folder)) == 3
    assert answers(TaskSpace(domain(), 3)) == fresh

    def refuse(*_: object, **__: object) -> None:
        raise AssertionError("the step was ground")

    monkeypatch.setattr("prag_asp.logic.ground.ground_step.ground_step", refuse)
    again = TaskSpace(domain(), 3)
    assert [again.count(by) for by in ("plan", "task", "skeleton")] == fresh[0]
    with pytest.raises(AssertionError, match="was ground"):
        TaskSpace(domain(), 3, limits=Limits(cached=False)).count("plan")


@pytest.mark.parametrize("level", ["plan", "task"])
def test_merged_states_are_kept_as_well(folder: Path, level: str) -> None:
    model = DomainLogic(load_domain("blocks"))
    first = AutomatonEngine(model, level, merge=True)
    words = list(first.words(6))
    again = AutomatonEngine(DomainLogic(load_domain("blocks")), level, merge=True)
    assert again.explored(6).merged is not None and list(again.words(6)) == words
    assert [again.rank(word) for word in words[:40]] == list(range(40))
    assert AutomatonEngine(model, level, merge=False).explored(6).merged is None


@pytest.mark.parametrize("level", ["plan", "task"])
def test_states_merged_by_units_are_kept_with_their_units(folder: Path, level: str) -> None:
    plain = AutomatonEngine(DomainLogic(domain_of(SAUCERS)), level, merge=False)
    words = list(plain.words(4))
    for _ in range(2):
        engine = AutomatonEngine(DomainLogic(domain_of(SAUCERS)), level, merge=True)
        merged = engine.explored(4).merged
        assert merged is not None and [len(unit) for units in merged.groups for unit in units] == [2, 2, 2]
        assert list(engine.words(4)) == words
        assert [engine.unrank(4, rank) for rank in range(len(words))] == words
    assert len(files(folder)) == 2


def test_another_length_rule_or_level_is_never_answered_from_the_wrong_file(folder: Path) -> None:
    domains = [load_domain("blocks", rules=rules) for rules in ((), ("no_undo",), ("at_most(stack,1)",))]
    uncached = [TaskSpace(domain, 0, limits=Limits(cached=False)) for domain in domains]
    for _ in range(2):
        for domain, space in zip(domains, uncached, strict=True):
            for length in (3, 7, 5):
                for by in ("plan", "task", "skeleton"):
                    assert TaskSpace(domain, length).count(by) == space.at(length).count(by)


def test_parts_of_different_spaces_are_kept_apart(folder: Path) -> None:
    """Under both conditions cup_1 and cup_2 are interchangeable; where the one is held out, they are not."""
    for _ in range(2):
        space = TaskSpace(domain_of(CUPS), 2).where("uses cup_2")
        part, asked = space.hold_out("cup_1")[1], space.where("uses cup_1")
        assert (part.count(), asked.count()) == (8, 4)


def test_a_damaged_cache_is_rebuilt_silently(folder: Path) -> None:
    domain = load_domain("prag")
    assert TaskSpace(domain, 3).count("plan") == 2800
    path = files(folder)[0]
    content = path.read_bytes()
    path.write_bytes(content[: len(content) // 2])
    assert TaskSpace(domain, 3).count("plan") == 2800
    assert path.read_bytes() == content


def test_arrays_that_do_not_make_an_automaton_are_not_believed(folder: Path) -> None:
    domain = load_domain("prag")
    TaskSpace(domain, 3).count("plan")
    key = files(folder)[0].stem
    entry = read_entry(folder, key, ENTRY.arrays)
    assert entry is not None
    shelf = stored_automata.automaton_slot(folder, DomainLogic(domain), "plan", None)
    assert shelf is not None and shelf.key == key and shelf.read() is not None
    for name, array in entry.arrays.items():
        for wrong in (array[:-1], array.astype(np.int64) + 10**6, array.reshape(1, -1)):
            write_entry(folder, key, CacheEntry(entry.texts, {**entry.arrays, name: wrong}))
            assert shelf.read() is None, (name, wrong)
    write_entry(folder, key, CacheEntry({**entry.texts, "names": []}, entry.arrays))
    assert shelf.read() is None
    write_entry(folder, key, CacheEntry({}, entry.arrays))
    assert shelf.read() is None
