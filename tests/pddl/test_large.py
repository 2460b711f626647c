"""Of an action with many instances by its types, only those are made whose conditions may ever hold."""

from __future__ import annotations

from collections import Counter
from itertools import pairwise
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis.strategies import integers

from prag_asp import DomainError, load_domain
from prag_asp.pddl import read, size
from prag_asp.pddl.reading.file_reader import read_files
from prag_asp.pddl.translate import Translation
from tests.chance import examples
from tests.pddl.imports import check_plans, counts, searched, with_goal, written
from tests.pddl.random_tasks import random_task
from tests.pddl.tasks import TASKS

JOINED = """(define (domain ring) (:requirements :typing) (:types bead clasp - thing) (:predicates (next ?x ?y - thing))
 (:action turn :parameters (?a ?b ?c ?d ?e ?f - bead) :effect (and (not (next ?a ?b)) (not (next ?e ?f)) (next ?a ?f))
  :precondition (and (next ?a ?b) (next ?b ?c) (next ?c ?d) (next ?d ?e) (next ?e ?f))))"""


def ring(beads: int, links: int) -> str:
    names = [f"b{number}" for number in range(beads)]
    linked = " ".join(f"(next {one} {two})" for one, two in pairwise(names[: links + 1]))
    return f"(define (problem p) (:domain ring) (:objects {' '.join(names)} - bead) (:init {linked}) (:goal (and)))"


def test_joined_conditions_are_ground_where_types_alone_would_make_too_many_actions(tmp_path: Path) -> None:
    """Six beads of sixteen are 17 million rows, of which the links that there are leave a few."""
    domain = load_domain(*written(tmp_path, JOINED, ring(16, 12)))
    assert len(domain.facts.actions) < 1000
    check_plans(tmp_path, JOINED, ring(7, 6), automaton=2, clingo=2)
    assert searched(JOINED, ring(7, 6), 2) == [1, 2, 0]


def test_parameters_that_no_predicate_binds_still_make_too_many(tmp_path: Path) -> None:
    free = JOINED.replace("(next ?b ?c) (next ?c ?d) (next ?d ?e) (next ?e ?f)", "")
    message = (
        r"domain.pddl:2: turn has at least 72,030,000 instances with 70 objects, more than the limit of 10,000,000"
    )
    with pytest.raises(DomainError, match=message):
        load_domain(*written(tmp_path, free, ring(70, 3)))


@pytest.mark.usefixtures("all_large")
@pytest.mark.parametrize("name", TASKS)
def test_all_plans_stay_where_every_action_looks_ahead(name: str, tmp_path: Path) -> None:
    domain, problem = TASKS[name]
    for text in (problem, with_goal(problem, "(and)")):
        check_plans(tmp_path, domain, text, automaton=3, clingo=2)


@settings(max_examples=examples(20))
@given(seed=integers(0, 10**6))
def test_random_tasks_whose_actions_look_ahead_have_the_plans_of_a_forward_search(seed: int, folder: Path) -> None:
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(size, "LARGE", 0)
        check_plans(folder, *random_task(seed), automaton=3)
        assert "#defined ever/1." in read(folder / "domain.pddl", folder / "problem.pddl").text


@settings(max_examples=examples(20))
@given(seed=integers(0, 10**6))
def test_no_action_has_fewer_instances_than_are_said_to_be_made_at_least(seed: int, folder: Path) -> None:
    paths = written(folder, *random_task(seed))
    *files, _ = read_files(*paths)
    words = Translation(*files)
    static = words.words.static
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(size, "LARGE", 0)
        instances = Counter(action.name for action in load_domain(*paths).facts.declared_actions)
    for action in files[0].actions:
        least = size.fewest_instances(action, *files, static, {*words.fluents(), *static})
        number = instances[words.actions[action.name]]
        assert not number or least <= number, f"{action.name} of {seed}"


UNARY = """(define (domain d) (:constants k) (:predicates (p ?x) (r) (lost))
 (:action lose :effect (not (lost)))
 (:action all :parameters (?a ?b ?c ?d) :precondition (and {}) :effect (r)))"""


@pytest.mark.parametrize(
    ("condition", "least"),
    [
        ("(p ?a) (p ?b) (p ?c) (p ?d)", "28,561"),
        ("(p ?a) (not (= ?a ?b)) (not (= ?b ?c)) (not (= ?d k))", f"{13 * 19 * 19 * 19:,}"),
        ("(not (= ?a ?b)) (not (= ?b ?c)) (not (= ?c ?a))", f"{20 * 19 * 18 * 20:,}"),
        ("(p ?a) (p ?a)", ""),
        ("(p ?a) (p ?b) (not (= ?a ?b))", ""),
        ("(= ?a ?b)", ""),
        ("(lost)", ""),
        ("(not (= ?a ?a))", ""),
    ],
)
def test_instances_are_counted_by_what_is_true_at_the_start(
    condition: str, least: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(size, "MOST_ACTIONS", 20_000)
    names = [f"o{number}" for number in range(19)]
    start = " ".join(f"(p {name})" for name in names[:13])
    problem = f"(define (problem e) (:domain d) (:objects {' '.join(names)}) (:init {start}) (:goal (r)))"
    paths = written(tmp_path, UNARY.format(condition), problem)
    if least:
        with pytest.raises(DomainError, match=f"domain.pddl:3: all has at least {least} instances with 20 objects"):
            read(*paths)
    else:
        read(*paths)


JOINED_RULES = """(define (domain d) (:predicates (p ?x) (q ?x) (r))
 (:action make :parameters (?x) :precondition (p ?x) :effect (not (p ?x)))
 (:action use :parameters (?x) :precondition (q ?x) :effect (and (r) (not (q ?x)))))"""
TWO = "(define (problem e) (:domain d) (:objects a b) (:init (p a)) (:goal (and)))"


def test_a_joined_rule_states_what_it_makes_true(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(size, "LARGE", 0)
    paths = written(tmp_path, JOINED_RULES, TWO)
    more = (
        "#program step(t).\nwet(q(X),t) :- occurs(make(X),t).\nholds(F,true,t) :- wet(F,t).\nchanged(F,t) :- wet(F,t)."
    )
    message = (
        r"<text>:3: this rule may make q\(a\) true, but ever does not say so, and .* missing; state ever\(q\(a\)\)"
    )
    with pytest.raises(DomainError, match=message):
        load_domain(*paths, text=more)
    stated = load_domain(*paths, text=f"#program base.\never(q(X)) :- action(make(X)).\n{more}")
    monkeypatch.setattr(size, "LARGE", 10**4)
    whole = load_domain(*paths, text=more)
    assert counts(stated, 3, "automaton") == counts(whole, 3, "automaton") == [1, 1, 1, 0]


CHAIN = """(define (domain chain) (:requirements :adl) (:predicates (bond ?x ?y) (sharp) (hot ?x) (k ?x) (done))
 (:action cut :parameters (?a ?b) :precondition (bond ?a ?b) :effect {})
 (:action blunt :parameters () :precondition (sharp) :effect (not (sharp)))
 (:action heat :parameters (?a) :effect (hot ?a))
 (:action crack :parameters (?a ?b ?c) :precondition (and (bond ?a ?b) (bond ?b ?c)) :effect (done)))"""


@pytest.mark.parametrize(
    "effect",
    [
        "(when (sharp) (not (bond ?a ?b)))",
        "(when (and (hot ?a) (hot ?b) (not (= ?a ?b))) (bond ?b ?a))",
        "(when (and (hot ?a) (= ?a ?b)) (bond ?b ?a))",
        "(when (and (hot ?a) (not (k ?b))) (bond ?b ?a))",
        "(when (and (hot ?a) (k ?b)) (bond ?b ?a))",
        "(when (and (hot ?a) (forall (?c) (or (k ?c) (not (= ?b ?c))))) (bond ?b ?a))",
        "(forall (?c) (when (and (hot ?c) (exists (?d) (not (= ?c ?d)))) (bond ?c ?a)))",
        "(forall (?c) (when (and (hot ?c) (or (sharp) (hot ?a))) (and (bond ?c ?a) (not (bond ?a ?b)))))",
    ],
)
@pytest.mark.usefixtures("all_large")
def test_conditional_effects_of_large_imports_say_enough(effect: str, tmp_path: Path) -> None:
    problem = "(define (problem e) (:domain chain) (:objects a b c) (:init (bond a b) (sharp) (k c)) (:goal (and)))"
    check_plans(tmp_path, CHAIN.format(effect), problem, automaton=3, clingo=3)
    load_domain(tmp_path / "domain.pddl", tmp_path / "problem.pddl", strict=True)


@pytest.mark.usefixtures("all_large")
def test_a_large_import_in_which_nothing_is_true_at_the_start_warns_of_lines_that_there_are(tmp_path: Path) -> None:
    paths = written(tmp_path, JOINED_RULES, TWO.replace("(p a)", ""))
    warnings = load_domain(*paths).warnings
    assert {each.name for each in warnings} == {"never-holds", "no-plan"}
    assert {each.path for each in warnings} == {paths[0]}


@pytest.mark.usefixtures("all_large")
def test_fluents_may_follow_from_the_actions_of_a_large_import(tmp_path: Path) -> None:
    more = "fluent(done(A)) :- action(A). postcondition(A,done(A),true) :- action(A)."
    found = load_domain(*written(tmp_path, JOINED_RULES, TWO), text=more)
    assert sorted(map(str, found.facts.actions)) == ["make(a)"]
    assert counts(found, 2, "automaton") == [1, 1, 0]


APART = """(define (domain d) (:types cup - thing lid - thing mug - cup) (:predicates (on ?x ?y - thing))
 (:action swap :parameters (?c - cup ?l - lid ?m - mug) :precondition (on ?c ?l)
  :effect (and (not (on ?c ?l)) (not (on ?l ?c)) (not (on ?c ?c)) (on ?m ?l))))"""


def test_terms_whose_types_have_nothing_in_common_are_not_compared(tmp_path: Path) -> None:
    problem = "(define (problem p) (:domain d) (:objects c - cup l - lid m - mug) (:init (on c l)) (:goal (and)))"
    check_plans(tmp_path, APART, problem, automaton=3)
    found = read(tmp_path / "domain.pddl", tmp_path / "problem.pddl").text
    deleted = [line for line in found.splitlines() if line.startswith("postcondition") and ", false)" in line]
    assert [line.partition(":- ")[2] for line in deleted] == ["action(swap(C,L,M)).", "action(swap(C,L,M)), C != M."]
    assert deleted[0].startswith("postcondition(swap(C,L,M), (on(L,C); on(C,C)), false)")


@pytest.mark.usefixtures("all_large")
def test_conditional_effects_that_only_make_each_other_true_need_no_ever(tmp_path: Path) -> None:
    domain = """(define (domain d) (:predicates (on ?x ?y) (wet) (dry))
     (:action lift :parameters (?x ?y) :precondition (on ?x ?y)
      :effect (and (when (dry) (and (wet) (not (dry)))) (when (wet) (and (dry) (not (wet)))))))"""
    problem = "(define (problem e) (:domain d) (:objects a b) (:init (on a b)) (:goal (and)))"
    check_plans(tmp_path, domain, problem, automaton=3)


@pytest.mark.usefixtures("all_large")
def test_what_only_conditional_effects_make_true_may_ever_be_so(tmp_path: Path) -> None:
    domain = """(define (domain d) (:predicates (p ?x) (q ?x) (r))
     (:action make :parameters (?x) :effect (when (p ?x) (and (q ?x) (not (p ?x)))))
     (:action use :parameters (?x) :precondition (q ?x) :effect (r)))"""
    problem = "(define (problem e) (:domain d) (:objects a b) (:init (p a)) (:goal (r)))"
    loaded = check_plans(tmp_path, domain, problem, automaton=3)
    assert sorted(map(str, loaded.facts.actions)) == ["make(a)", "make(b)", "use(a)"]
    assert searched(domain, problem, 3)[2] == 1
