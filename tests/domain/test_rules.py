"""Rules are asked for by name; what does not fit is message in one line."""

from __future__ import annotations

from pathlib import Path

import pytest

from prag_asp.domain.load import load_domain
from prag_asp.errors import DomainError
from prag_asp.program.paths import BY_LIBRARY, data_folder
from tests.lint.test_good_domains import SWITCH, domain

WRONG = [
    ("nope", r"^nope: no such rule; there are at_most, closed_world, ever, no_undo in .*rules$"),
    ("no_und", r"^no_und: no such rule; did you mean no_undo\?$"),
    ("weights", r"^weights: no such rule; there are at_most, closed_world, ever, no_undo in .*rules$"),
    ("canonical_names", r"^canonical_names: no such rule; there are "),
    ("../contract", r"no such rule; "),
    ("no_undo(1)", r"^no_undo\(1\): the rule no_undo takes no arguments; write no_undo$"),
    ("at_most(press)", r"^at_most\(press\): the rule at_most takes 2 arguments, not 1; see the head of .*at_most\.lp$"),
    ("at_most(pres,1)", r"^rule at_most\(pres,1\):1: at_most refers to pres, .* action; did you mean press\?$"),
    ("at_most(fly,1)", r"^rule at_most\(fly,1\):1: at_most refers to fly, .*; actions are press, release$"),
    ("at_most(press(lamp_1),1)", r":1: at_most refers to press\(lamp_1\), .*; give the name alone, press$"),
    ("at_most(press,x)", r":1: press cannot occur at most x times; write a number, as in at_most\(press,2\)$"),
    ("at_most(press,-1)", r":1: press cannot occur at most -1 times; write a number, as in at_most\(press,2\)$"),
]


@pytest.mark.parametrize(("rule", "said"), WRONG)
def test_a_rule_that_does_not_fit_is_reported_in_one_line(tmp_path: Path, rule: str, said: str) -> None:
    with pytest.raises(DomainError, match=said) as caught:
        load_domain(domain(tmp_path, SWITCH), rules=(rule,))
    assert "\n" not in str(caught.value)


def test_a_limit_of_the_domain_is_read_by_the_rule_that_is_asked_for(tmp_path: Path) -> None:
    limited = domain(tmp_path, SWITCH + "at_most(press,1).\n")
    assert load_domain(limited, rules=("at_most",)).facts.actions
    with pytest.raises(
        DomainError, match=r"domain\.lp:11: at_most has no effect, because no rule reads it; add #include"
    ):
        load_domain(limited)


@pytest.mark.parametrize("folder", [".", "missing", "others"])
def test_a_folder_without_a_contract_holds_no_encodings(tmp_path: Path, folder: str) -> None:
    (tmp_path / "others").mkdir()
    (tmp_path / "others" / "other.lp").write_text("a.", encoding="utf-8")
    with pytest.raises(DomainError, match=r"this folder of encodings has no contract\.lp; copy the shipped encodings"):
        load_domain("hanoi", encodings=tmp_path / folder)


def test_a_file_that_begins_with_a_byte_order_mark_is_read_with_its_lines_in_place(tmp_path: Path) -> None:
    settings = 'title = "Lamps"\n'
    (tmp_path / "domain.lp").write_bytes(b"\xef\xbb\xbf" + SWITCH.encode())
    (tmp_path / "domain.toml").write_bytes(b"\xef\xbb\xbf" + settings.encode())
    assert load_domain(tmp_path).settings.title == "Lamps"
    (tmp_path / "domain.lp").write_bytes(b"\xef\xbb\xbf" + b"\xef\xbb\xbf" + SWITCH.encode())
    with pytest.raises(DomainError, match=r"domain\.lp:1: the character '\\ufeff' is not allowed here; use a-z"):
        load_domain(tmp_path)
    (tmp_path / "domain.lp").write_bytes(SWITCH.encode("utf-16"))
    with pytest.raises(DomainError, match=r"domain\.lp:1: not UTF-8 text; save the file as UTF-8"):
        load_domain(tmp_path)


def test_every_rule_that_is_not_added_by_the_library_can_be_selected() -> None:
    names = {path.stem for path in (data_folder("encodings") / "rules").glob("*.lp")}
    for name in names - BY_LIBRARY:
        assert load_domain("hanoi", rules=(name,)).facts.actions


def test_what_may_ever_be_true_is_open_at_the_start_or_made_so_for_sure_or_perhaps() -> None:
    found = load_domain(
        text='#include "rules/ever.lp". fluent((open;perhaps;made;shut;lost)). '
        "initially((perhaps;made;shut),false). initially(lost,true). action(begin). postcondition(begin,lost,false). "
        "postcondition(begin,perhaps,unknown). postcondition(begin,made,true). "
        "action(ask(F)) :- fluent(F), ever(F). precondition(ask(F),F,true) :- action(ask(F))."
    )
    assert sorted(map(str, found.facts.actions)) == [
        "ask(lost)", "ask(made)", "ask(open)", "ask(perhaps)", "begin",
    ]  # fmt: skip
