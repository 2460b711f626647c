"""Forecasts of explorations, and the note that one will take long."""

from __future__ import annotations

from itertools import combinations

import pytest

from prag_asp.processes.progress_events import Note
from prag_asp.space.automaton import outlook
from prag_asp.space.automaton.exploration import Extent
from prag_asp.space.automaton.outlook import Outlook, forecast_states
from prag_asp.space.task_space import TaskSpace
from tests.domains import domain_of

TOUCHES = """
class(thing). entity((x1; x2; x3; x4; x5; x6), thing).
fluent(touched(X)) :- is_a(X,thing). fluent(above(X,Y)) :- is_a(X,thing), is_a(Y,thing), X < Y.
initially(F,false) :- fluent(F).
action(touch(X)) :- is_a(X,thing). postcondition(touch(X),touched(X),true) :- action(touch(X)).
action(put(X,Y)) :- fluent(above(X,Y)). postcondition(put(X,Y),above(X,Y),true) :- action(put(X,Y)).
postcondition(put(X,Y),touched((X;Y)),true) :- action(put(X,Y)).
precondition(touch(X),touched(X),false) :- action(touch(X)).
precondition(put(X,Y),above(X,Y),false) :- action(put(X,Y)).
"""


def plans(steps: int, touched: frozenset[int] = frozenset(), above: frozenset[tuple[int, int]] = frozenset()) -> int:
    """Return the number of plans of some steps, by trying each action."""
    if not steps:
        return 1
    things = frozenset(range(6))
    found = sum(plans(steps - 1, touched | {each}, above) for each in things - touched)
    pairs = set(combinations(range(6), 2)) - above
    return found + sum(plans(steps - 1, touched | {*pair}, above | {pair}) for pair in pairs)


def test_the_forecast_follows_the_growth_of_layers() -> None:
    assert forecast_states([1], 3) == 1 + 3
    assert forecast_states([2, 6], 2) == 6 + 8 + 16
    assert forecast_states([2, 6, 14], 0) == 14
    assert forecast_states([10, 50, 130], 1) == pytest.approx(130 + 80 * 2 * 0.5)
    assert forecast_states([5, 5], 10) == 5


def test_a_long_exploration_is_noted_once_with_the_actions_that_make_it_long() -> None:
    heard: list[str] = []
    view = Outlook(heard.append, ["touch", "put", "put"], length=5, width=100)
    for expanded in (1, 2, 4):
        view.watch(Extent(1, 4, 3 * expanded, 0, expanded, [1, 1, 1]))
    view.watch(Extent(2, 1_000, 400_000, 0, 400, [100_000, 100_000, 200_000]))
    assert not heard
    for expanded in (600, 800):
        view.watch(Extent(3, 40_000, 1_000 * expanded, 0, expanded, [250 * expanded, 250 * expanded, 500 * expanded]))
    assert [type(each) for each in heard] == [Note]
    assert "within 4 steps there may be" in heard[0]
    assert "1,000 actions each, 75% of them put;" in heard[0]


def test_a_count_says_what_makes_it_long(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(outlook, "WORK", 1_000)
    heard: list[str] = []
    assert TaskSpace(domain_of(TOUCHES), 5, progress=heard.append).count("plan") == plans(5)
    notes = [each for each in heard if isinstance(each, Note) and "times as long" in each]
    assert len(set(notes)) == 1
    assert "of them put; ask for fewer steps or entities, or set --time" in notes[0]
