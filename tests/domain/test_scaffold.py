"""`prag-asp new` writes a domain that can be used as it is."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from prag_asp.domain.load import load_domain, load_scene
from prag_asp.domain.scaffold import write_new_domain
from prag_asp.errors import DomainError, OutputError
from prag_asp.space.task_space import TaskSpace

BAD_NAMES = ("", ".", "..", "3d", "my pantry", "pantry/", "pantry.lp", "küche", "-x")


def test_a_new_domain_passes_every_check_and_everything_in_it_has_a_shape(tmp_path: Path) -> None:
    folder = write_new_domain("pantry", tmp_path)
    assert folder == tmp_path / "pantry"
    domain = load_domain(folder)
    assert (domain.name, domain.settings.title, domain.warnings) == ("pantry", "pantry", ())
    assert {action.name for action in domain.facts.actions} == {"pick", "put"}
    assert set(load_scene(domain).shapes) == set(map(str, domain.facts.entities))


def test_a_plain_domain_has_no_robot_and_its_counts_are_those_of_a_search(tmp_path: Path) -> None:
    domain = load_domain(write_new_domain("river", tmp_path, plain=True))
    assert domain.warnings == () and not domain.settings.scene

    def plans(length: int, cars: tuple[str, ...], ferry: str, aboard: int | None, last: str) -> int:
        if not length:
            return 1
        other = {"north": "south", "south": "north"}[ferry]
        found = 0 if last == "cross" else plans(length - 1, cars, other, aboard, "cross")
        if aboard is not None:
            ashore = (*cars[:aboard], ferry, *cars[aboard + 1 :])
            return found + plans(length - 1, ashore, ferry, None, "leave")
        for car in (car for car, place in enumerate(cars) if place == ferry):
            found += plans(length - 1, (*cars[:car], "ferry", *cars[car + 1 :]), ferry, car, "board")
        return found

    for length in range(7):
        assert TaskSpace(domain, length).count("plan") == plans(length, ("north",) * 3, "north", None, "")


@pytest.mark.parametrize("name", ["blocks", "household"])
def test_a_copy_of_a_shipped_domain_has_the_same_facts(tmp_path: Path, name: str) -> None:
    copied = load_domain(write_new_domain("mine", tmp_path, like=name))
    assert copied.facts.actions == load_domain(name).facts.actions and copied.warnings == ()
    assert not (tmp_path / "mine" / "counts.toml").exists()


def test_only_a_shipped_domain_is_copied_and_as_it_is(tmp_path: Path) -> None:
    with pytest.raises(DomainError, match=r"tabletpo: no such shipped domain; did you mean tabletop\?"):
        write_new_domain("mine", tmp_path, like="tabletpo")
    with pytest.raises(DomainError, match="leave --plain or --from out"):
        write_new_domain("mine", tmp_path, like="tabletop", plain=True)
    assert list(tmp_path.iterdir()) == []


def test_a_name_may_be_a_path(tmp_path: Path) -> None:
    assert write_new_domain("rooms/pantry", tmp_path) == tmp_path / "rooms" / "pantry"
    assert write_new_domain(str(tmp_path / "hall"), Path("elsewhere")) == tmp_path / "hall"


def test_nothing_is_overwritten(tmp_path: Path) -> None:
    (tmp_path / "pantry").mkdir()
    (tmp_path / "rooms").write_text("", encoding="utf-8")
    with pytest.raises(DomainError, match="pantry: exists already; choose another name"):
        write_new_domain("pantry", tmp_path)
    with pytest.raises(OutputError, match="the folder cannot be created: Not a directory; choose another"):
        write_new_domain("rooms/pantry", tmp_path)
    assert list((tmp_path / "pantry").iterdir()) == []


@pytest.mark.parametrize(
    ("name", "message"),
    [
        *((name, "cannot name a domain; use letters, digits") for name in BAD_NAMES),
        ("prag", "prag: a shipped domain has this name; choose another"),
    ],
)
def test_a_bad_name_is_refused(tmp_path: Path, name: str, message: str) -> None:
    with pytest.raises(DomainError, match=message):
        write_new_domain(name, tmp_path)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.skipif(os.geteuid() == 0, reason="root may write everywhere")
def test_a_folder_that_cannot_be_written_is_reported(tmp_path: Path) -> None:
    tmp_path.chmod(0o500)
    with pytest.raises(OutputError, match="the folder cannot be created: Permission denied; choose another"):
        write_new_domain("pantry", tmp_path)
