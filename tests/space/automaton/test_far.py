"""States that are too far from the end of a plan are not expanded, and no count, word, rank or draw tells."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from prag_asp import TaskSpace
from prag_asp.logic.domain_logic import DomainLogic
from prag_asp.logic.step.packed import Rows
from prag_asp.logic.step.relaxation import Relaxation
from prag_asp.space.automaton import exploration as exploring
from prag_asp.space.automaton.exploration import explore
from prag_asp.space.engines import LEVELS, Level
from prag_asp.space.engines.automaton_engine import AutomatonEngine
from prag_asp.space.weights.weights import Weights, parse_weights
from tests.brute_force import Toy, term
from tests.chance import examples
from tests.conditions import clauses, entities
from tests.domains import domain_of
from tests.spaces import draws_of
from tests.strategies import symmetric_texts, toys

ALWAYS, NEVER = 0, 10**12
"""How many states there have to be for far ones to be left as they are."""


@contextmanager
def leaving(many: int) -> Iterator[None]:
    """Leave far states as they are from so many states on, however few are far."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(exploring, "MANY", many)
        patch.setattr(exploring, "FEW", -1)
        yield


def explored_engine(many: int, model: DomainLogic, level: Level, length: int, merge: bool = False) -> AutomatonEngine:
    engine = AutomatonEngine(model, level, merge=merge)
    with leaving(many):
        engine.explored(length)
    return engine


def check_that_nothing_is_lost(
    model: DomainLogic, level: Level, length: int, merge: bool, weights: Weights, seed: int
) -> None:
    whole, cut = (explored_engine(many, model, level, length, merge) for many in (NEVER, ALWAYS))
    for shorter in range(length + 1):
        assert cut.count(shorter) == whole.count(shorter)
        assert list(cut.words(shorter)) == list(whole.words(shorter))
    total = whole.count(length)
    for rank in range(0, total, total // 5 + 1):
        word = whole.unrank(length, rank)
        assert cut.unrank(length, rank) == word and cut.rank(word) == rank
    if total and level != "skeleton":
        for weighed in (Weights(), weights):
            if whole.weighed(length, weighed).total(length):
                with leaving(ALWAYS):
                    drawn = draws_of(cut, length, weighed, seed)
                with leaving(NEVER):
                    assert drawn == draws_of(whole, length, weighed, seed)


@settings(max_examples=examples(25), suppress_health_check=list(HealthCheck))
@given(st.booleans().flatmap(lambda closed: toys(closed=closed)), st.data())
def test_random_domains_with_goals_have_the_plans_of_brute_force(toy: Toy, data: st.DataObject) -> None:
    known = st.dictionaries(st.integers(0, toy.fluents - 1), st.booleans(), min_size=1, max_size=3)
    toy = replace(toy, goal=data.draw(known))
    model = DomainLogic(domain_of(toy.text(), "at_most"))
    plans, skeletons = explored_engine(ALWAYS, model, "plan", 4), explored_engine(ALWAYS, model, "skeleton", 4)
    for length in (4, 3, 2):
        expected = {tuple(term(toy, i) for i in plan) for plan in toy.plans(length)}
        assert plans.count(length) == len(expected) and set(plans.words(length)) == expected
        assert set(skeletons.words(length)) == {tuple(a.partition("(")[0] for a in plan) for plan in expected}


@settings(max_examples=examples(15), suppress_health_check=list(HealthCheck))
@given(symmetric_texts(), st.sampled_from(LEVELS), st.booleans(), st.integers(0, 99))
def test_random_symmetric_domains_with_goals_are_the_same(text: str, level: Level, merge: bool, seed: int) -> None:
    model = DomainLogic(domain_of(text + "#program base. goal(p(x(1)),true). goal(q(x(1)),false).\n"))
    names = sorted({str(action).partition("(")[0] for action in model.domain.facts.actions})
    weights = parse_weights({names[0]: 3, f"{names[0]}>{names[-1]}": "2/5"}, model.domain.facts)
    check_that_nothing_is_lost(model, level, 3, merge, weights, seed)


@settings(max_examples=examples(15), suppress_health_check=list(HealthCheck))
@given(toys(closed=False), st.data(), st.sampled_from(LEVELS), st.integers(0, 99))
def test_random_conditions_are_the_same(toy: Toy, data: st.DataObject, level: Level, seed: int) -> None:
    domain = domain_of(toy.text() + "#program base.\n" + entities(toy), "at_most")
    asked = data.draw(st.lists(clauses(toy), min_size=1, max_size=2))
    model = TaskSpace(domain, 0).where(*(clause.words for clause in asked)).engines.model
    check_that_nothing_is_lost(model, level, 4, False, Weights(), seed)


GRID = """
class(robot). class(cell). entity(robot,robot). entity(cell(0..W-1,0..W-1),cell).
fluent(at(cell(X,Y))) :- entity(cell(X,Y),cell). initially(F,false) :- fluent(F), F != at(cell(0,0)).
initially(at(cell(0,0)),true). goal(at(cell(W-1,W-1)),true).
next(cell(X,Y),cell(X+1,Y)) :- X=0..W-2, Y=0..W-1. next(cell(X,Y),cell(X,Y+1)) :- X=0..W-1, Y=0..W-2.
action((go(A,B);go(B,A))) :- next(A,B). precondition(go(A,B),at(A),true) :- action(go(A,B)).
postcondition(go(A,B),at(A),false) :- action(go(A,B)). postcondition(go(A,B),at(B),true) :- action(go(A,B)).
"""


def test_on_the_shortest_ways_no_step_leads_away(monkeypatch: pytest.MonkeyPatch) -> None:
    transition = DomainLogic(domain_of(GRID.replace("W", "5"))).transition(tasks=False)
    monkeypatch.setattr(exploring, "MANY", ALWAYS)
    for length, near in ((7, 0), (8, 24)):
        explored = explore(transition, length).automaton
        assert explored.horizon == length
        assert int((np.diff(explored.offsets) > 0).sum()) == near
    assert explore(transition, 16).automaton.horizon is None


def test_a_longer_question_explores_what_a_shorter_one_left(monkeypatch: pytest.MonkeyPatch) -> None:
    model = DomainLogic(domain_of(GRID.replace("W", "4")))
    monkeypatch.setattr(exploring, "MANY", ALWAYS)
    cut = AutomatonEngine(model, "plan", merge=False)
    monkeypatch.setattr(exploring, "MANY", NEVER)
    whole = AutomatonEngine(model, "plan", merge=False)
    monkeypatch.setattr(exploring, "MANY", ALWAYS)
    expected = {length: whole.count(length) for length in (14, 6, 8, 10)}
    assert expected[6] == 20  # the ways of 3 steps east and 3 north
    assert {length: cut.count(length) for length in (6, 8, 10, 14)} == expected


def test_what_is_kept_for_a_length_is_not_taken_for_a_longer_one(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("PRAG_ASP_CACHE", str(tmp_path))
    monkeypatch.setattr("prag_asp.space.engines.automaton_engine.WORTH_KEEPING", 0)
    monkeypatch.setattr(exploring, "MANY", ALWAYS)
    model = DomainLogic(domain_of(GRID.replace("W", "3")))
    counts = [AutomatonEngine(model, "plan").count(length) for length in (4, 6, 4, 8, 6)]
    monkeypatch.setattr(exploring, "MANY", NEVER)
    monkeypatch.setenv("PRAG_ASP_CACHE", "")
    assert counts == [AutomatonEngine(model, "plan").count(length) for length in (4, 6, 4, 8, 6)]


def test_a_layer_whose_first_states_are_near_is_not_looked_at_any_more(monkeypatch: pytest.MonkeyPatch) -> None:
    transition = DomainLogic(domain_of(GRID.replace("W", "5"))).transition(tasks=False)
    monkeypatch.setattr(exploring, "MANY", ALWAYS)
    monkeypatch.setattr(exploring, "FEWEST", 1)
    monkeypatch.setattr(exploring, "MOST", 1)
    looked: list[int] = []
    within = Relaxation.within

    def watched(relaxation: Relaxation, rows: Rows, left: int) -> tuple[NDArray[np.bool_], bool]:
        looked.append(left)
        return within(relaxation, rows, left)

    monkeypatch.setattr(Relaxation, "within", watched)
    explore(transition, 30)
    assert looked == list(range(30, 21, -1))  # one state of each layer: all are near enough
