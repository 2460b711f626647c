"""The linter reports an action that can never occur exactly where brute force over all states says so."""

from __future__ import annotations

import itertools
import re
import tempfile
from collections.abc import Iterable
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


def unchanged(toy: Toy, able: Iterable[int]) -> Values:
    """Return the fluents, with their values, that all initial states agree on and none of some actions changes."""
    changing = {fluent for number in able for fluent in toy.actions[number].after}
    values = {f: {state[f] for state in toy.start()} for f in range(toy.fluents) if f not in changing}
    return {f: found.pop() for f, found in values.items() if len(found) == 1}


def states_with(toy: Toy, values: Values) -> frozenset[State]:
    """Return the allowed states with some values of fluents."""
    every = itertools.product((False, True), repeat=toy.fluents)
    return frozenset(state for state in every if toy.allowed(state) and agrees(state, values))


def occurring(toy: Toy) -> set[int]:
    """Return the actions that a state executes which agrees with the initial state on what no such action changes."""
    able = set(range(len(toy.actions)))
    while True:
        states = states_with(toy, unchanged(toy, able))
        left = {i for i in able if toy.after(states, (), i)}
        if left == able:
            return able
        able = left


@settings(max_examples=examples(70))
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


@settings(max_examples=examples(30))
@given(toys(closed=False))
def test_a_goal_is_refused_if_and_only_if_no_state_satisfies_it(toy: Toy) -> None:
    goal = replace(plain(toy), initially={}, goal=toy.goal, actions=(replace(toy.actions[0], before={}, after={}),))
    assert ("goal makes" in report(goal)) == (not states_with(goal, goal.goal))
