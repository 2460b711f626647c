"""Domains with nothing wrong pass, whatever they use."""

from __future__ import annotations

from fractions import Fraction
from pathlib import Path

import pytest

from prag_asp.domain.load import load_domain
from prag_asp.errors import DomainError
from prag_asp.program.paths import shipped_domains

SWITCH = """
class(lamp).
entity((lamp_1; lamp_2), lamp).
fluent(lit(L)) :- is_a(L,lamp).
action(press(L)) :- is_a(L,lamp).
precondition(press(L), lit(L), false) :- action(press(L)).
postcondition(press(L), lit(L), true) :- action(press(L)).
action(release(L)) :- is_a(L,lamp).
precondition(release(L), lit(L), true) :- action(release(L)).
postcondition(release(L), lit(L), false) :- action(release(L)).
"""


def domain(folder: Path, text: str, settings: str | None = None) -> Path:
    (folder / "domain.lp").write_text(text, encoding="utf-8")
    if settings is not None:
        (folder / "domain.toml").write_text(settings, encoding="utf-8")
    return folder


@pytest.mark.parametrize("name", shipped_domains())
def test_a_shipped_domain_passes(name: str) -> None:
    domain = load_domain(name)
    assert domain.facts.actions and domain.warnings == ()


def test_rules_can_be_added(tmp_path: Path) -> None:
    folder = domain(tmp_path, SWITCH)
    assert not load_domain(folder).facts.closed
    for rules in (("closed_world",), ("no_undo",), ("at_most(press,2)", "no_undo")):
        facts = load_domain(folder, rules=rules).facts
        assert len(facts.actions) == 4 and facts.closed == ("closed_world" in rules)
    assert load_domain(domain(tmp_path, '#include "rules/closed_world.lp".\n' + SWITCH)).facts.closed


@pytest.mark.parametrize(
    ("file", "text"),
    [("scenes/hall.lp", "entity(lamp_3, lamp)."), ("more.lp", '#include "domain.lp".\nentity(lamp_3, lamp).')],
)
def test_files_may_include_others_even_in_a_circle(tmp_path: Path, file: str, text: str) -> None:
    (tmp_path / "scenes").mkdir()
    (tmp_path / file).write_text(text, encoding="utf-8")
    facts = load_domain(domain(tmp_path, f'#include "{file}".\n' + SWITCH)).facts
    assert [str(entity) for entity in facts.entities] == ["lamp_1", "lamp_2", "lamp_3"]


def test_a_step_rule_may_read_what_is_known_at_the_start(tmp_path: Path) -> None:
    known = "initially(lit(lamp_1), true).\n"
    rule = "#program step(t).\n:- occurs(press(lamp_2),t), not holds(lit({}),true,t-1).\n"
    load_domain(domain(tmp_path, SWITCH + known + rule.format("lamp_1")))
    with pytest.raises(DomainError, match=r"domain\.lp:13: .* reads lit\(lamp_2\), which is unknown at the start"):
        load_domain(domain(tmp_path, SWITCH + known + rule.format("lamp_2")))


def test_conditions_on_classes_restrict_what_a_step_rule_reads(tmp_path: Path) -> None:
    more = "old(lamp_1).\ninitially(lit(L), true) :- old(L).\n#program step(t).\n"
    load_domain(domain(tmp_path, SWITCH + more + ":- occurs(press(_),t), old(L), not holds(lit(L),true,t-1).\n"))
    with pytest.raises(DomainError, match=r"domain\.lp:14: .* reads lit\(lamp_2\)"):
        load_domain(domain(tmp_path, SWITCH + more + ":- occurs(press(_),t), not old(L), holds(lit(L),true,t-1).\n"))


def test_helpers_constants_comments_and_shown_predicates_are_allowed(tmp_path: Path) -> None:
    more = """
    #const most = 2.
    number(1..most). bright(L) :- is_a(L,lamp), number(_).
    #show bright/1.   % größer %* no comment *%
    %* a comment %* within *% a comment: ♥ *%
    label("Büro; 50 %*").
    #defined wet/1.
    initially(lit(L), true) :- wet(L), label(_).
    fluent(warm(L)) :- is_a(L,lamp).
    implies(warm(L), lit(L)) :- is_a(L,lamp).
    postcondition(release(L), warm(L), false) :- is_a(L,lamp).
    initially(warm(lamp_1), true).
    action(touch(L)) :- is_a(L,lamp).
    precondition(touch(L), warm(L), true) :- is_a(L,lamp).
    #program step(t).
    used(L,t) :- used(L,t-1).
    used(L,t) :- occurs(press(L),t).
    :- used(L,t-1), occurs(press(L),t).
    """
    loaded = load_domain(domain(tmp_path, SWITCH + more))
    assert "used(L,t-1)" in loaded.program.text
    assert "touch(lamp_1)" in map(str, loaded.facts.actions), "an action that can occur is never pruned"


def test_a_user_rule_that_changes_a_fluent_makes_its_actions_possible(tmp_path: Path) -> None:
    more = """
    fluent(dark).
    initially(dark, false).
    action(sleep).
    precondition(sleep, dark, true).
    """
    (warning,) = load_domain(domain(tmp_path, SWITCH + more)).warnings
    assert warning.text.startswith("sleep can never occur: it needs dark = true, but dark = false from the start")
    own = """
    #program step(t).
    holds(dark,true,t) :- occurs(release(L),t).
    changed(dark,t)    :- occurs(release(L),t).
    """
    assert load_domain(domain(tmp_path, SWITCH + more + own)).warnings == ()


def test_settings_are_optional_and_read_without_rounding(tmp_path: Path) -> None:
    settings = load_domain(domain(tmp_path, SWITCH)).settings
    assert (settings.title, settings.weights, settings.scene) == ("", {}, {})
    assert settings.line_of("weights", "press") == 1
    weights = 'press = 0.1\n"press > release" = 1e-2\nlamp = 3\nlamp_1 = 0\n"press(lamp_2)" = 2\n'
    text = f'title = "Lamps"\n[weights]\n{weights}[language]\npress = "press {{0}}"\n'
    settings = load_domain(domain(tmp_path, SWITCH, text)).settings
    assert (settings.title, settings.language) == ("Lamps", {"press": "press {0}"})
    assert settings.weights["press"] == Fraction(1, 10)
    assert settings.weights["press>release"] == Fraction(1, 100)
    assert settings.weights["lamp_1"] == 0
    assert settings.line_of("weights", "lamp") == 5
