"""Random domains that are written with variables, over a class of as many things as one likes."""

from __future__ import annotations

import random
from collections.abc import Sequence
from dataclasses import dataclass

FLUENTS = {"p": "X", "q": "X", "r": "XZ", "s": "YX", "g": ""}
"""Fluents and what they refer to: X, Z and W are things, Y is a box."""

ACTIONS = {"a": "X", "b": "XZ", "c": "YX", "d": ""}
BOUND = {"X": "is_a(X,thing)", "Z": "is_a(Z,thing)", "W": "is_a(W,thing)", "Y": "is_a(Y,box)"}
MORE = ("", "", "", "", "mark({0})", "not mark({0})", "plain({0})", "not lonely", "{0} != x1")
"""What else may be asked of a variable; only the last tells of one thing by its name."""

TRAPS = (
    "goal(p(X),true) :- is_a(X,thing).",
    "goal(p(X),false) :- is_a(X,thing), mark(X).",
    "many :- #count {{ X : is_a(X,thing) }} >= {things}. precondition(a(X),p(X),true) :- action(a(X)), many.",
    "every :- mark(X) : is_a(X,thing). precondition(d,g,true) :- action(d), every.",
    "precondition(a(X),p(Z),true) :- action(a(X)), is_a(Z,thing), X < Z.",
    "initially(p(X),true) :- is_a(X,thing), not mark(X).",
    "heavy(x2). precondition(a(X),q(X),false) :- action(a(X)), heavy(X).",
    "near(x1,x2). near(x2,x3). implies(p(X),q(Z)) :- near(X,Z).",
    "#program step(t). :- #count {{ X : holds(p(X),true,t) }} > 1. #program base.",
    "#program check(t). :- holds(p(X),true,t) : is_a(X,thing). #program base.",
    "linked(X,Z) :- is_a(X,thing), is_a(Z,thing), X != Z. linked(X,W) :- linked(X,Z), linked(Z,W). "
    "precondition(a(X),q(X),true) :- action(a(X)), linked(X,X).",
    "exclusive(p(X),p(Z)) :- is_a(X,thing), is_a(Z,thing), X < Z.",
    "exclusive(F,G) :- rests(F,X), rests(G,X), F < G. rests(p(X),X) :- is_a(X,thing). rests(q(X),X) :- is_a(X,thing).",
    "implies(p(X),p(Z)) :- is_a(X,thing), is_a(Z,thing), X < Z.",
    "lead(X) :- is_a(X,thing), not late(X). late(Z) :- is_a(X,thing), is_a(Z,thing), X < Z. "
    "goal(p(X),true) :- lead(X).",
    "class(toy, thing). entity(t1, toy). entity(t2, toy).",
    "action(X) :- is_a(X,thing). precondition(X,p(X),true) :- is_a(X,thing).",
    "impossible(q(X),p(Z)) :- is_a(X,thing), is_a(Z,thing), X != Z.",
    "#const first = x1. precondition(a(first),q(first),true) :- action(a(first)).",
)
"""What may see things that no plan names, or only seems to."""


@dataclass(frozen=True)
class Lifted:
    """A domain that leaves open how many things there are; some of the first ones are marked."""

    rules: str
    marked: int

    def text(self, things: int) -> str:
        """Return the domain with so many things."""
        names = [f"x{number}" for number in range(1, things + 1)]
        marks = "".join(f" mark({name})." for name in names[: self.marked])
        return f"entity(({'; '.join(names)}), thing).{marks}\n{self.rules.replace('THINGS', str(things))}"


def draw_lifted(chance: random.Random) -> Lifted:
    """Draw a domain."""
    rules = [
        "class(thing). class(box). entity((y1; y2), box). mark(nobody).",
        "plain(X) :- is_a(X,thing), not mark(X). lonely :- plain(X), mark(X).",
        "fluent(p(X)) :- is_a(X,thing). fluent(q(X)) :- is_a(X,thing). fluent(g).",
    ]
    fluents = ["p", "q", "g", chance.choice("rs")]
    rules.append(f"fluent({_term(fluents[3], FLUENTS[fluents[3]])}){_body(FLUENTS[fluents[3]])}.")
    for name in chance.sample(sorted(ACTIONS), chance.randint(1, 2)):
        term, variables = _term(name, ACTIONS[name]), ACTIONS[name]
        rules.append(f"action({term}){_body(variables, chance)}.")
        for kind, values, most in (("precondition", "tf", 2), ("postcondition", "ttffu", 3)):
            for _ in range(chance.randint(0, most)):
                fluent, own = _fluent(variables, fluents, chance)
                value = {"t": "true", "f": "false", "u": "unknown"}[chance.choice(values)]
                body = _body([*variables, *own], chance, f"action({term})", f"fluent({fluent})")
                rules.append(f"{kind}({term},{fluent},{value}){body}.")
    for _ in range(chance.randint(0, 3)):
        (first, own), (second, others) = _fluent("X", fluents, chance), _fluent("XZ", fluents, chance)
        body = _body([*own, *others], chance, f"fluent({first})", f"fluent({second})")
        rules.append(f"{chance.choice(['exclusive', 'implies', 'implies', 'impossible'])}({first},{second}){body}.")
    for kind in [*["initially"] * chance.randint(0, 2), *["goal"] * (chance.random() < 0.2)]:
        fluent, own = _fluent("X", fluents, chance)
        rules.append(f"{kind}({fluent},{chance.choice(['true', 'false'])}){_body(own, chance, f'fluent({fluent})')}.")
    if chance.random() < 0.3:
        rules.append("initially(F,false) :- fluent(F), not initially(F,true).")
    if chance.random() < 0.4:
        rules.append(chance.choice(TRAPS).format(things="THINGS"))
    return Lifted("\n".join(rules), chance.choice([0, 0, 1, 2]))


def _term(name: str, variables: Sequence[str]) -> str:
    return f"{name}({','.join(variables)})" if variables else name


def _body(variables: Sequence[str], chance: random.Random | None = None, *atoms: str) -> str:
    """Return what binds variables, all different where they are of one class, and what else is asked of them."""
    found = [*atoms, *(BOUND[each] for each in dict.fromkeys(variables))]
    found += [f"{x} != {z}" for x, z in (("X", "Z"), ("X", "W"), ("Z", "W")) if x in variables and z in variables]
    things = [each for each in variables if each != "Y"]
    more = chance.choice(MORE).format(chance.choice(things)) if chance and things else ""
    found += [more] if more else []
    return f" :- {', '.join(found)}" if found else ""


def _fluent(bound: Sequence[str], fluents: Sequence[str], chance: random.Random) -> tuple[str, list[str]]:
    """Return a fluent over variables that are bound, or over one more, and all its variables."""
    name, own = chance.choice(fluents), list[str]()
    for kind in FLUENTS[name]:
        things = [each for each in [*bound, "W"] if each != "Y" and each not in own]
        own.append("Y" if kind == "Y" else chance.choice(things or ["X"]))
    return _term(name, own), own
