"""What own rules over time say in other ways than usual leaves out no action that may occur.

The counts are those of all answer sets of the shipped encodings, unrolled, where nothing is left out.
"""

from __future__ import annotations

from pathlib import Path
from shutil import copytree

import pytest

from prag_asp import DomainError, TaskSpace, load_domain
from prag_asp.program.paths import data_folder

START = "fluent(f;g). initially((f;g),false). action(a;b). precondition(b,f,true). "

CASES = {
    "a head under a condition that is negated": (
        START + "low(g).\n#program step(t).\n"
        "set(F,t) : fluent(F), not low(F) :- occurs(a,t). holds(F,true,t) :- set(F,t). changed(F,t) :- set(F,t).",
        [1, 2, 4],
    ),
    "a start that depends on a choice": (
        START + "action(c). precondition(c,g,true). 1 { hidden(f,0); hidden(g,0) } 1.\n#program step(t).\n"
        "hidden(F,t) :- hidden(F,t-1). holds(F,true,t) :- hidden(F,t-1), occurs(a,t). "
        "changed(F,t) :- hidden(F,t-1), occurs(a,t).",
        [1, 3, 7],
    ),
    "a value of its own": (
        "fluent(level;open). action(raise;hatch;leave). initially((level;open),false). "
        "precondition(leave,open,true).\n#program step(t).\nholds(level,high,t) :- occurs(raise,t). "
        "holds(open,true,t) :- occurs(hatch,t), holds(level,high,t-1). "
        "changed(open,t) :- occurs(hatch,t), holds(level,high,t-1).",
        [2, 4, 9],
    ),
    "a value from elsewhere": (
        "fluent(level;open). action(raise;hatch;leave). initially((level;open),false). rise(high). "
        "precondition(leave,open,true).\n#program step(t).\nholds(level,V,t) :- occurs(raise,t), rise(V). "
        "holds(open,true,t) :- occurs(hatch,t), holds(level,high,t-1). "
        "changed(open,t) :- occurs(hatch,t), holds(level,high,t-1).",
        [2, 4, 9],
    ),
    "a fluent that is none": (
        "fluent(open). action(raise;hatch;leave). initially(open,false). mark(ghost). "
        "precondition(leave,open,true).\n#program step(t).\nholds(ghost,true,t) :- occurs(raise,t). "
        "holds(open,true,t) :- occurs(hatch,t), holds(F,true,t-1), mark(F). "
        "changed(open,t) :- occurs(hatch,t), holds(F,true,t-1), mark(F).",
        [2, 4, 9],
    ),
    "a state at a step by its number": (START + "holds(f,true,2). changed(f,2).", [1, 1, 2]),
    "a head that is negated": (
        START + "\n#program step(t).\nnot holds(f,false,t) :- occurs(a,t). changed(f,t) :- occurs(a,t).",
        [1, 2, 4],
    ),
    "the name of an action that is left out": (
        START + "postcondition(a,g,true). known_b :- name(b,_).\n#program step(t).\n:- occurs(a,t), not known_b.",
        [1, 1, 1],
    ),
    "entities of actions that are left out": (
        "class(k). entity(e,k). fluent(f;g). initially((f;g),false). action(a(e);b(e)). precondition(b(e),f,true). "
        "postcondition(a(e),g,true). two :- 2 { mentions(A,1,E) : action(A), entity(E,k) }.\n#program step(t).\n"
        ":- occurs(a(_),t), not two.",
        [1, 1, 1],
    ),
    "a name that is stated beside those of the library": (
        START + "name(b,special).\n#program step(t).\n"
        "holds(f,true,t) :- occurs(A,t), name(A,a). changed(f,t) :- occurs(A,t), name(A,a).",
        [1, 2, 4],
    ),
    "a predicate called set": (
        START + "box(x).\n#program step(t).\n"
        "set(B,f,true,t) :- occurs(a,t), box(B). holds(F,V,t) :- set(_,F,V,t). changed(F,t) :- set(_,F,_,t).",
        [1, 2, 4],
    ),
    "what lies beside what is read by not": (
        "obj(1..2). fluent(p(X)) :- obj(X). fluent(z). initially((p(2);z),true). action(a;b).\n"
        '#include "rules/closed_world.lp".\n#program step(t).\n'
        "holds(p(1),true,t) :- obj(X), holds(p(X+1),true,t-1), not holds(p(X),true,t-1). "
        "changed(p(1),t) :- obj(X), holds(p(X+1),true,t-1), not holds(p(X),true,t-1).",
        [2, 4, 8],
    ),
    "a counter without an end": (
        "fluent(f). initially(f,false). action(a;b). precondition(b,f,true). cnt(0,0).\n#program step(t).\n"
        "cnt(M,t) :- cnt(N,t-1), M=N+1. holds(f,true,t) :- cnt(2,t). changed(f,t) :- cnt(2,t).",
        [1, 1, 2],
    ),
    "a predicate that depends on names": (
        START + "known_b :- name(b,_).\n#program step(t).\n"
        "holds(f,true,t) :- occurs(a,t), known_b. changed(f,t) :- occurs(a,t), known_b.",
        [1, 2, 4],
    ),
    "an effect that depends on names": (
        "class(k). entity(e,k). fluent(f(E)) :- entity(E,k). initially(f(e),false). action(a(e);b(e)). "
        "precondition(b(E),f(E),true) :- entity(E,k). postcondition(A,f(E),true) :- mentions(A,1,E), name(A,a).",
        [1, 2, 4],
    ),
    "a start that depends on what actions name": (
        "class(k). entity(e,k). fluent(f(e)). fluent(g). initially(f(E),true) :- mentions(_,_,E). "
        'action(a(e);b(e)). precondition(b(e),f(e),true).\n#include "rules/closed_world.lp".',
        [2, 4, 8],
    ),
    "a start with a value of its own": (
        START + "fluent(level). holds(level,high,0).\n#program step(t).\n"
        "holds(f,true,t) :- holds(level,high,t-1), occurs(a,t). changed(f,t) :- holds(level,high,t-1), occurs(a,t).",
        [1, 2, 4],
    ),
    "a change of what is not a fluent": (
        START + "\n#program step(t).\nchanged(ghost,t) :- occurs(a,t). "
        "holds(f,true,t) :- changed(ghost,t). changed(f,t) :- changed(ghost,t).",
        [1, 2, 4],
    ),
    "a predicate that is strongly negated from the start": (
        START + "-u(f,0).\n#program step(t).\n-u(X,t) :- -u(X,t-1). "
        "holds(F,true,t) :- -u(F,t-1), occurs(a,t). changed(F,t) :- -u(F,t-1), occurs(a,t).",
        [1, 2, 4],
    ),
    "a pool in the condition of a head": (
        START + "mark(1).\n#program step(t).\n"
        "{ holds(f,true,t) : mark(1;2) } :- occurs(a,t). changed(f,t) :- occurs(a,t), holds(f,true,t).",
        [1, 2, 4],
    ),
    "another element under a condition": (
        START + "v(9).\n#program step(t).\n{ holds(f,true,t); 1=1 : w(t) } :- occurs(a,t). "
        "changed(f,t) :- occurs(a,t), holds(f,true,t). w(t) :- occurs(b,t).",
        [1, 2, 4],
    ),
    "a change to what the invariants infer": (
        START + "postcondition(a,g,true). implies(g,f).\n#program step(t).\n"
        "changed(F,t) :- holds(F,true,t), holds(F,false,t-1).",
        [1, 2, 4],
    ),
    "an action that follows another": (
        '#include "rules/closed_world.lp".\n#include "rules/ever.lp".\nfluent(lit(1..3)). initially(lit(1),true). '
        "action(go(X)) :- ever(lit(X)). action(rest). precondition(go(X),lit(X),true) :- action(go(X)).\n"
        "#program step(t).\noccurs(rest,t) :- occurs(go(1),t-1).",
        [2, 3, 5],
    ),
    "cells that lie side by side": (
        "cell(1..9,1..9). fluent(wet(X,Y)) :- cell(X,Y). initially(wet(1,1),true). "
        "action(rain). action(sit(X)) :- cell(X,1). precondition(sit(X),wet(X,1),false) :- cell(X,1).\n"
        '#include "rules/closed_world.lp".\n#program step(t).\n'
        "next(X2,Y2,t) :- holds(wet(X,Y),true,t-1), X2=X+1, Y2=Y+1, cell(X2,Y2), occurs(rain,t). "
        "holds(wet(X,Y),true,t) :- next(X,Y,t). changed(wet(X,Y),t) :- next(X,Y,t).",
        [9, 81, 729],
    ),
}


@pytest.mark.parametrize("case", CASES)
def test_actions_that_own_rules_make_possible_are_kept(case: str) -> None:
    text, counts = CASES[case]
    domain = load_domain(text=text)
    for engine in ("auto", "clingo", "sat"):
        found = [TaskSpace(domain, length, engine=engine).count("plan") for length in range(1, 4)]
        assert found == counts, engine


def test_of_cells_that_lie_side_by_side_those_that_stay_dry_are_not_reached() -> None:
    domain = load_domain(text=CASES["cells that lie side by side"][0])
    assert [str(action) for action in domain.facts.unreachable] == ["sit(1)"]


def test_a_pool_of_fluents_is_read_one_by_one() -> None:
    text = (
        "fluent(f;g;h). initially((f;g),false). action(a;b). postcondition(a,g,true). precondition(b,f,true).\n"
        "#program step(t).\nholds(f,true,t) :- holds((g;h),true,t-1), occurs(a,t). "
        "changed(f,t) :- holds((g;h),true,t-1), occurs(a,t)."
    )
    with pytest.raises(DomainError, match="this rule of a step reads h, which is unknown at the start"):
        load_domain(text=text)
    with pytest.raises(DomainError, match=r"this rule of a step reads p\(2\), which is unknown at the start"):
        load_domain(
            text=text.replace("(g;h),true,t-1", "p(1..2),true,t-1")
            + " #program base. fluent(p(1..2)). initially(p(1),true)."
        )
    domain = load_domain(text=f"initially(h,true). {text}")
    assert TaskSpace(domain, 2).count("plan") == 2


def test_whether_a_value_is_false_by_not_or_by_its_opposite_is_the_same() -> None:
    text = (
        "fluent(p;q;r). initially(p,true). initially((q;r),false). action(a;b). goal(r,true). "
        "precondition(b,p,true). postcondition(b,q,true).\n#program step(t).\n"
        "changed(r,t) :- occurs(a,t), holds(p,true,t-1), {}. holds(r,true,t) :- occurs(a,t), holds(p,true,t-1), {}."
    )
    counts = []
    for read in ("not holds(q,true,t-1)", "holds(q,false,t-1)"):
        domain = load_domain(text=text.replace("{}", read))
        space = TaskSpace(domain, 3, engine="automaton")
        counts.append(space.count("plan"))
    assert counts[0] == counts[1] > 0


def test_rules_that_are_added_to_the_encodings_are_rules_over_time_as_well(tmp_path: Path) -> None:
    folder = tmp_path / "encodings"
    copytree(data_folder("encodings"), folder)
    text = START + "also(a,f). #defined also/2."
    assert TaskSpace(load_domain(text=text, encodings=folder), 2).count("plan") == 1
    (folder / "also.lp").write_text(
        "#program step(t).\nholds(F,true,t) :- occurs(A,t), also(A,F). changed(F,t) :- occurs(A,t), also(A,F).\n"
    )
    assert [TaskSpace(load_domain(text=text, encodings=folder), n).count("plan") for n in (1, 2, 3)] == [1, 2, 4]


LAMP = "fluent(f). initially(f,false). action(a;b). "
ONE = "fluent(q). initially(q,false). action(a). "
NUMBERED = {
    LAMP + "slot(1..2).\n#program step(t).\n:- occurs(a,t), not slot(t).": [1, 2, 4, 4],
    LAMP + "late(2).\n#program step(t).\n:- occurs(a,t), late(t).": [1, 2, 2, 4],
    LAMP + "allowed(a,1). allowed(b,2..9).\n#program step(t).\n:- occurs(A,t), not allowed(A,t).": [1, 1, 1, 1],
    LAMP + "busy(T) :- T=2..3.\n#program step(t).\n:- occurs(a,t), busy(t-1).": [1, 2, 4, 4],
    LAMP + "even(0;2).\n#program check(t).\n:- not even(t).": [1, 0, 4, 0],
    LAMP + "first(0).\n#program step(t).\n:- occurs(a,t), not first(t-1).": [1, 2, 2, 2],
    START + "u(1,2).\n#program step(t).\nholds(f,true,t) :- u(1,t). changed(f,t) :- u(1,t).": [1, 1, 1, 2],
    ONE + "goal(q,false).\n#program step(t).\nholds(q,true,t). changed(q,t).": [1, 0, 0, 0],
    ONE + "\n#program step(t).\nu(t).\n#program check(t).\n:- u(t).": [1, 0, 0, 0],
    ONE + "\n#program step(t).\nu(t).\n#program check(t).\n:- not u(t).": [0, 1, 1, 1],
}


@pytest.mark.parametrize("text", NUMBERED)
def test_what_is_stated_of_a_step_by_its_number_is_read_by_every_engine(text: str) -> None:
    domain = load_domain(text=text)
    for engine in ("auto", "clingo", "sat"):
        assert [TaskSpace(domain, n, engine=engine).count("plan") for n in range(4)] == NUMBERED[text], engine
