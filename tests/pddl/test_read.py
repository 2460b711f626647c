"""Imported domains have just the plans that a forward search over PDDL finds."""

from __future__ import annotations

from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis.strategies import integers

from prag_asp import load_domain
from tests.chance import examples
from tests.ganak import counting_by, one_process
from tests.pddl.imports import check_plans, searched, with_goal, written
from tests.pddl.random_tasks import random_task
from tests.pddl.tasks import TASKS
from tests.spaces import with_engines


@pytest.mark.parametrize("name", TASKS)
def test_all_plans_of_a_problem_are_those_of_a_forward_search(name: str, tmp_path: Path) -> None:
    domain, problem = TASKS[name]
    for text in (problem, with_goal(problem, "(and)")):
        check_plans(tmp_path, domain, text, automaton=4, clingo=3)


@settings(max_examples=examples(20))
@given(seed=integers(0, 10**6))
def test_random_tasks_have_the_plans_of_a_forward_search(seed: int, folder: Path) -> None:
    task = random_task(seed)
    loaded = check_plans(folder, *task, automaton=3, clingo=2)
    assert not any(searched(*task, 3)) or not any(each.name == "no-plan" for each in loaded.warnings)


@settings(max_examples=examples(4))  # a fresh run takes forty
@given(seed=integers(0, 10**6))
def test_every_engine_counts_imported_tasks_as_a_forward_search_does(seed: int, folder: Path) -> None:
    with one_process() as count_models, counting_by(count_models):
        check_plans(folder, *random_task(seed), automaton=3, clingo=3, sat=3, sharp=3, symbolic=3)


@pytest.mark.parametrize(
    "goal",
    [
        "(and (forall (?x - room) (p ?x)) (not (exists (?x - room) (p ?x))))",
        "(and (forall (?x - room) (p ?x)) (not (p a)))",
        "(and (forall (?x - room) (imply (static ?x) (not (p ?x)))) (p a) (not (static b)) (not (= a b)))",
        "(and (p a) (static a))",
    ],
)
def test_goals_that_contradict_themselves_or_facts_are_no_mistakes(goal: str, tmp_path: Path) -> None:
    domain, problem = TASKS["never"]
    check_plans(tmp_path, domain, with_goal(problem, goal), auto=3)


NAMED_T = """(define (domain d) (:requirements :adl) (:types {type}) (:constants {constant} - {type})
 (:predicates (p ?x) (q ?x) ({fluent})) (:action one :parameters (?x - {type}) :precondition (or (p ?x) ({fluent}))
 :effect (and (q ?x) (not (p ?x)) (when (p {constant}) (q {constant})) (when (q ?x) ({fluent})))))"""


@pytest.mark.parametrize(("kind", "constant", "fluent"), ["tab", "bta", "bat", "abk"])
def test_the_name_of_a_step_is_a_name_like_others_in_pddl(
    kind: str, constant: str, fluent: str, tmp_path: Path
) -> None:
    domain = NAMED_T.format(type=kind, constant=constant, fluent=fluent)
    condition = f"(or (q {constant}) (and (q u) (forall (?y - {kind}) (or (q ?y) ({fluent})))))"
    init = f"(:init (p {constant}) (p u))"
    problem = f"(define (problem e) (:domain d) (:objects u - {kind}) {init} (:goal {condition}))"
    check_plans(tmp_path, domain, problem, automaton=3, clingo=3)


@settings(max_examples=examples(12))
@given(seed=integers(0, 10**6))
def test_random_tasks_keep_all_their_rules_under_a_condition(seed: int, folder: Path) -> None:
    domain, problem = random_task(seed)
    plans = searched(domain.replace("(:action go :parameters () :effect (s))", ""), problem, 2)
    loaded = load_domain(*written(folder, domain, problem))
    for space in with_engines(loaded, "automaton", "clingo"):
        assert [space.at(n).where("lacks go").count(by="plan") for n in range(3)] == plans, seed


NOTHING = "(define (domain d) (:constants k) (:predicates (p ?x) (q ?x)) (:action a :parameters (?x) {} :effect (p k)))"
NO_STEP = "no rule states an action, so no plan has a step"


@pytest.mark.parametrize(
    ("domain", "goal", "message"),
    [
        (NOTHING.format(""), "(p o)", "the goal is never reached: it needs p(o) = true"),
        (NOTHING.format(":precondition (p ?x)"), "(p k)", "it needs p(k) = true, and no action that can occur makes"),
        (NOTHING.format(":precondition (q ?x)"), "(and)", NO_STEP),
        (NOTHING.format(":precondition (q ?x)"), "(p o)", NO_STEP),
        ("(define (domain d) (:predicates (p ?x) (q ?x)))", "(and)", NO_STEP),
    ],
)
def test_where_there_is_nothing_to_do_or_to_reach_counts_are_0_and_the_check_warns(
    domain: str, goal: str, message: str, tmp_path: Path
) -> None:
    problem = f"(define (problem e) (:domain d) (:objects o) (:init) (:goal {goal}))"
    loaded = check_plans(tmp_path, domain, problem, automaton=2, clingo=2, sat=2, symbolic=2)
    assert [each for each in loaded.warnings if each.name == "no-plan" and message in each.text]


NEVER_DERIVED = """(define (domain a) (:predicates (is-at ?x) (p ?x)) (:constants k l)
 (:derived (is-at ?x) (and (p ?x) (= k l)))
 (:action m :parameters (?x) :precondition (not (is-at ?x)) :effect (p ?x)))"""


def test_a_predicate_that_no_rule_ever_derives_is_false(tmp_path: Path) -> None:
    for goal in ("(p c)", "(not (is-at c))", "(is-at c)"):
        problem = f"(define (problem q) (:domain a) (:objects c) (:init) (:goal {goal}))"
        domain = check_plans(tmp_path, NEVER_DERIVED, problem, auto=3)
        assert not {each.name for each in domain.warnings} - {"no-plan"}


def test_a_fluent_that_is_read_as_not_true_is_no_choice(tmp_path: Path) -> None:
    domain = """(define (domain d) (:predicates (p) (q) (r))
     (:action a :parameters () :effect (when (and (p) (not (q))) (r)))
     (:action b :parameters () :effect (and (q) (not (p)))))"""
    check_plans(tmp_path, domain, "(define (problem x) (:domain d) (:init (p)) (:goal (r)))", automaton=3)
