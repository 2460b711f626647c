"""What a step reads of the step before, and rules that keep it from being the same function at every step."""

from __future__ import annotations

import pytest

from prag_asp import EngineError, TaskSpace
from prag_asp.logic.domain_logic import DomainLogic
from tests.domains import domain_of

TWO = "fluent(f). action(a). action(b). postcondition(a,f,true). postcondition(b,f,false). initially(f,false).\n"


def counts(rules: str, engine: str) -> list[int]:
    domain = domain_of(TWO + "#program step(t).\n" + rules)
    space = TaskSpace(domain, 0, engine=engine)
    return [space.at(length).count("plan") for length in range(5)]


@pytest.mark.parametrize(
    ("rules", "expected"),
    [
        # No step follows one after which f holds, so a comes last; b leaves f false.
        ("q(t) :- holds(f,true,t).\n:- q(t-1;t-1).", [1, 2, 2, 2, 2]),
        ("q(1,t;2,t) :- occurs(a,t).\n:- q(2,t-1), occurs(a,t).", [1, 2, 3, 5, 8]),
        ("q(t) :- occurs(a,t).\n:- 1 #count { X : q(t-1), X = 1 }, occurs(a,t).", [1, 2, 3, 5, 8]),
        (':- not not holds(f,true,t-1), "t" != "s", occurs(a,t).', [1, 2, 3, 5, 8]),
    ],
)
def test_whatever_form_an_atom_of_the_step_before_has_it_is_carried_along(rules: str, expected: list[int]) -> None:
    assert counts(rules, "automaton") == counts(rules, "clingo") == expected


@pytest.mark.parametrize(
    ("rule", "told"),
    [
        ("-q(t) :- holds(f,true,t). :- -q(t-1), occurs(a,t).", "-q/1 is strongly negated"),
        ("q(t) :- occurs(a,t). :- q(t;t-2).", "q/1 is read at a step other than t and t-1"),
        ("q(t,t) :- occurs(a,t).", "the rule reads the number of the step"),
        ("q(f((t-1),2),t) :- occurs(a,t).", "the rule reads the number of the step"),
        (":- X = t, X > 2, occurs(a,t).", "the rule reads the number of the step"),
        (":- #count { A : occurs(A,t) } > t.", "the rule reads the number of the step"),
        ("q :- occurs(a,t).", "a head in step(t) does not carry the time t"),
        ("#program check(t).\n:- holds(f,true,t-1).", "holds/3 is read at step t-1 by the check after the last step"),
        ("#program base.\n:- holds(f,true,3).", "holds/3 is read outside of the parts"),
    ],
)
def test_a_rule_that_differs_between_steps_is_told_with_its_line(rule: str, told: str) -> None:
    domain = domain_of(TWO + "#program step(t).\n" + rule)
    assert [
        told in str(obstacle.error()) and ".lp:" in obstacle.place
        for obstacle in DomainLogic(domain).reads.obstacles[:1]
    ] == [True]
    with pytest.raises(EngineError):
        TaskSpace(domain, 2, engine="automaton").count("plan")


def test_what_is_strongly_negated_is_left_to_clingo() -> None:
    rules = "-q(t) :- holds(f,true,t).\n:- -q(t-1), occurs(a,t)."
    assert counts(rules, "auto") == counts(rules, "clingo") == [1, 2, 3, 5, 8]


def test_names_and_strings_that_look_like_the_number_of_the_step_are_none() -> None:
    rules = 'q("t",tt,t) :- occurs(a,t).\nr(t(1),t) :- occurs(b,t).\n:- q(_,T,t-1), r(_,t-1), T = tt.'
    assert not DomainLogic(domain_of(TWO + "#program step(t).\n" + rules)).reads.obstacles
