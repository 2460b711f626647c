"""Random domains for hypothesis."""

from __future__ import annotations

from dataclasses import replace

from hypothesis import strategies as st

from tests.brute_force import Action, Toy

MAX_FLUENTS = 5


@st.composite
def toys(draw: st.DrawFn, *, closed: bool) -> Toy:
    """Draw a ground domain, open or closed, with invariants, unknown effects, goals and rules across time."""
    fluents = draw(st.integers(1, MAX_FLUENTS))
    fluent = st.integers(0, fluents - 1)
    pair = st.tuples(fluent, fluent)
    known = st.dictionaries(fluent, st.booleans(), max_size=3)
    effects = st.dictionaries(fluent, st.sampled_from([True, False, True, False, None]), max_size=3)
    actions = draw(
        st.lists(st.builds(Action, st.sampled_from(["a", "b", "c"]), known, effects), min_size=1, max_size=4)
    )
    if closed:
        actions = [Action(a.name, a.before, {f: v for f, v in a.after.items() if v is not None}) for a in actions]
    number = st.integers(0, len(actions) - 1)
    initially = {f: draw(st.booleans()) for f in range(fluents)} if closed else draw(known)
    return Toy(
        fluents,
        tuple(actions),
        initially,
        tuple(draw(st.lists(pair, max_size=3))),
        tuple(draw(st.lists(pair, max_size=3))),
        draw(st.one_of(st.just({}), known)),
        tuple(draw(st.lists(st.tuples(number, number), max_size=2))),
        draw(st.dictionaries(st.sampled_from(["a", "b"]), st.integers(0, 2), max_size=1)),
        tuple(draw(st.lists(st.tuples(number, fluent, fluent), max_size=2))) if closed else (),
        impossible=tuple(draw(st.lists(pair, max_size=2))),
    )


@st.composite
def hierarchies(draw: st.DrawFn, *, closed: bool) -> Toy:
    """Draw a ground domain with composites, some of them parts of others, and free actions."""
    toy = draw(toys(closed=closed))
    actions = len(toy.actions)
    composites: list[tuple[int, ...]] = []
    for _ in range(draw(st.integers(1, 4))):
        part = st.integers(0, actions + len(composites) - 1)
        composites.append(tuple(draw(st.lists(part, min_size=1, max_size=3))))
    free = draw(st.lists(st.integers(0, actions - 1), max_size=2, unique=True))
    return replace(toy, composites=tuple(composites), free=tuple(free))


RELATIONS = ("p(A)", "q(A)", "r(A,B)", "s(A,D)", "g")
SCHEMAS = {"one(A)": ("p(A)", "q(A)", "g"), "two(A,B)": ("p(A)", "q(B)", "r(A,B)", "r(B,A)", "g"),
           "at(A,D)": ("p(A)", "s(A,D)", "g")}  # fmt: skip
VARIABLES = {"A": "thing(A)", "B": "thing(B), A != B", "D": "place(D)"}
STEP_RULES = (
    ":- occurs(A,t-1), occurs(A,t).",
    "busy(E,t) :- occurs(A,t), mentions(A,1,E). :- busy(E,t-1), occurs(A,t), mentions(A,1,E).",
    "used(1,t) :- occurs(A,t), name(A,two). used(1,t) :- used(1,t-1). :- used(1,t-1), occurs(A,t), name(A,two).",
)


@st.composite
def symmetric_texts(draw: st.DrawFn) -> str:
    """Draw the text of a domain over 3 to 5 things of one class and 1 to 3 places, told apart by little or nothing."""
    things, places = draw(st.integers(3, 5)), draw(st.integers(1, 3))
    lines = ["class(c). class(d).", f"entity(x(1..{things}),c). entity(y(1..{places}),d)."]
    lines += ["thing(X) :- entity(X,c). place(Y) :- entity(Y,d)."]
    lines += [f"fluent({each}){_where(each)}." for each in RELATIONS]
    for action in draw(st.lists(st.sampled_from(sorted(SCHEMAS)), min_size=1, max_size=3, unique=True)):
        lines.append(f"action({action}){_where(action)}.")
        fluent = st.sampled_from(SCHEMAS[action])
        for kind, values in (("precondition", ("true", "false")), ("postcondition", ("true", "false", "true"))):
            chosen = draw(
                st.dictionaries(fluent, st.sampled_from(values), min_size=kind == "postcondition", max_size=3)
            )
            lines += [f"{kind}({action},{each},{value}){_where(action)}." for each, value in chosen.items()]
    lines += draw(st.lists(st.sampled_from(["initially(p(X),true) :- thing(X).", "goal(g,true).",
                                            "exclusive(s(X,Y),s(X,Z)) :- thing(X), place(Y), place(Z), Y < Z.",
                                            "exclusive(r(X,Z),r(Y,Z)) :- thing(X), thing(Y), thing(Z), X < Y.",
                                            "initially(q(x(1)),true).", "goal(p(x(2)),true)."]),
                           max_size=2, unique=True))  # fmt: skip
    if draw(st.booleans()):
        lines.append("initially(F,false) :- fluent(F), not initially(F,true).")
    lines += ["#program step(t).", *draw(st.lists(st.sampled_from(STEP_RULES), max_size=1))]
    return "\n".join(lines) + "\n"


def _where(atom: str) -> str:
    bound = [condition for variable, condition in VARIABLES.items() if variable in atom.partition("(")[2]]
    return f" :- {', '.join(bound)}" if bound else ""
