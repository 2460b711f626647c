"""Functions whose values are objects are counted as by a search over their tables."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from prag_asp import DomainError, load_domain
from prag_asp.pddl import read
from tests.pddl.imports import counts, written

GOOD = """(define (domain carts) (:requirements :object-fluents) (:types room cart - thing load)
 (:predicates (door ?a ?b - room) (clean ?r - room))
 (:functions (place ?c - cart) - room (cargo ?c - cart) - load (found ?l - load) - room (home ?l - load) - room
  (drives) - number (steps))
 (:action drive :parameters (?c - cart ?to - room) :precondition (and (door (place ?c) ?to) (not (= (place ?c) ?to)))
  :effect (and (assign (place ?c) ?to) (increase (drives) 1)))
 (:action take :parameters (?c - cart ?l - load)
  :precondition (and (= (cargo ?c) undefined) (= (found ?l) (place ?c)))
  :effect (and (assign (cargo ?c) ?l) (assign (found ?l) undefined)))
 (:action drop :parameters (?c - cart ?l - load) :precondition (= ?l (cargo ?c))
  :effect (and (assign (found (cargo ?c)) (place ?c)) (assign (cargo ?c) undefined) (clean (place ?c))))
 (:action meet :parameters (?c ?d - cart) :precondition (not (= ?c ?d))
  :effect (when (= (cargo ?c) (cargo ?d)) (assign (place ?c) (place ?d)))))"""
START = """(define (problem e) (:domain carts) (:objects r s - room c d - cart k l - load)
 (:init (door r s) (door s r) (= (place c) r) (= (place d) s) (= (found k) r) (= (found l) s) (= (cargo c) undefined)
  (= (home k) s)) (:goal {}))"""
State = tuple[tuple[str | None, ...], frozenset[str]]
NAMES = ("place c", "place d", "cargo c", "cargo d", "found k", "found l")
FIRST: State = (("r", "s", None, None, "r", "s"), frozenset())


def after(state: State) -> Iterator[State]:
    """Yield the states after each action, written out by hand."""
    row, clean = state
    value = dict(zip(NAMES, row, strict=True))

    def changed(new: dict[str, str | None], cleaned: frozenset[str] = frozenset()) -> State:
        return tuple({**value, **new}.values()), clean | cleaned

    for cart in "cd":
        place, cargo = value[f"place {cart}"], value[f"cargo {cart}"]
        assert place
        yield changed({f"place {cart}": "s" if place == "r" else "r"})
        for load in "kl":
            if cargo is None and value[f"found {load}"] == place:
                yield changed({f"cargo {cart}": load, f"found {load}": None})
            if cargo == load:
                yield changed({f"cargo {cart}": None, f"found {load}": place}, frozenset([place]))
        other = "d" if cart == "c" else "c"
        yield changed({f"place {cart}": value[f"place {other}"]} if cargo == value[f"cargo {other}"] else {})


@pytest.mark.parametrize(
    ("goal", "reached"),
    [
        ("(and)", lambda value, clean: True),
        ("(= (found k) (home k))", lambda value, clean: value["found k"] == "s"),
        ("(not (= (cargo c) k))", lambda value, clean: value["cargo c"] != "k"),
        ("(= (cargo c) (cargo d))", lambda value, clean: value["cargo c"] == value["cargo d"]),
        ("(clean (found l))", lambda value, clean: value["found l"] in clean),
        ("(not (clean (found l)))", lambda value, clean: value["found l"] not in clean),
        (
            "(exists (?c - cart) (not (= (cargo ?c) undefined)))",
            lambda value, clean: value["cargo c"] or value["cargo d"],
        ),
    ],
)
def test_functions_of_objects_have_the_plans_of_a_search(
    goal: str, reached: Callable[[dict[str, str | None], frozenset[str]], bool], tmp_path: Path
) -> None:
    states: Counter[State] = Counter([FIRST])
    expected = []
    for _ in range(4):
        expected.append(
            sum(n for (row, clean), n in states.items() if reached(dict(zip(NAMES, row, strict=True)), clean))
        )
        following: Counter[State] = Counter()
        for state, number in states.items():
            for new in after(state):
                following[new] += number
        states = following
    loaded = load_domain(*written(tmp_path, GOOD, START.format(goal)))
    assert counts(loaded, 3, "automaton") == expected
    assert counts(loaded, 2, "clingo") == expected[:3]


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("(increase (drives) 1)", "(assign (place d) r)", "6: place may get two values at once; join both changes"),
        ("(increase (drives) 1)", "(forall (?r - room) (assign (cargo ?c) k))", "6: a 'forall' changes cargo several"),
        ("(increase (drives) 1)", "(assign (cargo ?c) ?to)", "6: a value of cargo is a load, not any room; give it"),
        ("(increase (drives) 1)", "(increase (cargo ?c) 1)", "6: increase changes no function of objects here; write"),
        ("(assign (place ?c) ?to)", "(assign (place ?c ?to) ?to)", "6: place takes 1 argument, not 2; fix them"),
        ("(= (place c) r)", "(= (place c) r) (= (place c) s)", r"2: \(place c\) has two values, or one that depends"),
        ("(= (place c) r)", "(= (place c) k)", "2: a value of place is a room, not any load; give it this type"),
    ],
)
def test_functions_of_objects_have_one_value_of_their_type(old: str, new: str, message: str, tmp_path: Path) -> None:
    assert (old in GOOD) != (old in START)
    with pytest.raises(DomainError, match=message):
        read(*written(tmp_path, GOOD.replace(old, new), START.replace(old, new).format("(and)")))
