"""The linter reports an action that can never occur exactly where brute force over all states says so."""

from __future__ import annotations

import itertools
import re
import tempfile
from dataclasses import replace
from pathlib import Path

from hypothesis import given, settings
from hypothesis import strategies as st

from prag_asp.domain.load import load_domain
from prag_asp.errors import DomainError
from tests.brute_force import State, Toy, Values, agrees
from tests.chance import examples
from tests.strategies import toys


def report(toy: Toy) -> str:
    """Return what the linter says of a toy: its errors, or else its warnings."""
    with tempfile.TemporaryDirectory() as folder:
        (Path(folder) / "domain.lp").write_text(toy.text(), encoding="utf-8")
        try:
            return "\n".join(map(str, load_domain(folder).warnings))
        except DomainError as error:
            return str(error)


def plain(toy: Toy) -> Toy:
    """Return a toy without rules across time and what physics proves, which can only forbid more."""
    return replace(toy, never_after=(), at_most={}, blocked=(), impossible=(), goal={})


def occurring(toy: Toy) -> set[int]:
    """Return the actions that some state executes which agrees with the start on what no such action changes."""
    able = set(range(len(toy.actions)))
    while True:
        changing = {fluent for i in able for fluent in toy.actions[i].after}
        values = {f: {state[f] for state in toy.start()} for f in range(toy.fluents) if f not in changing}
        fixed: Values = {f: found.pop() for f, found in values.items() if len(found) == 1}
        everything = itertools.product((False, True), repeat=toy.fluents)
        states: frozenset[State] = frozenset(s for s in everything if toy.allowed(s) and agrees(s, fixed))
        left = {i for i in able if toy.after(states, (), i)}
        if left == able:
            return able
        able = left


@settings(max_examples=examples(150))
@given(st.one_of(toys(closed=False), toys(closed=True)))
def test_an_action_is_reported_if_and_only_if_no_state_executes_it(toy: Toy) -> None:
    toy = plain(toy)
    said = report(toy)
    if not toy.start():
        assert "initially makes" in said
        return
    able = occurring(toy)
    if not able:
        assert "warning: no action can ever occur: " in said and said.endswith("[no-plan]")
        return
    if "all others wait" in said:
        assert not any(toy.after(toy.start(), (), number) for number in able)
        said = "\n".join(line for line in said.splitlines() if "all others wait" not in line)
    reported = {int(number) for number in re.findall(r"\w\((\d+)\) can never occur", said)}
    assert reported == set(range(len(toy.actions))) - able
    assert all("warning" in line for line in said.splitlines())
    assert bool(said) == bool(reported)


@settings(max_examples=examples(50))
@given(toys(closed=False))
def test_a_goal_is_refused_if_and_only_if_no_state_satisfies_it(toy: Toy) -> None:
    goal = replace(plain(toy), initially={}, goal=toy.goal, actions=(replace(toy.actions[0], before={}, after={}),))
    everything = itertools.product((False, True), repeat=toy.fluents)
    possible = any(goal.allowed(state) and agrees(state, goal.goal) for state in everything)
    assert ("goal makes" in report(goal)) == (not possible)
