"""Actions whose needs no state of a frontier meets are passed over together, and only these."""

from __future__ import annotations

from unittest.mock import patch

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from prag_asp import TaskSpace
from prag_asp.logic.domain_logic import DomainLogic
from prag_asp.logic.step import transition
from prag_asp.logic.step.normal import RuleBody
from prag_asp.logic.step.transition import Needs
from tests.brute_force import Toy, term
from tests.chance import examples
from tests.domains import domain_of
from tests.strategies import toys


@settings(max_examples=examples(20))
@given(st.one_of(toys(closed=False), toys(closed=True)), st.sampled_from([1, 2**25]))
def test_random_domains_count_as_the_definition_says_where_actions_are_many(toy: Toy, room: int) -> None:
    with patch.object(transition, "MANY", 0), patch.object(transition, "ROOM", room):
        space = TaskSpace(domain_of(toy.text(), "at_most"), 3)
        assert set(space.enumerate("plan")) == {tuple(term(toy, i) for i in plan) for plan in toy.plans(3)}


@settings(max_examples=examples(50))
@given(st.data())
def test_an_action_is_passed_over_where_each_state_has_a_literal_that_forbids_it(data: st.DataObject) -> None:
    actions, states = data.draw(st.integers(1, 5)), data.draw(st.integers(1, 20))
    columns = {atom: np.array(data.draw(st.lists(st.booleans(), min_size=states, max_size=states))) for atom in (7, 8)}
    literals = st.sampled_from([7, -7, 8, -8])
    pairs = data.draw(st.lists(st.tuples(st.integers(1, actions), literals), max_size=8))
    bodies = [RuleBody(pair if data.draw(st.booleans()) else pair[::-1]) for pair in pairs]
    others = [RuleBody((1,)), RuleBody((2, 7, 8)), RuleBody((7, 8)), RuleBody((1, 9)), RuleBody((1, 7), 1, (1, 1))]
    found = Needs.of([*bodies, *others], range(1, actions + 1), {7, 8}).met(columns.__getitem__, states)
    expected = [
        any(
            not any(columns[abs(each)][state] == (each > 0) for action, each in pairs if action == own)
            for state in range(states)
        )
        for own in range(1, actions + 1)
    ]
    assert found.tolist() == expected


def test_of_hundreds_of_moves_only_those_that_can_begin_are_prepared() -> None:
    text = """
    place(1..25). fluent(at(P)) :- place(P). initially(at(1),true). initially(at(P),false) :- place(P), P != 1.
    action(go(P,Q)) :- place(P), place(Q), P != Q. precondition(go(P,Q),at(P),true) :- action(go(P,Q)).
    postcondition(go(P,Q),at(P),false; go(P,Q),at(Q),true) :- action(go(P,Q)).
    """
    step = DomainLogic(domain_of(text)).transition(tasks=False)
    assert [str(step.actions[each.letter]) for each in step.expand(step.initial)] == [
        f"go(1,{q})" for q in range(2, 26)
    ]
    assert len(step._moves) == 24
