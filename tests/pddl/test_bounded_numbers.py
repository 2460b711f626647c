"""Numbers that actions change within bounds are counted as by a forward search over numbers."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable
from fractions import Fraction
from pathlib import Path

import pytest

from prag_asp import DomainError, load_domain
from prag_asp.pddl import read
from tests.pddl.imports import counts, written

TRUCKS = """(define (domain d) (:types truck place) (:predicates (at ?t - truck ?p - place) (sign))
 (:functions (fuel ?t - truck) (dist ?a ?b - place) (tank) (trips))
 (:action drive :parameters (?t - truck ?a ?b - place)
  :precondition (and (at ?t ?a) (>= (fuel ?t) (dist ?a ?b)))
  :effect (and (at ?t ?b) (not (at ?t ?a)) (decrease (fuel ?t) (dist ?a ?b)) (increase (trips) 1)))
 (:action refill :parameters (?t - truck) :precondition (< (fuel ?t) (tank)) :effect (assign (fuel ?t) (tank)))
 (:action pour :parameters (?t ?u - truck)
  :precondition (and (not (= ?t ?u)) (>= (fuel ?t) 1) (not (> (+ (fuel ?u) 1) (tank))))
  :effect (and (decrease (fuel ?t) 1) (increase (fuel ?u) 1)))
 (:action leak :parameters ()
  :effect (forall (?t - truck) (when (> (fuel ?t) 1.5) (and (sign) (decrease (fuel ?t) 1.5))))))"""
START = """(define (problem e) (:domain d) (:objects t u - truck a b c - place)
 (:init (at t a) (at u b) (= (fuel t) 2) (= (fuel u) 0) (= (tank) 3) (= (trips) 0)
  (= (dist a b) 1) (= (dist b a) 2) (= (dist b c) 2)) (:goal {}))"""
DIST = {("a", "b"): 1, ("b", "a"): 2, ("b", "c"): 2}
State = tuple[str, str, Fraction, Fraction, bool]


def after(state: State) -> list[State]:
    """Return the states after each action, written out by hand."""
    *places, first, second, sign = state
    fuel = [first, second]
    found: list[State] = []

    def add(places: list[str], fuel: list[Fraction], sign: bool) -> None:
        found.append((places[0], places[1], fuel[0], fuel[1], sign))

    for truck in (0, 1):
        for (one, other), length in DIST.items():
            if places[truck] == one and fuel[truck] >= length:
                moved = [other if each == truck else places[each] for each in (0, 1)]
                add(moved, [fuel[each] - length * (each == truck) for each in (0, 1)], sign)
        if fuel[truck] < 3:
            add(places, [Fraction(3) if each == truck else fuel[each] for each in (0, 1)], sign)
        if fuel[truck] >= 1 and fuel[1 - truck] + 1 <= 3:
            add(places, [fuel[each] + (-1 if each == truck else 1) for each in (0, 1)], sign)
    full = [each > 1.5 for each in fuel]
    add(places, [each - Fraction(3, 2) * more for each, more in zip(fuel, full, strict=True)], sign or any(full))
    return found


@pytest.mark.parametrize(
    ("goal", "reached"),
    [
        ("(and)", lambda state: True),
        ("(> (fuel t) (fuel u))", lambda state: state[2] > state[3]),
        ("(and (at t c) (= (fuel t) 0))", lambda state: state[0] == "c" and state[2] == 0),
        ("(not (= (fuel t) (+ (fuel u) 0.5)))", lambda state: state[2] != state[3] + Fraction(1, 2)),
        ("(and (sign) (exists (?t - truck) (< (fuel ?t) 1)))", lambda state: state[4] and min(state[2:4]) < 1),
        ("(forall (?t - truck) (<= (fuel ?t) 1))", lambda state: max(state[2:4]) <= 1),
    ],
)
def test_bounded_numbers_have_the_plans_of_a_search_over_numbers(
    goal: str, reached: Callable[[State], bool], tmp_path: Path
) -> None:
    states: Counter[State] = Counter({("a", "b", Fraction(2), Fraction(0), False): 1})
    expected = []
    for _ in range(4):
        expected.append(sum(number for state, number in states.items() if reached(state)))
        following: Counter[State] = Counter()
        for state, number in states.items():
            for new in after(state):
                following[new] += number
        states = following
    loaded = load_domain(*written(tmp_path, TRUCKS, START.format(goal)))
    assert counts(loaded, 3, "automaton") == expected
    assert counts(loaded, 2, "clingo") == expected[:3]
    assert [each.text.partition(",")[0] for each in loaded.warnings] == ["no condition reads the function trips"]


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("(>= (fuel ?t) 1) (not", "(not", "fuel takes more than 200 values"),
        ("(not (= ?t ?u)) ", "", "9: fuel is changed twice by one action, and conditions read it; join"),
        (
            "(decrease (fuel ?t) 1.5)",
            "(forall (?p - place) (decrease (fuel ?t) 0.1))",
            "a 'forall' changes fuel",
        ),
        (
            "(decrease (fuel ?t) 1.5)",
            "(decrease (fuel ?t) (dist b b))",
            "dist has no initial value for all its objects",
        ),
    ],
)
def test_numbers_that_are_not_bounded_are_refused(old: str, new: str, message: str, tmp_path: Path) -> None:
    assert old in TRUCKS
    paths = written(tmp_path, TRUCKS.replace(old, new, 1), START.format("(and)"))
    with pytest.raises(DomainError, match=message):
        read(*paths)
