"""Random logic programs of every kind of statement that has answer sets, and clingo's own word on them."""

from __future__ import annotations

from collections import Counter
from fractions import Fraction
from math import prod

import clingo
from hypothesis import strategies as st

from prag_asp import QueryError, answer_sets

ATOMS = ("a", "b", "c", "d", "e", "-a", "-c", "p(1)", "p(2)", "p(3)", "q(1)", "q(2)")
OPEN = "{p(1..2); d; e}. "
WEIGHT = 'weight(p(1),2). weight(p(2),(1,3)). weight(d,"0.5"). weight(e,0). weight(-a,3).'

atom = st.sampled_from(ATOMS)
literal = st.builds(str.__add__, st.sampled_from(["", "", "", "not ", "not not "]), atom)
number = st.integers(-2, 4)


@st.composite
def element(draw: st.DrawFn) -> str:
    return f"{draw(number)},{draw(st.integers(1, 4))}: {draw(literal)}"


@st.composite
def body_part(draw: st.DrawFn) -> str:
    some = ";".join(draw(st.lists(element(), min_size=1, max_size=4)))
    atoms = ";".join(draw(st.lists(literal, min_size=1, max_size=4)))
    return draw(
        st.one_of(
            literal, literal, literal,
            st.just(f"{draw(number)} #sum {{{some}}} {draw(number)}"),
            st.just(f"not #sum {{{some}}} >= {draw(number)}"),
            st.just(f"{draw(st.integers(0, 2))} {{{atoms}}} {draw(st.integers(1, 3))}"),
            st.just(f"#sum+ {{{some}}} >= {draw(number)}"),
            st.just("p(X) : q(X)"),
            st.just("not p(X) : X=1..2, q(X)"),
            st.just(f"#count {{X : p(X), not q(X)}} {draw(st.sampled_from(['<=', '!=', '=']))} {draw(number)}"),
        )
    )  # fmt: skip


@st.composite
def head(draw: st.DrawFn) -> str:
    atoms = draw(st.lists(atom, min_size=1, max_size=3))
    joined = ";".join(atoms)
    low, high = draw(st.integers(0, 1)), draw(st.integers(1, 3))
    return draw(
        st.sampled_from(
            [atoms[0], atoms[0], atoms[0], f"{{{joined}}}", f"{low} {{{joined}}} {high}", joined, "", "p(X) : q(X)"]
        )
    )


@st.composite
def rule(draw: st.DrawFn) -> str:
    body = "; ".join(draw(st.lists(body_part(), max_size=3)))
    start = draw(head())
    return f"{start} :- {body}." if body or not start else f"{start}."


@st.composite
def program(draw: st.DrawFn) -> str:
    """Return a program of a few rules, with what it shows and projects on."""
    rules = draw(st.lists(rule(), min_size=1, max_size=9))
    extras = [
        "#show a/0. #show p/1.", "#show. #show t(X) : p(X). #show t(1) : a, not b.", "#show -a/0. #show q/1. #show u.",
        "#project p/1. #project b/0.", "#project p(X) : q(X).", "#external x. a :- x.", "#external y. [free] b :- y.",
        "#external b. [free]", "#external c. [true]",
        "r(1). r(X) :- r(Y), p(X), q(Y). p(1) :- r(2). q(2) :- q(1).", "#heuristic a : b. [1,true]",
        "#const n=2. q(n).",
        "d :- e. e :- d. e :- b, not c. d :- p(3).", "{d} :- e. {e} :- d. 1 {d; e} :- a.",
        "d :- 2 {e; b; p(1)}. e :- 3 <= #sum {2,1: d; 1,2: b; 2,3: c}.",
    ]  # fmt: skip
    return OPEN + " ".join([*rules, *draw(st.lists(st.sampled_from(extras), max_size=4, unique=True))])


@st.composite
def loops(draw: st.DrawFn) -> str:
    """Return a program whose derived atoms depend on each other in every way, under choices of other atoms."""
    derived = st.sampled_from([f"r({k})" for k in range(1, 7)])
    chosen = st.sampled_from([f"e({k})" for k in range(1, 8)])
    rules = []
    for _ in range(draw(st.integers(4, 14))):
        head, body = draw(derived), draw(st.lists(derived, max_size=2)) + draw(st.lists(chosen, max_size=2))
        kind = draw(st.integers(0, 9))
        if kind == 0:
            head = f"{{{head}}}"
        if kind == 1:
            head = ""
            body.append(f"not {draw(derived)}")
        if kind == 2 and body:
            elements = "; ".join(f"{draw(st.integers(1, 3))},{place}: {each}" for place, each in enumerate(body))
            rules.append(f"{head} :- {draw(st.integers(1, 4))} <= #sum {{{elements}}}.")
            continue
        rules.append(f"{head} :- {', '.join(body)}." if body else f"{head} :- e(1).")
    needed = draw(st.lists(derived, max_size=3))
    return "{e(1..7)}. " + " ".join([*rules, *(f":- not {each}." for each in needed)])


def answer_sets_by_clingo(text: str, *, project: bool, weighted: bool = False) -> Counter[tuple[str, ...]]:
    """Return what clingo prints of each answer set or projection, sorted, and how often; weights by its atoms."""
    control = clingo.Control(["0", "--project=auto" if project else "--project=no"], logger=lambda *_: None)
    control.add("base", [], text)
    control.ground([("base", [])])
    found: Counter[tuple[str, ...]] = Counter()

    def keep(model: clingo.Model) -> None:
        atoms = model.symbols(atoms=True)
        weight = prod((weight_of(atom) for atom in atoms), start=Fraction(1)) if weighted else 1
        found[tuple(map(str, sorted(model.symbols(shown=True))))] += weight  # type: ignore[assignment]

    control.solve(on_model=keep)
    return found


def count_in_process(text: str, **how: bool) -> int:
    """Return the number of answer sets by a diagram, or by clingo where there is none, without starting a counter."""
    try:
        return answer_sets(text=text, engine="diagram", **how).count()
    except QueryError as error:
        assert "choose the engine clingo" in str(error)
        return answer_sets(text=text, engine="clingo", **how).count()


def weight_of(atom: clingo.Symbol) -> Fraction:
    stated = {"p(1)": Fraction(2), "p(2)": Fraction(1, 3), "d": Fraction(1, 2), "e": Fraction(0), "-a": Fraction(3)}
    return stated.get(str(atom), Fraction(1))
