"""Actions with several outcomes, hidden variables and fixed durations, beside the same written out by hand."""

from __future__ import annotations

from itertools import product
from pathlib import Path

import pytest

from prag_asp import load_domain
from prag_asp.pddl import read
from tests.pddl.forward import Search
from tests.pddl.imports import counts, written

DICE = """(define (domain dice) (:requirements :non-deterministic) (:types cup)
 (:predicates (full ?c - cup) (six) (lost ?c - cup) (near ?c ?d - cup))
 (:action throw :parameters (?c - cup) :precondition (full ?c)
  :effect (and (not (full ?c)) (oneof (and) (six) (and (lost ?c) (oneof (not (six)) (full ?c)))) (oneof () (lost ?c))))
 (:action fill :parameters (?c - cup) :precondition (not (lost ?c)) :effect (full ?c)))"""
WRITTEN_OUT = """(define (domain dice) (:types cup)
 (:predicates (full ?c - cup) (six) (lost ?c - cup) (near ?c ?d - cup)) {}
 (:action fill :parameters (?c - cup) :precondition (not (lost ?c)) :effect (full ?c)))"""
THROWS = (
    "", "(lost ?c)", "(six)", "(six) (lost ?c)", "(lost ?c) (not (six))", "(lost ?c) (not (six))",
    "(lost ?c) (full ?c)", "(lost ?c) (full ?c)",
)  # fmt: skip
CUPS = """(define (problem p) (:domain dice) (:objects a b - cup) (:init (full a) (near a b) (near b b)) (:goal {}))"""


@pytest.mark.parametrize("goal", ["(and)", "(and (six) (lost a))", "(exists (?c) (and (lost ?c) (full ?c)))"])
def test_each_outcome_is_an_action(goal: str, tmp_path: Path) -> None:
    throws = "\n".join(
        f"(:action throw{n} :parameters (?c - cup) :precondition (full ?c) :effect (and (not (full ?c)) {effect}))"
        for n, effect in enumerate(THROWS)
    )
    problem = CUPS.format(goal)
    loaded = load_domain(*written(tmp_path, DICE, problem))
    assert counts(loaded, 3) == Search(WRITTEN_OUT.format(throws), problem).count(3)
    assert any("each outcome of oneof is read as an action" in each.text for each in loaded.warnings)
    found = read(tmp_path / "domain.pddl", tmp_path / "problem.pddl")
    assert {found.step(name, ["a"]) for name in found.actions} == {"(throw a)", "(fill a)"}


def test_a_predicate_may_be_called_as_outcomes_are(tmp_path: Path) -> None:
    domain = "(define (domain d) (:predicates (oneof ?x ?y)) (:action a :parameters (?x ?y) :effect (oneof ?x ?y)))"
    problem = "(define (problem e) (:domain d) (:objects o u) (:init) (:goal (oneof o u)))"
    assert counts(load_domain(*written(tmp_path, domain, problem)), 2) == Search(domain, problem).count(2)


def test_hidden_variables_are_further_parameters(tmp_path: Path) -> None:
    hidden = WRITTEN_OUT.format(
        """(:action pour :parameters (?c - cup) :vars (?d - cup) :precondition (and (full ?c) (near ?c ?d))
            :effect (and (full ?d) (not (full ?c))))"""
    )
    shown = hidden.replace("(?c - cup) :vars (?d - cup)", "(?c - cup ?d - cup)")
    problem = CUPS.format("(full b)")
    assert counts(load_domain(*written(tmp_path, hidden, problem)), 3) == Search(shown, problem).count(3)


def test_a_predicate_that_only_the_domain_uses_is_declared_by_its_use(tmp_path: Path) -> None:
    domain = """(define (domain d) (:predicates (on ?x)) (:action a :parameters (?x ?y)
     :precondition (and (on ?x) (not (alike ?x ?y))) :effect (on ?y)))"""
    problem = """(define (problem e) (:domain d) (:objects o u v)
     (:init (on o) (alike o o) (alike u u) (alike o v)) (:goal (on v)))"""
    loaded = load_domain(*written(tmp_path, domain, problem))
    assert counts(loaded, 3) == Search(domain, problem).count(3)
    assert [each.text for each in loaded.warnings] == ["the predicate alike is not declared; declare it in :predicates"]


def test_lines_after_slashes_are_comments(tmp_path: Path) -> None:
    text = WRITTEN_OUT.format("// :action (a\n // (b")
    loaded = load_domain(*written(tmp_path, text, CUPS.format("(full b)").replace("(:init", "//x)\n(:init")))
    assert counts(loaded, 2) == Search(WRITTEN_OUT.format(""), CUPS.format("(full b)")).count(2)


def test_what_changes_at_a_time_is_ignored_on_request(tmp_path: Path) -> None:
    text = WRITTEN_OUT.format("")
    start = CUPS.format("(or (full b) (six))")
    timed = start.replace("(:init", "(:init (at 0 (six)) (at 0.5 (not (six))) (at 7 (lost b)) (at 0.0 (lost a))")
    loaded = load_domain(*written(tmp_path, text, timed), untimed=True)
    assert counts(loaded, 3) == Search(text, start.replace("(:init", "(:init (six) (lost a)")).count(3)
    assert [each.line for each in loaded.warnings if "at a time are ignored" in each.text] == [1, 1]


CHARGE = """(define (domain d) (:types car) (:predicates (ready ?c - car)) (:functions (level ?c) (speed ?c))
 (:durative-action charge :parameters (?c - car) :duration {duration}
  :condition (at start (< (level ?c) 9)) :effect (and (at end (increase (level ?c) (* 2 ?duration)))
   (at end (forall (?c - car) (ready ?c))))))"""
CARS = """(define (problem e) (:domain d) (:objects a b - car)
 (:init (= (level a) 0) (= (level b) 8) (= (speed a) 3) (= (speed b) 0.5)) (:goal (>= (level a) {least})))"""


@pytest.mark.parametrize(
    ("duration", "lengths", "least"),
    [
        ("(= ?duration (speed ?c))", {"a": 3.0, "b": 0.5}, 6),
        ("(and (= ?duration 2))", {"a": 2, "b": 2}, 12),
        ("(at start (= ?duration 5))", {"a": 5, "b": 5}, 10),
    ],
)
def test_a_fixed_duration_is_a_number(duration: str, lengths: dict[str, float], least: int, tmp_path: Path) -> None:
    paths = written(tmp_path, CHARGE.format(duration=duration), CARS.format(least=least))
    expected = []
    for length in range(4):
        expected.append(0)
        for cars in product("ab", repeat=length):
            level = {"a": 0.0, "b": 8.0}
            for car in cars:
                level[car] = level[car] + 2 * lengths[car] if level[car] < 9 else float("nan")
            expected[-1] += level["a"] >= least and level["b"] >= 0
    assert counts(load_domain(*paths, untimed=True), 3) == expected
