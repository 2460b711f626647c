"""Imported domains have just the plans that a forward search over PDDL finds."""

from __future__ import annotations

from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis.strategies import integers

from prag_asp import TaskSpace, load_domain
from prag_asp.pddl import read
from tests.chance import examples
from tests.pddl.forward import Search
from tests.pddl.random_tasks import random_task
from tests.pddl.tasks import TASKS
from tests.spaces import with_engines

LENGTH = 4


def written(folder: Path, domain: str, problem: str) -> tuple[Path, Path]:
    paths = folder / "domain.pddl", folder / "problem.pddl"
    for path, text in zip(paths, (domain, problem), strict=True):
        path.write_text(text)
    return paths


@pytest.mark.parametrize("name", TASKS)
def test_all_plans_of_a_problem_are_those_of_a_forward_search(name: str, tmp_path: Path) -> None:
    domain, problem = TASKS[name]
    goalless = f"{problem[: problem.index('(:goal')]}(:goal (and)))"
    for text in (problem, goalless):
        counts = Search(domain, text).count(LENGTH)
        loaded = load_domain(*written(tmp_path, domain, text))
        for space, most in zip(with_engines(loaded, "automaton", "clingo"), (LENGTH, 3), strict=True):
            found = [space.at(n).count(by="plan") for n in range(most + 1)]
            assert found == counts[: most + 1], read(*written(tmp_path, domain, text)).text


@settings(max_examples=examples(30))
@given(seed=integers(0, 10**6))
def test_random_tasks_have_the_plans_of_a_forward_search(seed: int, tmp_path_factory: pytest.TempPathFactory) -> None:
    domain, problem = random_task(seed)
    counts = Search(domain, problem).count(3)
    paths = written(tmp_path_factory.mktemp("random"), domain, problem)
    loaded = load_domain(*paths)
    assert not any(counts) or not any(each.name == "no-plan" for each in loaded.warnings)
    for space, most in zip(with_engines(loaded, "automaton", "clingo"), (3, 2), strict=True):
        found = [space.at(n).count(by="plan") for n in range(most + 1)]
        assert found == counts[: most + 1], f"{seed}\n{domain}\n{problem}\n{read(*paths).text}"


@settings(max_examples=examples(4))  # a fresh run takes forty
@given(seed=integers(0, 10**6))
def test_every_engine_counts_imported_tasks_as_a_forward_search_does(
    seed: int, tmp_path_factory: pytest.TempPathFactory
) -> None:
    task = random_task(seed)
    counts = Search(*task).count(3)
    loaded = load_domain(*written(tmp_path_factory.mktemp("random"), *task))
    for engine in ("automaton", "clingo", "sat", "sharp", "symbolic"):
        assert [TaskSpace(loaded, n, engine=engine).count(by="plan") for n in range(4)] == counts, (seed, engine)


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
    problem = f"{problem[: problem.index('(:goal')]}(:goal {goal}))"
    loaded = load_domain(*written(tmp_path, domain, problem))
    space = TaskSpace(loaded, 0)
    assert [space.at(n).count(by="plan") for n in range(4)] == Search(domain, problem).count(3)


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
    loaded = load_domain(*written(tmp_path, domain, problem))
    for space in with_engines(loaded, "automaton", "clingo"):
        assert [space.at(n).count(by="plan") for n in range(4)] == Search(domain, problem).count(3)


@settings(max_examples=examples(20))
@given(seed=integers(0, 10**6))
def test_random_tasks_keep_all_their_rules_under_a_condition(
    seed: int, tmp_path_factory: pytest.TempPathFactory
) -> None:
    domain, problem = random_task(seed)
    without = domain.replace("(:action go :parameters () :effect (s))", "")
    counts = Search(without, problem).count(2)
    loaded = load_domain(*written(tmp_path_factory.mktemp("random"), domain, problem))
    for space in with_engines(loaded, "automaton", "clingo"):
        assert [space.at(n).where("lacks go").count(by="plan") for n in range(3)] == counts, seed


NOTHING = "(define (domain d) (:constants k) (:predicates (p ?x) (q ?x)) (:action a :parameters (?x) {} :effect (p k)))"


@pytest.mark.parametrize(
    ("domain", "goal", "told"),
    [
        (NOTHING.format(""), "(p o)", "the goal is never reached: it needs p(o) = true"),
        (
            NOTHING.format(":precondition (p ?x)"),
            "(p k)",
            "it needs p(k) = true, and no action that can occur makes",
        ),
        (NOTHING.format(":precondition (q ?x)"), "(and)", "no rule states an action, so no plan has a step"),
        (NOTHING.format(":precondition (q ?x)"), "(p o)", "no rule states an action, so no plan has a step"),
        ("(define (domain d) (:predicates (p ?x) (q ?x)))", "(and)", "no rule states an action, so no plan has a step"),
    ],
)
def test_where_there_is_nothing_to_do_or_to_reach_counts_are_0_and_the_check_warns(
    domain: str, goal: str, told: str, tmp_path: Path
) -> None:
    problem = f"(define (problem e) (:domain d) (:objects o) (:init) (:goal {goal}))"
    loaded = load_domain(*written(tmp_path, domain, problem))
    assert [each for each in loaded.warnings if each.name == "no-plan" and told in each.text]
    counts = Search(domain, problem).count(2)
    for space in with_engines(loaded, "automaton", "clingo", "sat", "symbolic"):
        assert [space.at(n).count(by="plan") for n in range(3)] == counts


NEVER_DERIVED = """(define (domain a) (:predicates (is-at ?x) (p ?x)) (:constants k l)
 (:derived (is-at ?x) (and (p ?x) (= k l)))
 (:action m :parameters (?x) :precondition (not (is-at ?x)) :effect (p ?x)))"""


def test_what_no_rule_ever_derives_is_false(tmp_path: Path) -> None:
    for goal in ("(p c)", "(not (is-at c))", "(is-at c)"):
        problem = f"(define (problem q) (:domain a) (:objects c) (:init) (:goal {goal}))"
        domain = load_domain(*written(tmp_path, NEVER_DERIVED, problem))
        assert not {each.name for each in domain.warnings} - {"no-plan"}
        counts = [TaskSpace(domain, n).count(by="plan") for n in range(4)]
        assert counts == Search(NEVER_DERIVED, problem).count(3)


def test_what_is_read_as_not_true_is_not_held_for_a_choice(tmp_path: Path) -> None:
    domain = """(define (domain d) (:predicates (p) (q) (r))
     (:action a :parameters () :effect (when (and (p) (not (q))) (r)))
     (:action b :parameters () :effect (and (q) (not (p)))))"""
    problem = "(define (problem x) (:domain d) (:init (p)) (:goal (r)))"
    loaded = load_domain(*written(tmp_path, domain, problem))
    counts = [TaskSpace(loaded, n, engine="automaton").count(by="plan") for n in range(4)]
    assert counts == Search(domain, problem).count(3)
