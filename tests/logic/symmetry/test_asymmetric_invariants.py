"""Invariants that are stated of some entities, and follow for the others."""

from __future__ import annotations

import random
from collections.abc import Sequence
from itertools import combinations

import pytest

from prag_asp import TaskSpace
from prag_asp.logic.ground.program import closed_program
from prag_asp.logic.ground.rules import Rule
from prag_asp.logic.symmetry.asymmetric_invariants import states_unevenly
from prag_asp.logic.symmetry.atom_numbering import propagate_facts
from tests.chance import Chance
from tests.domains import domain_of

THINGS = """
class(c). entity((x1;x2;x3),c).
fluent((p(X);q(X);r(X))) :- entity(X,c). initially(F,false) :- fluent(F).
action((a(X);b(X))) :- entity(X,c).
postcondition(b(X),q(X),false) :- entity(X,c). postcondition(b(X),p(X),true) :- entity(X,c).
precondition(a(X),q(X),false) :- entity(X,c). postcondition(a(X),q(X),true) :- entity(X,c).
"""
ONE_AT_A_TIME = "exclusive(p(X),p(Y)) :- entity(X,c), entity(Y,c), X < Y. implies(q(X),p(X)) :- entity(X,c)."
IN_A_CIRCLE = "implies(p(X),q(X)) :- entity(X,c). implies(q(X),r(X)) :- entity(X,c). implies(r(X),p(X)) :- entity(X,c)."

SAID_AGAIN = {
    "an exclusion below implications": (f"{ONE_AT_A_TIME} exclusive(q(x3),q(x1)).", "achieves q(x1) or q(x2) or q(x3)"),
    "an exclusion that is impossible too": (f"{ONE_AT_A_TIME} impossible(p(x1),p(x2)).", ""),
    "what is impossible below": (
        "impossible(p(X),p(Y)) :- entity(X,c), entity(Y,c), X < Y. implies(q(X),p(X)) :- entity(X,c). "
        "impossible(q(x1),q(x2)). impossible(p(x3),q(x2)).", "ends q(x1) or q(x2) or q(x3)"
    ),
    "a fluent that nothing allows": (
        "impossible(r(X),r(X)) :- entity(X,c). implies(q(X),r(X)) :- entity(X,c). impossible(p(x1),q(x1)).", ""
    ),
    "a shortcut and a circle": (f"{IN_A_CIRCLE} implies(p(x1),r(x1)). implies(r(x2),q(x2)).", "nontrivial"),
    "a goal that nothing can fail": (
        "exclusive(r(X),r(X)) :- entity(X,c). goal(r(x1),false). goal(p(X),true) :- entity(X,c).", ""
    ),
    "two circles": (
        "implies(p(X),q(X)) :- entity(X,c), X != x2. implies(q(X),r(X)) :- entity(X,c), X != x2. "
        "implies(r(X),p(X)) :- entity(X,c), X != x2. implies(q(x2),p(x2)). implies(r(x2),q(x2)). implies(p(x2),r(x2)).",
        "achieves r(x1) or r(x2) or r(x3)",
    ),
}  # fmt: skip


@pytest.mark.parametrize("said", SAID_AGAIN)
def test_what_follows_anyway_is_no_difference(said: str) -> None:
    invariants, condition = SAID_AGAIN[said]
    space = TaskSpace(domain_of(THINGS + invariants), 2)
    model = (space.where(condition) if condition else space).engines.model
    named = {str(entity) for group in model.groups(2) for entity in group}
    assert named == {"x1", "x2", "x3"}


def test_two_patterns_of_one_action_are_one() -> None:
    pairs = (
        "action(t(X,Y)) :- entity(X,c), entity(Y,c), X != Y. fluent(g). postcondition(t(X,Y),g,true) :- action(t(X,Y))."
    )
    space = TaskSpace(domain_of(f"class(c). entity((x1;x2),c). initially(g,false). {pairs}"), 2)
    assert space.where("lacks t(_,x2)", "lacks t(x2,x1)").engines.model.groups(2)
    assert not space.where("lacks t(_,x2)").engines.model.groups(2)


def test_tasks_under_an_exclusion_that_is_said_again() -> None:
    invariants, condition = SAID_AGAIN["an exclusion below implications"]
    again, once = (TaskSpace(domain_of(THINGS + said), 3).where(condition) for said in (invariants, ONE_AT_A_TIME))
    assert again.count("task") == once.count("task")
    assert again.count("plan") == once.count("plan")


@pytest.mark.parametrize(("invariants", "uneven"), [
    (ONE_AT_A_TIME, False), (f"{ONE_AT_A_TIME} implies(p(x1),p(x1)).", False),
    (f"{ONE_AT_A_TIME} exclusive(p(x2),p(x1)).", False), (f"{ONE_AT_A_TIME} exclusive(q(x2),p(x1)).", True),
    ("exclusive(p(x1),p(x2)).", False),
])  # fmt: skip
def test_invariants_are_uneven_where_more_is_said_of_some(invariants: str, *, uneven: bool) -> None:
    facts = domain_of(THINGS + invariants).facts
    assert states_unevenly(facts, ()) == uneven
    assert not states_unevenly(facts, [sorted(facts.entities)])


def test_what_a_rule_of_the_author_reads_is_not_stated_more_often() -> None:
    reading = "#program step(t). :- occurs(a(X),t), _propagates(q(X),true,q(x2),false)."
    assert closed_program(domain_of(THINGS + ONE_AT_A_TIME)) is not None
    assert closed_program(domain_of(THINGS + ONE_AT_A_TIME + "% propagates\n")) is not None
    assert closed_program(domain_of(THINGS + ONE_AT_A_TIME + reading)) is None


def drawn_rule(chance: random.Random) -> Rule:
    literals = [chance.choice([1, 1, -1]) * atom for atom in chance.sample(range(1, 8), chance.choice([0, 0, 1, 2, 3]))]
    heads = tuple(chance.sample(range(1, 8), chance.choice([0, 1, 1, 1, 1, 2])))
    if chance.random() < 0.3:
        weights = tuple(chance.randint(1, 3) for _ in literals)
        return Rule(heads, tuple(literals), len(heads) > 1, chance.randint(0, 5), weights)
    return Rule(heads, tuple(literals), len(heads) > 1 or (bool(heads) and chance.random() < 0.2))


def answer_sets(rules: Sequence[Rule]) -> list[set[int]]:
    """The sets that are the least model of their own reduct; of weighted choices that go around clasp loses some."""
    sets = (set(each) for size in range(8) for each in combinations(range(1, 8), size))
    return [found for found in sets if follows(rules, found) == found]


def follows(rules: Sequence[Rule], assumed: set[int]) -> set[int] | None:
    """What rules derive where only what is `assumed` may be chosen, and all else is false; None if one forbids it."""
    derived: set[int] = set()
    while True:
        held = [rule for rule in rules if holds(rule, derived, assumed)]
        if not all(rule.heads for rule in held):
            return None
        new = {head for rule in held for head in rule.heads if not rule.choice or head in assumed}
        if new <= derived:
            return derived
        derived |= new


def holds(rule: Rule, derived: set[int], assumed: set[int]) -> bool:
    true = [literal in derived if literal > 0 else -literal not in assumed for literal in rule.body]
    if rule.weights:
        return sum(weight for weight, each in zip(rule.weights, true, strict=True) if each) >= rule.bound
    return all(true)


def test_settled_rules_have_the_same_answer_sets(chance: Chance) -> None:
    for number in range(chance.examples(150)):
        drawn = chance.generator(number)
        rules = [drawn_rule(drawn) for _ in range(drawn.randint(1, 9))]
        settled, facts = propagate_facts(rules)
        assert answer_sets(settled) == answer_sets(rules), rules
        assert not any(abs(literal) in facts for rule in settled for literal in rule.body), rules
