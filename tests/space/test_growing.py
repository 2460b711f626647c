"""What only seems to grow without end is counted by every engine; what really does is told in one line."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import product

import pytest

from prag_asp import DomainError, EngineError, TaskSpace, load_domain
from prag_asp.program.finite import checks
from tests.domains import domain_of

BELT = """
class(part). class(cell). entity(p1,part). entity(p2,part). entity(c1,cell). entity(c2,cell). entity(c3,cell).
next(c1,c2). next(c2,c3).
fluent(on_belt(P,C)) :- is_a(P,part), is_a(C,cell).
fluent(held(P)) :- is_a(P,part).
fluent(free).
action(take(P,C)) :- is_a(P,part), is_a(C,cell).
precondition(take(P,C),on_belt(P,C),true) :- action(take(P,C)).
precondition(take(P,C),free,true) :- action(take(P,C)).
postcondition(take(P,C),on_belt(P,C),false) :- action(take(P,C)).
postcondition(take(P,C),held(P),true) :- action(take(P,C)).
postcondition(take(P,C),free,false) :- action(take(P,C)).
action(put(P)) :- is_a(P,part).
precondition(put(P),held(P),true) :- action(put(P)).
precondition(put(P),on_belt(Q,c1),false) :- action(put(P)), is_a(Q,part).
postcondition(put(P),held(P),false) :- action(put(P)).
postcondition(put(P),free,true) :- action(put(P)).
postcondition(put(P),on_belt(P,c1),true) :- action(put(P)).
action(wait).
initially(on_belt(p1,c1),true). initially(on_belt(p2,c2),true). initially(free,true).
#include "rules/closed_world.lp".
#program step(t).
taken(P,t) :- occurs(take(P,_),t).
moved(P,C,D,t) :- holds(on_belt(P,C),true,t-1), next(C,D), not taken(P,t).
holds(on_belt(P,D),true,t) :- moved(P,_,D,t).
changed(on_belt(P,D),t) :- moved(P,_,D,t).
holds(on_belt(P,C),false,t) :- moved(P,C,_,t).
changed(on_belt(P,C),t) :- moved(P,C,_,t).
"""


def plans_on_the_belt(length: int) -> list[tuple[str, ...]]:
    """Return all plans by simulation: where each part is, on the belt or in the hand, from step to step."""
    states: list[tuple[tuple[str, ...], dict[str, str]]] = [((), {"p1": "c1", "p2": "c2"})]
    for _ in range(length):
        states = [onward for plan, places in states for onward in _onward(plan, places)]
    return [plan for plan, _ in states]


def _onward(plan: tuple[str, ...], places: dict[str, str]) -> Iterator[tuple[tuple[str, ...], dict[str, str]]]:
    following = {"c1": "c2", "c2": "c3", "c3": "c3", "hand": "hand"}
    moved = {part: following[place] for part, place in places.items()}
    yield (*plan, "wait"), moved
    if "hand" not in places.values():
        for part, place in places.items():
            yield (*plan, f"take({part},{place})"), {**moved, part: "hand"}
    for part, place in places.items():
        if place == "hand" and "c1" not in places.values():
            yield (*plan, f"put({part})"), {**moved, part: "c1"}


def test_a_conveyor_belt_is_counted_by_every_engine_as_by_simulation() -> None:
    domain = load_domain(text=BELT)
    assert not domain.warnings
    for engine, longest in (("automaton", 6), ("clingo", 4), ("sat", 3)):
        space = TaskSpace(domain, 0, engine=engine)
        for length in range(longest):
            expected = plans_on_the_belt(length)
            assert space.at(length).count("plan") == len(expected), (engine, length)
            assert set(space.at(length).enumerate("plan")) == set(expected), (engine, length)


def test_a_belt_of_many_cells_that_carries_its_own_atoms_comes_to_an_end() -> None:
    cells = 60
    text = f"""
    fluent(f). action(go). action(back). initially(f,true).
    cell(0..{cells - 1}). next(X,Y) :- cell(X), cell(Y), Y = X+1.
    at(part(0),0).
    #program step(t).
    at(part(Y),t) :- at(part(X),t-1), next(X,Y), occurs(go,t).
    at(part(X),t) :- at(part(X),t-1), occurs(back,t).
    :- occurs(go,t), at(part({cells - 1}),t-1).
    """
    space = TaskSpace(domain_of(text), 0, engine="automaton")
    assert [space.at(length).count("plan") for length in (3, cells - 1, cells)] == [8, 2 ** (cells - 1), 2**cells - 1]


STEPS = "fluent(f). action(a). action(b). initially(f,true). "

FINITE = {
    "a sum that a fact bounds": "n(0). top(40). n(X+1) :- n(X), top(Y), X < Y.",
    "a sum that is never of one number": "n(0). n(Y) :- n(X), Y = X+1, X != 40.",
    "numbers modulo another": "n(1). n(X*7\\101) :- n(X).",
    "a wrapped term that is unwrapped again": "n(a). m(f(X)) :- n(X). n(X) :- m(f(X)).",
    "a pair that is turned around": "n((a,b)). n((Y,X)) :- n((X,Y)).",
    "lists of a stated length": "item(a). item(b). list((),0). list((X,L),N+1) :- item(X), list(L,N), N < 3.",
    "a function under a guard by another predicate": "n(a). next(a,b). next(b,c). n(Y) :- n(X), m(f(Y)), next(X,Y).\n"
    "m(f(Y)) :- n(X), next(X,Y).",
    "a term that its own body reads": "n(f(f(f(a)))). n(X) :- n(f(X)). m(f(X)) :- n(X), n(f(X)).",
    "a rule of ever larger terms that is never used": "n(X+1) :- n(X). n(f(X)) :- n(X), none(X). #defined none/1.",
    "a step backwards": "n(40). n(X-1) :- n(X), X > 0.",
    "a step that nothing begins": "#program step(t). n(f(X),t) :- n(X,t).",
    "a step within the names": "c(a). d(a,b). d(b,c). #program step(t). n(X,t) :- c(X).\n"
    "n(s(Y),t) :- n(X,t), d(X,Y). n(Y,t) :- n(s(Y),t).",
    "steps of lists that a comparison ends": "#program base. q((),0,0). #program step(t).\n"
    "q((x,L),N+1,t) :- q(L,N,t-1), N < 5."
    "q(L,N,t) :- q(L,N,t-1), N = 5.",
    "steps that skip one number": "#program base. q(0,0). #program step(t).\n"
    "q(N+1,t) :- q(N,t-1), N != 35. q(35,t) :- q(35,t-1).",
}


@pytest.mark.parametrize("rules", FINITE.values(), ids=FINITE.keys())
def test_what_only_seems_to_grow_is_no_obstacle_to_any_engine(rules: str) -> None:
    domain = load_domain(text=STEPS + rules + "\n#program step(t). :- occurs(b,t), occurs(b,t-1).")
    for engine in ("automaton", "clingo", "sat"):
        assert TaskSpace(domain, 5, engine=engine).count("plan") == 13, engine


ENDLESS = {
    "n(0). n(Y) :- n(X), Y = X+1.": "derives ever larger terms of n without end",
    "n(a). n((X,X)) :- n(X).": "derives ever larger terms of n without end",
    "n(0). n(X-1) :- n(X), m(Y), Y != 3. m(1).": r"derived terms of n from each other 2,000 times",
    "small(0,1). small(Y,Z) :- small(X,Z), Y = X+Z, Z > 0.": r"derived terms of small from each other 2,000 times",
    "n(a). m(f(X)) :- n(X). n(X) :- m(X).": "makes terms of m nested more than 1,000 deep",
    "n(a). n(f(X)) :- n(X), not m(X). m(b).": "makes terms of n nested more than 1,000 deep",
    "n(a). {n(f(X)) : n(X)}.": "makes terms of n nested more than 1,000 deep",
    "n(1). n(X*3) :- n(X).": r"X\*3 is out of range",
    "p(0,0). p(X+1,Y) :- p(X,Y).": "derives ever larger terms of p without end",
}


@pytest.mark.parametrize(("rules", "said"), ENDLESS.items(), ids=ENDLESS.keys())
def test_what_really_grows_is_told_in_one_line(monkeypatch: pytest.MonkeyPatch, rules: str, said: str) -> None:
    monkeypatch.setattr(checks, "MOST_VALUES", 2_000)
    with pytest.raises(DomainError, match=rf"^<text>:2: (this rule )?{said}; [^\n]*$"):
        load_domain(text=f"{STEPS}\n{rules}")


def test_what_grows_within_a_step_is_told_as_well() -> None:
    begun = f"{STEPS}\n#program step(t).\nn(1,t) :- occurs(a,t).\n"
    with pytest.raises(DomainError, match=r"^<text>:4: this rule derives ever larger terms of n without end; [^\n]*$"):
        load_domain(text=f"{begun}n(X+1,t) :- n(X,t).")
    domain = load_domain(text=f"{begun}n(f(X),t) :- m(X,t).\nm(X,t) :- n(X,t).")
    for engine, error in (("automaton", EngineError), ("clingo", DomainError), ("sat", DomainError)):
        with pytest.raises(error, match=r"^<text>:4: this rule makes terms of n nested more than 1,000 deep; [^\n]*$"):
            TaskSpace(domain, 3, engine=engine).count("plan")


def test_a_number_that_goes_out_of_range_after_many_steps_is_no_obstacle_before() -> None:
    domain = load_domain(text=STEPS + "#program base. n(1,0).\n#program step(t).\nn(X*2,t) :- n(X,t-1), occurs(a,t).\n"
                              "n(X,t) :- n(X,t-1), occurs(b,t). :- n(8,t-1), occurs(a,t).")  # fmt: skip
    with pytest.raises(EngineError, match=r"^<text>:3: X\*2 is out of range"):
        TaskSpace(domain, 4, engine="automaton").count("plan")
    expected = sum(word.count("a") <= 3 for word in product("ab", repeat=5))
    assert TaskSpace(domain, 5).count("plan") == expected
    with pytest.raises(DomainError, match=r"^<text>:3: X\*2 is out of range"):
        TaskSpace(domain, 32).count("plan")
