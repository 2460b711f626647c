"""The linter reports composites that can never occur exactly where brute force over all states says so."""

from __future__ import annotations

import re
from pathlib import Path

from hypothesis import assume, given, settings
from hypothesis import strategies as st

from prag_asp.domain.load import load_domain
from tests.brute_force import State, Toy
from tests.chance import examples
from tests.lint.test_good_domains import SWITCH, domain
from tests.lint.test_occurrence import plain, report, states_with, unchanged
from tests.strategies import hierarchies

TWICE = """
composite(twice(L)) :- is_a(L,lamp).
stage(twice(L), 1, press(L)) :- is_a(L,lamp).
stage(twice(L), 2, release(L)) :- is_a(L,lamp).
"""


def executes(toy: Toy, states: frozenset[State], word: tuple[int, ...]) -> bool:
    for action in word:
        states = toy.after(states, (), action)
    return bool(states)


@settings(max_examples=examples(40))
@given(st.one_of(hierarchies(closed=False), hierarchies(closed=True)))
def test_a_composite_is_reported_if_and_only_if_no_state_executes_it(toy: Toy) -> None:
    toy = plain(toy)
    assume(toy.start())
    states = states_with(toy, unchanged(toy, range(len(toy.actions))))
    assume(all(toy.after(states, (), i) for i in range(len(toy.actions))))
    said = report(toy)
    first = len(toy.actions)
    never = {i for i in range(len(toy.composites)) if not executes(toy, states, toy.word(first + i))}
    innermost = {i for i in never if not {first + other for other in never} & set(toy.composites[i])}
    units = (*toy.free, *range(first, first + len(toy.composites)))
    stuck = not any(executes(toy, toy.start(), toy.word(unit)) for unit in units)
    some_can = len(never) < len(toy.composites)
    assert ("no composite and no free action can begin" in said) == (stuck and some_can)
    if not stuck or not some_can:
        assert {int(number) for number in re.findall(r"c(\d+) can never occur", said)} == innermost
    assert all("warning" in line for line in said.splitlines()) and ("[no-plan]" in said) == stuck
    assert bool(said) == bool(never or stuck)


def test_a_hierarchy_without_mistakes_passes_and_a_step_rule_may_read_what_is_ahead(tmp_path: Path) -> None:
    rule = "#program step(t).\n:- occurs(press(lamp_1),t), _ahead((),t-1).\n"
    loaded = load_domain(domain(tmp_path, SWITCH + TWICE + rule))
    facts = loaded.facts
    assert [str(composite) for composite in facts.composites] == ["twice(lamp_1)", "twice(lamp_2)"]
    stages = facts.stages[facts.composites[0]]
    assert [(str(number), str(part)) for number, part in stages] == [("1", "press(lamp_1)"), ("2", "release(lamp_1)")]
    assert "_ahead" in loaded.program.text and loaded.warnings == ()


def test_user_rules_that_change_the_state_are_trusted(tmp_path: Path) -> None:
    text = SWITCH + TWICE.replace("2, release", "2, press") + "free(press(L)) :- is_a(L,lamp).\n"
    (warning,) = load_domain(domain(tmp_path, text)).warnings
    assert "twice(lamp_1) can never occur: its action 2, press(lamp_1), needs" in warning.text
    own = "#program step(t).\nholds(lit(L),false,t) :- occurs(press(L),t).\n"
    assert load_domain(domain(tmp_path, text + own)).warnings == ()


def test_without_composites_the_program_is_that_of_a_domain_that_knows_none(tmp_path: Path) -> None:
    for text, flat in ((SWITCH + "% no composite here\n", False), (SWITCH + TWICE, True), (SWITCH + TWICE, False)):
        program = load_domain(domain(tmp_path, text), flat=flat).program
        has_hierarchy = "hierarchy.lp" in {source.path.name for source in program.sources}
        assert has_hierarchy == (TWICE in text and not flat)
