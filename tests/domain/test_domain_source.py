"""A domain may be a name, a folder, files, standard input, or a text that a program wrote."""

from __future__ import annotations

import io
import sys
from pathlib import Path

import pytest

from prag_asp import TaskSpace, load_domain, load_scene
from prag_asp.errors import DomainError, SceneError
from prag_asp.program.paths import shipped_domains

LAMPS = """\
class(lamp).
entity((lamp_1; lamp_2), lamp).
fluent(lit(L)) :- is_a(L,lamp).
"""
ACTIONS = """\
action(press(L)) :- is_a(L,lamp).
postcondition(press(L), lit(L), true) :- action(press(L)).
"""


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    (tmp_path / "lamps.lp").write_text(LAMPS, encoding="utf-8")
    (tmp_path / "actions.lp").write_text(ACTIONS, encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    return tmp_path


def standard_input(monkeypatch: pytest.MonkeyPatch, content: bytes) -> None:
    monkeypatch.setattr(sys, "stdin", io.TextIOWrapper(io.BytesIO(content)))


def test_files_texts_and_standard_input_together_are_one_domain_named_after_the_first(
    folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    one = load_domain("lamps.lp", "actions.lp")
    assert (one.name, one.folder) == ("lamps", None) and TaskSpace(one, 2).count() > 0
    standard_input(monkeypatch, b"\xef\xbb\xbf" + ACTIONS.replace("\n", "\r\n").encode())
    others = {
        "actions": load_domain(folder / "actions.lp", folder / "lamps.lp"),
        "text": load_domain(text=LAMPS + ACTIONS),
        "lamps": load_domain("lamps.lp", text=ACTIONS),
        "stdin": load_domain("-", "lamps.lp", "-"),
    }
    for name, other in others.items():
        assert other.name == name and other.facts == one.facts


def test_each_file_includes_from_its_own_folder_and_a_folder_may_be_named_like_a_file(folder: Path) -> None:
    (folder / "parts").mkdir()
    (folder / "parts" / "more.lp").write_text('#include "here.lp".', encoding="utf-8")
    (folder / "parts" / "here.lp").write_text("entity(lamp_3, lamp).", encoding="utf-8")
    (folder / "hall.lp").mkdir()
    (folder / "hall.lp" / "domain.lp").write_text(LAMPS + ACTIONS, encoding="utf-8")
    hall = load_domain("hall.lp")
    assert hall.name == "hall.lp" and hall.folder == Path("hall.lp"), "its name ends like that of a file"
    domain = load_domain("lamps.lp", "actions.lp", "parts/more.lp", text='#include "parts/here.lp".')
    assert [str(entity) for entity in domain.facts.entities] == ["lamp_1", "lamp_2", "lamp_3"]
    with pytest.raises(DomainError, match=r"more\.lp:1: cannot include"):
        (folder / "parts" / "more.lp").write_text('#include "../lamps.lp".', encoding="utf-8")
        load_domain("lamps.lp", "actions.lp", "parts/more.lp")


def test_a_file_given_and_included_counts_once(folder: Path) -> None:
    (folder / "all.lp").write_text('#include "lamps.lp".\n#include "actions.lp".\n#include "all.lp".', encoding="utf-8")
    assert load_domain("all.lp", "lamps.lp", "lamps.lp").facts == load_domain("lamps.lp", "actions.lp").facts


@pytest.mark.parametrize("engine", ["automaton", "clingo", "sat", "sharp", "symbolic"])
def test_a_step_rule_counts_wherever_it_stands(folder: Path, engine: str) -> None:
    rule = "#program step(t).\n:- occurs(A,t), occurs(A,t-1).\n"
    (folder / "rule.lp").write_text(rule, encoding="utf-8")
    spaces = [
        TaskSpace(domain, 4, engine=engine)
        for domain in (load_domain("lamps.lp", "actions.lp", "rule.lp"), load_domain(text=LAMPS + ACTIONS + rule))
    ]
    assert {space.count("plan") for space in spaces} == {2}  # of 16: the two that alternate
    assert {space.count() for space in spaces} == {1}
    for space in spaces:
        assert len(space.sample(5, seed=1, weights={"press": 2})) == 5


def test_mistakes_are_reported_with_the_file_and_the_line(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    with pytest.raises(DomainError, match=r"^<text>:6: unknown predicate spare/1"):
        load_domain(text=f"{LAMPS}{ACTIONS}spare(1).", strict=True)
    standard_input(monkeypatch, f"{ACTIONS}spare(.".encode())
    with pytest.raises(DomainError, match=r"^<stdin>:3: unexpected \. at column 7"):
        load_domain("lamps.lp", "-")
    (folder / "actions.lp").write_text(f"{ACTIONS}\nspare(1).", encoding="utf-8")
    with pytest.raises(DomainError, match=r"^actions\.lp:4: unknown predicate spare/1"):
        load_domain("lamps.lp", "actions.lp", strict=True)
    standard_input(monkeypatch, b'a.\nb("\xff").')
    with pytest.raises(DomainError, match=r"^<stdin>:2: not UTF-8 text"):
        load_domain("-")
    with pytest.raises(DomainError, match=r"^<text>:2: half of a surrogate pair is not a character"):
        load_domain(text="a.\n% \ud800")
    monkeypatch.setattr(sys, "stdin", None)
    with pytest.raises(DomainError, match="standard input is closed"):
        load_domain("-")


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ((), "no domain; give a shipped domain's name, a folder, .lp files, two PDDL files, or a text"),
        (("prag", "lamps.lp"), "prag lamps.lp: prag is not a file that ends in .lp; give one name or folder, or files"),
        (("lamps.lp", "hanoi", "prag"), "lamps.lp hanoi prag: hanoi is not a file that ends in .lp; give one name"),
        (("missing.lp",), "missing.lp:1: cannot be read: No such file or directory"),
        (("notes.txt",), "notes.txt: a file, but its name does not end in .lp; rename it, or give the domain's folder"),
        (("tabeltop",), "tabeltop: no such domain; did you mean tabletop?"),
    ],
)
def test_what_is_no_domain_is_reported(folder: Path, given: tuple[str, ...], message: str) -> None:
    (folder / "notes.txt").write_text(LAMPS + ACTIONS, encoding="utf-8")
    with pytest.raises(DomainError) as caught:
        load_domain(*given)
    assert str(caught.value).startswith(message)


def test_files_come_without_settings_and_learned_rules_unless_settings_are_given(folder: Path) -> None:
    tabletop = shipped_domains()["tabletop"]
    plain = load_domain(tabletop / "domain.lp")
    assert not plain.settings.scene and not plain.settings.weights and plain.name == "domain"
    with pytest.raises(SceneError, match=r"domain: files have no \[scene\] of their own; give settings"):
        load_scene(plain)
    given = load_domain(tabletop / "domain.lp", settings=tabletop / "domain.toml")
    assert load_scene(given) == load_scene(load_domain("tabletop"))
    with pytest.raises(DomainError, match=r"none\.toml: no such file of settings"):
        load_domain("lamps.lp", "actions.lp", settings="none.toml")


def test_settings_may_replace_those_of_a_folder_and_paths_in_them_begin_at_theirs(folder: Path) -> None:
    (folder / "domain.lp").write_text(LAMPS + ACTIONS, encoding="utf-8")
    (folder / "domain.toml").write_text("[weights]\npress = 2\n", encoding="utf-8")
    (folder / "learned.lp").write_text("impossible(lit(lamp_1), lit(lamp_2)).\n", encoding="utf-8")
    (folder / "other").mkdir()
    (folder / "other" / "mine.toml").write_text("[weights]\npress = 3\n", encoding="utf-8")
    assert load_domain(folder).settings.weights == {"press": 2} and load_domain(folder).learned
    other = load_domain(folder, settings=folder / "other" / "mine.toml")
    assert other.settings.weights == {"press": 3} and not other.learned
    (folder / "other" / "mine.toml").write_text("[weights]\npres = 3\n", encoding="utf-8")
    with pytest.raises(DomainError, match=r"mine\.toml:2: weights.pres"):
        load_domain(folder, settings=folder / "other" / "mine.toml")
