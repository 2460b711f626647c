"""A state has the fluents that can change which plans are valid, and no others."""

from __future__ import annotations

import pytest

from prag_asp.logic.domain_logic import DomainLogic
from tests.domains import domain_of

ONE_PLACE = """
place(1..3). fluent(at(P)) :- place(P). fluent(seen(P)) :- place(P). action(go(P)) :- place(P).
postcondition(go(P),at(P),true) :- place(P). postcondition(go(P),at(Q),false) :- place(P), place(Q), P != Q.
postcondition(go(P),seen(P),true) :- place(P). initially(at(1),true). initially(F,false) :- fluent(F), F != at(1).
"""
EXCLUSIVE = "exclusive(at(P),at(Q)) :- place(P), place(Q), P < Q. "


def fluents(text: str) -> set[str]:
    variables = DomainLogic(domain_of(text)).transition(tasks=False).variables
    return {str(variable.arguments[0]) for variable in variables if variable.name == "holds"}


def test_what_nothing_reads_is_left_out() -> None:
    assert fluents(ONE_PLACE) == set()
    assert fluents(ONE_PLACE + "precondition(go(2),at(1),true).") == {"at(1)"}
    assert fluents(ONE_PLACE + "goal(seen(3),true).") == {"seen(3)"}
    assert fluents(ONE_PLACE + "#program step(t). :- occurs(go(1),t), holds(seen(2),true,t-1).") == {"seen(2)"}


def test_an_invariant_that_no_action_can_break_is_left_out() -> None:
    assert fluents(ONE_PLACE + EXCLUSIVE) == set()


@pytest.mark.parametrize(
    "more",
    ["action(jump). postcondition(jump,at(2),true).", "action(jump). postcondition(jump,at(2),true). action(wait)."],
)
def test_an_invariant_that_some_action_can_break_is_kept_with_all_that_it_reads(more: str) -> None:
    assert fluents(ONE_PLACE + EXCLUSIVE + more) == {"at(1)", "at(2)", "at(3)"}


def test_of_several_invariants_those_that_can_be_broken_are_kept() -> None:
    more = "fluent(lit). action(light). postcondition(light,lit,true). initially(lit,false). exclusive(lit,seen(2))."
    assert fluents(ONE_PLACE + EXCLUSIVE + more) == {"lit", "seen(2)"}
