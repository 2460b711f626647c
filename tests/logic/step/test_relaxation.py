"""How far a state is from the end of a plan is never told too large, and told exactly where nothing is passed over."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from prag_asp import TaskSpace
from prag_asp.logic.domain_logic import DomainLogic
from prag_asp.logic.step import relaxation
from prag_asp.logic.step.packed import Rows
from prag_asp.logic.step.relaxation import relax
from prag_asp.logic.step.transition import Transition
from tests.brute_force import Toy
from tests.chance import examples
from tests.conditions import clauses, entities
from tests.domains import domain_of
from tests.strategies import toys

FARTHEST, MOST_STATES = 6, 400


def distances(transition: Transition) -> tuple[Rows, list[float]]:
    """Return the states that a plain search finds, and how far each is from the end, as far as they are known."""
    found = {tuple(row): number for number, row in enumerate(transition.initial.tolist())}
    edges: list[tuple[int, int]] = []
    for number in range(MOST_STATES):
        if number == len(found):
            break
        row = np.array([list(found)[number]], dtype=np.uint64)
        for after in transition.expand(row):
            edges += [(number, found.setdefault(tuple(state), len(found))) for state in after.states.tolist()]
    rows = np.array(list(found), dtype=np.uint64).reshape(len(found), transition.initial.shape[1])
    far = [0.0 if ends else float("inf") for ends in transition.accepts(rows)]
    for _ in range(FARTHEST):
        for source, target in edges:
            far[source] = min(far[source], far[target] + 1)
    return rows, far


def check_that_none_is_held_to_be_farther_than_it_is(transition: Transition) -> None:
    rows, far = distances(transition)
    relaxed = relax(transition)
    before = np.zeros(len(rows), dtype=np.bool_)
    for left in range(FARTHEST):
        near, forever = relaxed.within(rows, left)
        assert near[np.array(far, dtype=np.float64) <= left].all()
        assert near[before].all()
        if forever:
            assert np.array_equal(relaxed.within(rows, left + 5)[0], near)
        before = near


@settings(max_examples=examples(30), suppress_health_check=list(HealthCheck))
@given(st.booleans().flatmap(lambda closed: toys(closed=closed)), st.data())
def test_no_state_is_held_to_be_farther_from_the_end_than_it_is(toy: Toy, data: st.DataObject) -> None:
    known = st.dictionaries(st.integers(0, toy.fluents - 1), st.booleans(), min_size=1, max_size=3)
    toy = replace(toy, goal=data.draw(known))
    domain = domain_of(toy.text() + "#program base.\n" + entities(toy), "at_most")
    check_that_none_is_held_to_be_farther_than_it_is(DomainLogic(domain).transition(tasks=False))
    asked = data.draw(st.lists(clauses(toy), min_size=1, max_size=2))
    space = TaskSpace(domain, 0).where(*(clause.words for clause in asked))
    check_that_none_is_held_to_be_farther_than_it_is(space.engines.model.transition(tasks=False))


TRACK = """
class(stop). entity(stop(1..9),stop). fluent((at(stop(I));rusty)) :- I=1..9. action(go(stop(I))) :- I=2..9.
initially(at(stop(I)),false) :- I=2..9. initially(at(stop(1)),true). goal(at(stop(9)),true).
precondition(go(stop(I)),at(stop(I-1)),true) :- I=2..9. postcondition(go(stop(I)),at(stop(I)),true) :- I=2..9.
postcondition(go(stop(I)),at(stop(I-1)),false) :- I=2..9.
"""


def test_one_thing_on_a_track_is_as_far_from_the_end_as_there_are_stops() -> None:
    transition = DomainLogic(domain_of(TRACK)).transition(tasks=False)
    rows, _ = distances(transition)
    nearest = [next(left for left in range(20) if relax(transition).within(row[None], left)[0][0]) for row in rows]
    assert nearest == [8, 7, 6, 5, 4, 3, 2, 1, 0]


@pytest.mark.parametrize(
    ("expression", "fewest"), [("go{5}", 5), ("go . stay* turn", 3), ("(go turn){2} | stay{7}", 4)]
)
def test_the_automaton_of_a_condition_is_followed_exactly(expression: str, fewest: int) -> None:
    domain = domain_of("fluent(f). action(go;turn;stay).")
    transition = TaskSpace(domain, 0).where(f"matches {expression}").engines.model.transition(tasks=False)
    rows, far = distances(transition)
    assert far[0] == fewest
    for left in range(FARTHEST + 1):
        near, _ = relax(transition).within(rows, left)
        assert near.tolist() == [distance <= left for distance in far]


DERIVED = """
class(node). entity(n(1..K),node). fluent(link(n(I),n(I+1))) :- I=1..K-1. initially(F,false) :- fluent(F).
action(join(n(I))) :- I=1..K-1. postcondition(join(n(I)),link(n(I),n(I+1)),true) :- I=1..K-1.
#program step(t).
reached(n(1),t). reached(n(I+1),t) :- reached(n(I),t), link(n(I),n(I+1),t).
link(X,Y,t) :- holds(link(X,Y),true,t). link(X,Y,t) :- link(Y,X,t). link(Y,X,t) :- link(X,Y,t).
#program check(t).
:- not reached(n(K),t).
"""


@pytest.mark.parametrize("rounds", [16, 2])
def test_atoms_that_derive_each_other_hold_nobody_back(rounds: int, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(relaxation, "MOST_ROUNDS", rounds)
    transition = DomainLogic(domain_of(DERIVED.replace("K", "4"))).transition(tasks=False)
    check_that_none_is_held_to_be_farther_than_it_is(transition)
