"""A state has the fluents that can change which plans are valid, and no others."""

from __future__ import annotations

import pytest

from prag_asp.logic.domain_logic import DomainLogic
from prag_asp.logic.step.cone import find_breakable
from prag_asp.space.task_space import TaskSpace
from tests.domains import domain_of

ONE_PLACE = """
place(1..3). fluent(at(P)) :- place(P). fluent(seen(P)) :- place(P). action(go(P)) :- place(P).
postcondition(go(P),at(P),true) :- place(P). postcondition(go(P),at(Q),false) :- place(P), place(Q), P != Q.
postcondition(go(P),seen(P),true) :- place(P). initially(at(1),true). initially(F,false) :- fluent(F), F != at(1).
"""
EXCLUSIVE = "exclusive(at(P),at(Q)) :- place(P), place(Q), P < Q. "
RELATION = """
fluent(near(P,Q)) :- place(P), place(Q), P != Q. action(put(P,Q)) :- fluent(near(P,Q)).
postcondition(put(P,Q),near(P,Q),true) :- action(put(P,Q)).
exclusive(near(P,Q),near(P,R)) :- fluent(near(P,Q)), fluent(near(P,R)), Q < R.
"""

ALL_PLACES = {"at(1)", "at(2)", "at(3)"}


@pytest.mark.parametrize(
    ("more", "expected"),
    [
        ("", set()),
        ("precondition(go(2),at(1),true).", {"at(1)"}),
        ("goal(seen(3),true).", {"seen(3)"}),
        ("#program step(t). :- occurs(go(1),t), holds(seen(2),true,t-1).", {"seen(2)"}),
        # An invariant that no action can break is left out; one that some action can break is kept with all it reads.
        (EXCLUSIVE, set()),
        (EXCLUSIVE + "action(jump). postcondition(jump,at(2),true).", ALL_PLACES),
        (EXCLUSIVE + "action(jump). postcondition(jump,at(2),true). action(wait).", ALL_PLACES),
        (
            EXCLUSIVE + "fluent(lit). action(light). postcondition(light,lit,true). initially(lit,false). "
            "exclusive(lit,seen(2)).",
            {"lit", "seen(2)"},
        ),
    ],
)
def test_a_state_has_what_may_change_which_plans_are_valid(more: str, expected: set[str]) -> None:
    variables = DomainLogic(domain_of(ONE_PLACE + more)).transition(tasks=False).variables
    assert {str(variable.arguments[0]) for variable in variables if variable.name == "holds"} == expected


@pytest.mark.parametrize("more", ["", EXCLUSIVE, EXCLUSIVE + "action(jump). postcondition(jump,at(2),true).", RELATION])
def test_closing_constraints_of_one_shape_together_finds_all_broken_ones(
    more: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    domain = domain_of(ONE_PLACE + more)
    step = DomainLogic(domain).step
    broken, plans = find_breakable(step, list(step.constraints)), TaskSpace(domain, length=3).count()
    monkeypatch.setattr("prag_asp.logic.step.cone.SINGLE_SOLVES", 0)
    assert set(broken) <= set(find_breakable(step, list(step.constraints)))
    assert TaskSpace(domain_of(ONE_PLACE + more + "% again"), length=3).count() == plans
