"""Why a sequence is not a plan, compared with all plans of the definition."""

from __future__ import annotations

import itertools
from dataclasses import replace

import clingo
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from prag_asp import load_domain
from prag_asp.logic.domain_logic import DomainLogic
from prag_asp.logic.formula.clause_builder import ClauseBuilder
from prag_asp.logic.formula.explanation import explain, report_violations
from prag_asp.logic.formula.solver import Solver, smallest_conflict
from tests.brute_force import Toy, term
from tests.chance import examples
from tests.domains import domain_of
from tests.strategies import toys


@settings(max_examples=examples(40), suppress_health_check=list(HealthCheck))
@given(st.booleans().flatmap(lambda closed: toys(closed=closed)), st.data())
def test_the_step_and_the_conflict_are_those_of_the_definition(toy: Toy, data: st.DataObject) -> None:
    number = st.integers(0, len(toy.actions) - 1)
    plan = tuple(data.draw(st.lists(number, max_size=4)))
    length = len(plan)
    found = explain(DomainLogic(domain_of(toy.text(), "at_most")), [clingo.parse_term(term(toy, i)) for i in plan])
    plans = set(toy.plans(length))
    assert (found is None) == (plan in plans)
    if found is None:
        return
    without_goal = replace(toy, goal={})
    possible = [k for k in range(length + 1) if plan[:k] in set(without_goal.plans(k))]
    assert found.step == len(possible)
    assert found.reasons

    def conflicting(steps: tuple[int, ...]) -> bool:
        return not any(all(each[k - 1] == plan[k - 1] for k in steps) for each in plans)

    assert conflicting(found.conflict)
    smaller = itertools.combinations(range(1, length + 1), max(len(found.conflict) - 1, 0))
    assert not found.conflict or not any(map(conflicting, smaller))


GRASPS = ["approach(panda,apple_1)", "grasp(panda,apple_1)"]
SHIPPED = [
    ("prag", [*GRASPS, "grasp(panda,apple_2)"], (), 3, (2, 3), [
        "it needs open(panda) to be true, but that has been false since step 2, grasp(panda,apple_1)",
        "it needs at(panda,apple_2) to be true, but that has been false since step 1, approach(panda,apple_1)",
    ]),
    ("blocks", ["stack(a,b)"], (), 1, (1,), ["it needs holding(a) to be true, but that has been false from the start"]),
    ("prag", ["approach(panda,apple_1)", "withdraw(panda,apple_1)"], ("no_undo",), 2, (1, 2), [
        "no_undo.lp:19 forbids it: :- occurs(A,t-1), occurs(B,t), _undoes(B,A)."
    ]),
    # Steps in between do not hide the two that conflict.
    ("prag", [*GRASPS, "drop(panda,apple_1)", "grasp(panda,apple_1)"], ("at_most(grasp,1)",), 4, (2, 4), [
        "at_most.lp:16 forbids it: :- _occurrences(N,K,t-1), _step_name(N,t), at_most(N,K)."
    ]),
]  # fmt: skip


@pytest.mark.parametrize(("name", "plan", "rules", "step", "conflict", "reasons"), SHIPPED)
def test_the_reason_is_told_with_the_step_that_broke_it_or_the_rule_with_its_line(
    name: str, plan: list[str], rules: tuple[str, ...], step: int, conflict: tuple[int, ...], reasons: list[str]
) -> None:
    found = explain(DomainLogic(load_domain(name, rules=rules)), list(map(clingo.parse_term, plan)))
    assert found is not None and (found.step, found.conflict) == (step, conflict)
    told = [reason.rpartition("/")[2] if ".lp:" in reason else reason for reason in found.reasons]
    assert told == reasons


TEXT = """
fluent(f). fluent(g). fluent(h). initially(f,false). initially(g,false). initially(h,false).
action(a). action(b). postcondition(a,f,true). postcondition(b,g,true).
"""


@pytest.mark.parametrize(
    ("more", "plan", "step", "reasons", "conflict"),
    [
        ("goal(g,true).", "a", 2, ["the goal needs g to be true, but that has been false from the start"], (1,)),
        ("goal(f,false).", "ab", 3, ["the goal needs f to be false, but that has been true since step 1, a"], (1,)),
        ("goal(h,true).", "ab", 3, ["the goal needs h to be true, but that has been false from the start"], ()),
        ("exclusive(f,g).", "ab", 2, ["f would have to be both true and false", "g would have to be"], (1, 2)),
        ("implies(g,f).", "b", 1, ["f would have to be both true and false", "g would have to be"], (1,)),
        ("initially(f,true).", "ab", 0, ["f would have to be both true and false"], ()),
        ("#program step(t). :- occurs(b,t).", "ab", 2, ["domain.lp:4 forbids it: "], (2,)),
        ("#program step(t). :- occurs(a,t),\n occurs(b,t-1).", "ba", 2, [":- occurs(a,t), occurs(b,t-1)."], (1, 2)),
        ("#program check(t). :- holds(f,true,t).", "a", 2, ["domain.lp:4 forbids it: "], (1,)),
        ("#program step(t). occurs(a,t) :- holds(f,true,t-1).", "ab", 2, ["another action has to occur"], (1, 2)),
    ],
)
def test_each_kind_of_reason_is_told(
    more: str, plan: str, step: int, reasons: list[str], conflict: tuple[int, ...]
) -> None:
    program = "#program base.\n" if more.startswith("initially") else ""
    found = explain(DomainLogic(domain_of(TEXT + program + more)), [clingo.Function(action) for action in plan])
    assert found is not None
    assert (found.step, found.conflict) == (step, conflict)
    assert len(found.reasons) == len(reasons)
    for reason, expected in zip(found.reasons, reasons, strict=True):
        assert expected in reason


def test_constraints_that_forbid_only_together_are_told_together() -> None:
    """A coin that falls either way: each constraint leaves one side."""
    text = TEXT + "#program step(t). { coin(t) }.\n:- coin(t), occurs(a,t).\n:- not coin(t), occurs(a,t)."
    found = explain(DomainLogic(domain_of(text)), [clingo.Function("a")])
    assert found is not None and len(found.reasons) == 2 and found.conflict == (1,)


def test_a_tracked_program_keeps_all_that_is_no_constraint() -> None:
    program = report_violations(
        domain_of(TEXT + "#program step(t). x(t) :- occurs(a,t). not x(t) :- occurs(b,t).").program
    )
    assert "x(t) :- occurs(a,t)." in program.program.text
    assert "not x(t) :- occurs(b,t)." in program.program.text
    assert "#false" not in program.program.text


CLAUSES = st.lists(st.lists(st.integers(1, 6).flatmap(lambda v: st.sampled_from([v, -v])), min_size=1, max_size=3))


@settings(max_examples=examples(120))
@given(CLAUSES)
def test_a_smallest_conflict_is_one_and_none_is_smaller(given_clauses: list[list[int]]) -> None:
    literals = [1, -2, 3, 4, -5, 6]
    clauses = ClauseBuilder()
    for clause in given_clauses:
        clauses.add(*(literal + (1 if literal > 0 else -1) for literal in clause))
    shifted = [literal + (1 if literal > 0 else -1) for literal in literals]
    with Solver(7, clauses.clauses) as solver:
        if solver.satisfiable(shifted):
            return
        found = smallest_conflict(solver, [], shifted)
        sets = (subset for size in range(7) for subset in itertools.combinations(shifted, size))
        smallest = next(subset for subset in sets if not solver.satisfiable(subset))
        assert len(found) == len(smallest) and not solver.satisfiable(found) and set(found) <= set(shifted)
