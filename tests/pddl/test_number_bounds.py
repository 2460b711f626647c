"""Numbers stay within bounds that an atom remembers, and changes of one number add up."""

from __future__ import annotations

from pathlib import Path

import pytest

from prag_asp import DomainError, load_domain
from prag_asp.pddl import read
from tests.pddl.imports import check_plans, written

VANS = """(define (domain vans) (:types van box) (:predicates (in ?b - box ?v - van) (out ?b - box) (late))
 (:functions (load ?v - van) (room ?v - van) (weight ?b - box) (most))
 (:action fill :parameters (?v - van ?b - box)
  :precondition (and (out ?b) (<= (+ (load ?v) (weight ?b)) (most)))
  :effect (and (not (out ?b)) (in ?b ?v) (increase (load ?v) (weight ?b)) (decrease (room ?v) (weight ?b))))
 (:action empty :parameters (?v - van ?b - box) :precondition (in ?b ?v)
  :effect (and (out ?b) (not (in ?b ?v)) (decrease (load ?v) (weight ?b)) (increase (room ?v) (weight ?b))))
 (:action shake :parameters (?v - van ?b - box) :precondition (and (in ?b ?v) (late)) :effect (not (in ?b ?v)))
 (:action wait :parameters () :effect (late)))"""
BOXES = """(define (problem p) (:domain vans) (:objects v w - van a b c - box)
 (:init (in c w) (out a) (out b) (= (weight a) 1) (= (weight b) 2) (= (weight c) 2) (= (most) 3)
  (= (load v) 0) (= (load w) 2) (= (room v) 5) (= (room w) 1)) (:goal {}))"""


BY_ROOM = VANS.replace("(<= (+ (load ?v) (weight ?b)) (most))", "(>= (room ?v) (weight ?b))")


@pytest.mark.parametrize(
    ("domain", "goal"),
    [
        (VANS, "(and)"),
        (VANS, "(and (< (load w) (load v)) (late))"),
        (BY_ROOM, "(and)"),
        (BY_ROOM, "(or (= (room v) 2) (> (room w) 2))"),
    ],
)
def test_what_an_atom_remembers_bounds_a_number(domain: str, goal: str, tmp_path: Path) -> None:
    check_plans(tmp_path, domain, BOXES.format(goal), automaton=3)


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("(not (in ?b ?v)) (decrease", "(decrease"),
        (":precondition (in ?b ?v)\n", ":precondition (not (in ?b ?v))\n"),
        ("(decrease (load ?v) (weight ?b))", "(decrease (load ?v) 2)"),
        ("(increase (load ?v) (weight ?b))", "(increase (load ?v) 1)"),
        (":effect (late)", ":effect (and (late) (in a v))"),
        (":effect (late)", ":effect (and (late) (decrease (load v) 1))"),
        ("(not (out ?b)) (in ?b ?v)", "(not (out ?b)) (forall (?c - box) (in ?c ?v))"),
        ("(= (weight a) 1)", "(= (weight a) -1)"),
    ],
)
def test_a_number_that_nothing_bounds_is_refused(old: str, new: str, tmp_path: Path) -> None:
    assert (old in VANS) != (old in BOXES)
    with pytest.raises(DomainError, match="load takes more than 200 values"):
        read(*written(tmp_path, VANS.replace(old, new), BOXES.replace(old, new).format("(= (load v) 3)")))


SUMS = """(define (domain sums) (:predicates (p)) (:functions (x) (y) (one))
 (:action up :parameters () :precondition (< (x) 4) :effect (and (increase (x) 3) (decrease (x) (one)) (p)))
 (:action down :parameters () :precondition (> (x) 0)
  :effect (and (decrease (x) (one)) (increase (x) (one)) (decrease (x) 1)))
 (:action use :parameters () :precondition (< (y) 2)
  :effect (and (increase (y) (x)) (decrease (y) (x)) (not (p)))))"""


@pytest.mark.parametrize("one", ["(= (one) 1)", "(= (one) 2)", ""])
@pytest.mark.parametrize("goal", ["(= (x) 2)", "(and (p) (< (x) 3))", "(<= (y) 1)"])
def test_changes_of_one_number_add_up(one: str, goal: str, tmp_path: Path) -> None:
    problem = f"(define (problem q) (:domain sums) (:objects) (:init (= (x) 0) (= (y) 1) {one}) (:goal {goal}))"
    check_plans(tmp_path, SUMS, problem, automaton=4)
    load_domain(tmp_path / "domain.pddl", tmp_path / "problem.pddl")
