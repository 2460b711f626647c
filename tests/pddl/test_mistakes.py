"""What is wrong with files of PDDL is one line: where, what, and what to do."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis.strategies import DataObject, data, permutations

from prag_asp import DomainError, load_domain
from prag_asp.pddl import read
from tests.chance import examples
from tests.pddl.imports import written

GOOD = """(define (domain d)
 (:requirements :strips)
 (:types a b - c)
 (:constants k - a)
 (:predicates (p ?x - a) (q ?x ?y))
 (:functions (total-cost) - number (far ?x) - number)
 (:action act
  :parameters (?x - a ?y)
  :precondition (and (p ?x) (q ?x ?y))
  :effect (and (not (p ?x))
    (increase (total-cost) 1))))
"""
PROBLEM = "(define (problem e)\n (:domain d)\n (:objects o - b)\n (:init (q k o))\n (:goal (p k)))\n"


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("(p ?x) (q", "(pp ?x) (q", "domain.pddl:9: unknown predicate pp; did you mean p?"),
        ("(q ?x ?y))\n  :e", "(q ?x))\n  :e", "domain.pddl:9: q takes 2 arguments, not 1; fix them"),
        ("(q ?x ?y))\n  :e", "(q ?x ?z))\n  :e", r"domain.pddl:9: unknown variable \?z; declare it"),
        ("(q ?x ?y))\n  :e", "(q ?x kk))\n  :e", "domain.pddl:9: unknown object kk; did you mean k?"),
        ("?x - a ?y)\n", "?x - aa ?y)\n", "domain.pddl:8: unknown type aa; did you mean a?"),
        ("?x - a ?y)\n", "?x - a ?x)\n", "domain.pddl:8: the variable \\?x is declared twice"),
        ("a b - c", "a - b b - c c - a", "domain.pddl:3: types form a cycle"),
        ("(q ?x ?y))\n (", "(p ?x))\n (", "domain.pddl:5: the predicate p is declared twice"),
        ("(:action act", "(:durative-action act", "pddl:7: :durative-action: .* be imported; give --untimed"),
        ("(increase (total-cost) 1)", "(increase (total-cost) 1.2.3)", "domain.pddl:11: 1.2.3 is not a number; write"),
        ("(increase (total-cost) 1)", "(increase (total-cost) (fat k))", "domain.pddl:11: unknown function fat; did"),
        ("(increase (total-cost) 1)", "(probabilistic 1/2 (p k))", "domain.pddl:11: probabilistic: effects by chance"),
        ("(increase (total-cost) 1)", "(oneof (p k) k)", "domain.pddl:11: oneof has 1 effect and something else"),
        ("(increase (total-cost) 1)", "(forall (?z) (oneof (p k) (q k ?z)))", "domain.pddl:11: oneof below .for"),
        ("(not (p ?x))", "(oneof () (q k k)) " * 10, "domain.pddl:10: this effect has more than 1,000 outcomes; "),
        ("(q k o)", "(oneof (q k o) (q o o))", "problem.pddl:4: oneof: initial states of which one is true cannot be"),
        ("(p ?x) (q ?x ?y)", "(p ?x)) (q ?x ?y)", "domain.pddl:11: this '.' closes nothing; remove it"),
        (":parameters", ":parameter", "domain.pddl:8: ':parameter' is not expected here; look for a misspelt word"),
        ("(:predicates", "(:functions (f) - number) (:predicates",
         "domain.pddl:6: a second :functions; merge them into one"),
        ("b - c)", "b - c (:constants l - a))", "domain.pddl:3: .*; look for a misspelt word or a missing parenthesis"),
        (":effect", ":parameters", "domain.pddl:10: a second :parameters of this action; merge them into one"),
        (":effect", ":variables", "domain.pddl:10: ':variables' is not expected here; look for a misspelt word"),
        ("1))))", "1)))", "domain.pddl:11: the file ends while 1 '.' is open; close each with"),
        ("(p ?x) (q", "(and " * 120 + ")" * 120 + " (q", "domain.pddl:9: parentheses are nested more than 100 deep"),
        (GOOD, "", "domain.pddl:1: not a PDDL domain; begin it with"),
        (GOOD, PROBLEM, "domain.pddl:1: this is a problem, but a domain is needed; give the domain first"),
        ("o - b", "o - bb", "problem.pddl:3: unknown type bb; did you mean b?"),
        ("o - b", "o - b o - c", "problem.pddl:3: the object o is a b already; give it one type"),
        ("(q k o)", "(q k oo)", "problem.pddl:4: unknown object oo; did you mean o?"),
        ("(q k o)", "(q k)", "problem.pddl:4: q takes 2 arguments, not 1"),
        ("(q k o)", "(qq k)", "problem.pddl:4: unknown predicate qq; did you mean q?"),
        ("(q k o)", "(= (far k) 1.2.3)", "problem.pddl:4: 1.2.3 is not a number; write one such as 2 or 0.5"),
        ("(q k o)", "(= (far k) 1) (= (far k) 2)", r"problem.pddl:4: .far k. has two values; state one"),
        ("(q k o)", "(q k o) (not (q k o))", r"problem.pddl:4: .q k o. is both true and false at the start; state one"),
        ("(q k o)", "(at 5 (q k o))", "problem.pddl:4: "),
        (" (:init (q k o))\n", "", r"problem.pddl:4: the problem has no \(:init ...\); add it"),
        ("(p k))", "(p ?x))", "problem.pddl:5: unknown variable \\?x"),
        ("(:goal (p k))", "(:goal (or (preference w (p k))))", "problem.pddl:5: preference: preferences cannot be"),
        ("(:goal", "(:constraints (and (preference (always (p k))) (sometime (p k))))\n (:goal",
         "problem.pddl:5: :constraints: constraints on whole plans cannot be imported"),
        (PROBLEM, "; nothing\n", "problem.pddl:1: not a PDDL problem"),
    ],
)  # fmt: skip
def test_the_message_of_a_mistake_has_its_line(old: str, new: str, message: str, tmp_path: Path) -> None:
    assert (old in GOOD) != (old in PROBLEM)
    with pytest.raises(DomainError, match=message) as error:
        read(*written(tmp_path, GOOD.replace(old, new), PROBLEM.replace(old, new)))
    assert len(error.value.lines) == 1


UNUSUAL = """
; a comment with a (
(DEFINE ;and one within
 (Domain D)
 (:functions) (:requirements)
 (:action nothing)
 (:action empty :effect () :precondition () :parameters ())
 (:action also-empty :effect (and) :precondition (and))
 (:action ACT
  :effect (and (not (p ?X)) (Q ?x)) ; (
  :precondition (P ?x)
  :parameters (?x - a))
 (:predicates (p ?x - a) (q ?x))
 (:constants k - a)
 (:types a b))
"""
USUAL = """(define (domain d)
 (:types a b) (:constants k - a) (:predicates (p ?x - a) (q ?x))
 (:action nothing :parameters ())
 (:action empty :parameters ())
 (:action also-empty :parameters ())
 (:action act :parameters (?x - a) :precondition (p ?x) :effect (and (not (p ?x)) (q ?x))))
"""


def test_sections_and_parts_of_actions_come_in_any_order_and_may_be_empty(tmp_path: Path) -> None:
    unusual = "(define (problem e) (:length (:serial 3))\n (:goal ()) (:init (p o)) (:objects o - a) (:domain d))"
    usual = "(define (problem e) (:domain d) (:objects o - a) (:init (p o)) (:goal (and)))"
    found = read(*written(tmp_path, UNUSUAL, unusual))
    assert found.text == read(*written(tmp_path, USUAL, usual)).text
    with pytest.raises(DomainError, match=r"domain.pddl:10: unknown predicate pp; did you mean p\?"):
        read(*written(tmp_path, UNUSUAL.replace("(not (p", "(not (pp"), unusual))
    with pytest.raises(DomainError, match=r"problem.pddl:2: unknown object o2; did you mean o\?"):
        read(*written(tmp_path, USUAL, unusual.replace("(p o)", "(p o2)")))


@settings(max_examples=examples(10))
@given(data=data())
def test_the_order_of_sections_changes_nothing(data: DataObject, folder: Path) -> None:
    texts = []
    for text in (GOOD, PROBLEM):
        begin, *sections = [part.strip() for part in text.rstrip().removesuffix(")").split("\n (")]
        texts.append("\n (".join([begin, *data.draw(permutations(sections))]) + ")")
    assert read(*written(folder, *texts)).text == read(*written(folder, GOOD, PROBLEM)).text


def test_effects_within_effects_are_read_as_one_list(tmp_path: Path) -> None:
    effects = "(and (not (p ?x)) (forall (?z) (and (p ?x) (when (and (q ?x ?y) (p ?x)) (and (q ?y ?x) (p k))))))"
    nested = (
        "(and (and) (and (and (not (p ?x)))) (forall (?z) (and (and (p ?x)) "
        "(and (when (and (and (q ?x ?y)) (p ?x)) (and (and (q ?y ?x)) (and (p k))))))))"
    )
    head = "(define (domain d) (:constants k) (:predicates (p ?x) (q ?x ?y)) (:action act :parameters (?x ?y) :effect"
    problem = "(define (problem e) (:domain d) (:init (p k)) (:goal (p k)))"
    flat, same = (read(*written(tmp_path, f"{head} {each}))", problem)).text for each in (effects, nested))
    assert flat == same


def test_too_many_fluents_or_actions_are_refused_before_they_are_ground(tmp_path: Path) -> None:
    problem = PROBLEM.replace("(:objects o - b)", f"(:objects {' '.join(f'o{n}' for n in range(3200))} o - b)")
    binary = GOOD.replace("(and (not (p ?x))", "(and (not (p ?x)) (q ?x ?y)")
    message = (
        r"domain.pddl:5: q has 10,252,804 of 10,252,805 fluents with 3,202 objects, more than the limit of 1,000,000"
    )
    with pytest.raises(DomainError, match=message):
        read(*written(tmp_path, binary, problem))
    free = GOOD.replace("?x - a ?y)", "?x - a ?y ?z)").replace("(q ?x ?y))\n  :e", ")\n  :e")
    message = r"domain.pddl:7: act has at least 10,252,804 instances with 3,202 objects, more than"
    with pytest.raises(DomainError, match=message):
        read(*written(tmp_path, free, problem.replace("(:init", "(:init (p k)")))
    assert len(load_domain(*written(tmp_path, GOOD, problem)).facts.actions) == 1


def test_types_may_lie_further_above_each_other_than_recursion_reaches(tmp_path: Path) -> None:
    chain = " ".join(f"t{n} - t{n + 1}" for n in range(1200))
    domain = GOOD.replace("a b - c", f"a - t0 b - c {chain}").replace("(p ?x - a)", "(p ?x - t1200)")
    assert "fluent(p(X)) :- is_a(X,t1200)." in read(*written(tmp_path, domain, PROBLEM)).text


WITH_R = GOOD.replace("(q ?x ?y))\n (:f", "(q ?x ?y) (r) (s))\n (:f")
"""The domain with two more predicates, whose rules `derived` adds in line 7."""


def derived(*rules: str) -> str:
    return WITH_R.replace(" (:action", "".join(f" (:derived {rule})\n" for rule in rules) + " (:action")


def test_derived_predicates_are_neither_set_nor_stated(tmp_path: Path) -> None:
    domain = derived("(r) (p k)")
    with pytest.raises(DomainError, match=r"problem.pddl:4: r is a derived predicate, which :init may not state"):
        read(*written(tmp_path, domain, PROBLEM.replace("(q k o)", "(r)")))
    message = r"domain.pddl:11: r is a derived predicate, which no effect may set; remove its rule"
    with pytest.raises(DomainError, match=message):
        read(*written(tmp_path, domain.replace("(not (p ?x))", "(r)"), PROBLEM))


@pytest.mark.parametrize(
    ("rules", "message"),
    [
        (["(r) (forall (?x - a) (imply (p ?x) (r)))"], "7: r depends on r below a 'forall', which depends on r"),
        (
            ["(r) (not (exists (?x - a) (and (p ?x) (not (r)))))"],
            "7: r depends on r below a 'forall', which depends on r",
        ),
        (
            ["(r) (or (r) (s))", "(s) (imply (r) (p k))"],
            "8: s depends on the negation of r, which depends on s; remove",
        ),
    ],
)
def test_rules_that_are_not_stratified_are_refused(rules: list[str], message: str, tmp_path: Path) -> None:
    with pytest.raises(DomainError, match=f"domain.pddl:{message}"):
        read(*written(tmp_path, derived(*rules), PROBLEM))
    read(*written(tmp_path, derived("(r) (or (r) (s))", "(s) (or (r) (p k))"), PROBLEM))


def test_a_domain_is_two_files_in_their_order(tmp_path: Path) -> None:
    domain, problem = written(tmp_path, GOOD, PROBLEM)
    assert load_domain(domain, problem).name == "d_e"
    with pytest.raises(DomainError, match=r"one file of PDDL; give a domain, then its problem: DOMAIN.pddl PROB"):
        load_domain(domain)
    with pytest.raises(DomainError, match=r"3 files of PDDL; give a domain, then its problem"):
        load_domain(domain, problem, tmp_path / "other.pddl")
    with pytest.raises(DomainError, match=r"this is a problem, but a domain is needed; give the domain first"):
        load_domain(problem, domain)
    with pytest.raises(DomainError, match=r"missing.pddl:1: cannot be read: No such file"):
        load_domain(domain, tmp_path / "missing.pddl")
    for files in ((domain, tmp_path), (tmp_path, problem)):
        with pytest.raises(DomainError, match=rf"{tmp_path} is not a file that ends in .pddl; give a domain, then"):
            load_domain(*files)


def test_logic_of_ones_own_joins_files_of_pddl(tmp_path: Path) -> None:
    (tmp_path / "more.lp").write_text("#program step(t).\n:- occurs(act(k,o),t).\n")
    loaded = load_domain(*written(tmp_path, GOOD, PROBLEM), tmp_path / "more.lp")
    assert [str(action) for action in loaded.facts.actions] == ["act(k,o)"]


@pytest.mark.parametrize(
    ("objects", "text"),
    [
        (
            "x -a b - spot",
            "-a after x is neither a type that is declared nor the name before a type; write '- a' for a",
        ),
        ("- spot x", "no name precedes '-'; write names before it, or remove it"),
        ("x - spot - spot", "no name precedes '-'; write names before it, or remove it"),
        ("x - - spot", "'-' is not expected here"),
        ("x -spot y -", "a type is missing after '-'; write it"),
    ],
)
def test_signs_that_no_list_of_names_and_types_has_are_refused(objects: str, text: str, tmp_path: Path) -> None:
    domain = """(define (domain walk) (:types spot) (:predicates (at ?x - spot))
 (:action go :parameters (?a - spot) :effect (at ?a)))"""
    problem = f"(define (problem p) (:domain walk)\n (:objects {objects})\n (:init) (:goal (and)))"
    with pytest.raises(DomainError, match=f"problem.pddl:2: {re.escape(text)}"):
        load_domain(*written(tmp_path, domain, problem))
