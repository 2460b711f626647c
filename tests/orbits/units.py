"""Random domains whose entities belong to each other: each cup has its own saucer, or each tray its own two cups."""

from __future__ import annotations

import itertools
import random
import re
from collections.abc import Iterator
from dataclasses import replace

from tests.brute_force import Action, Toy, Values
from tests.orbits.case import Case, Names
from tests.orbits.conditions import draw_clauses
from tests.orbits.domains import disturbed, draw_sensible, draw_values, put

STRUCTURES = (
    {"x1": "y1", "x2": "y2"},
    {"x1": "y2", "x2": "y1"},
    {"x1": "y2", "x2": "y3", "x3": "y1"},
    {"x1": "y1", "x2": "y1", "x3": "y2", "x4": "y2"},
    {"x1": "y2", "x2": "y1", "x3": "y2", "x4": "y1"},
)
"""To whom each entity of one class belongs."""

SCHEMES = {
    "a": ("X", ["p(X)", "s(Y)", "k(X,Y)", "g"]),
    "o": ("XY", ["p(X)", "s(Y)", "k(X,Y)", "g"]),
    "m": ("Y", ["s(Y)", "r(Y)", "g"]),
    "t": ("XZ", ["p(X)", "p(Z)", "g"]),
    "n": ("", ["g", "g"]),
}
"""Names of actions, what they name, and the fluents that they refer to: Y is whom X belongs to, Z is another X."""

INVARIANTS = [
    ("implies", "s(Y)", "p(X)"), ("implies", "p(X)", "s(Y)"), ("exclusive", "p(X)", "s(Y)"), ("implies", "p(X)", "g"),
    ("implies", "k(X,Y)", "p(X)"), ("implies", "k(X,Y)", "s(Y)"), ("exclusive", "p(X)", "p(Z)"),
    ("exclusive", "k(X,Y)", "r(Y)"), ("implies", "r(Y)", "s(Y)"), ("impossible", "p(X)", "r(Y)"),
    ("implies", "s(Y)", "r(Y)"),
]  # fmt: skip

ENDINGS = (
    ("", lambda own, state: True),
    (
        "served(Y) :- holds(s(Y),true,t). served(Y) :- laid(Y). laid(Y) :- served(Y), entity(Y,d). "
        ":- entity(Y,d), not laid(Y).",
        lambda own, state: all(state[f"s({y})"] for y in own.values()),
    ),
    (
        ":- OWN, holds(p(X),true,t), holds(s(Y),true,t).",
        lambda own, state: not any(state[f"p({x})"] and state[f"s({y})"] for x, y in own.items()),
    ),
)
"""Rules for the last state, and what they say."""


def ground(text: str, own: dict[str, str]) -> Iterator[Names]:
    """Yield the ways to put entities for the variables in a text."""
    variables = set(re.findall(r"\b[XYZ]\b", text))
    if variables == {"Y"}:
        yield from ({"Y": y} for y in sorted({*own.values()}))
        return
    for x, z in itertools.product(own, own):
        if x != z and ("Z" in variables or z == min({*own} - {x})):
            yield {"X": x, "Y": own[x], "Z": z}


def draw_units(chance: random.Random) -> Case:
    """Draw a small domain whose entities belong to each other, with little that tells them apart, or nothing."""
    return draw_sensible(lambda: _draw(chance))


def _draw(chance: random.Random) -> Case:
    own = chance.choice(STRUCTURES)
    entities = {**dict.fromkeys(own, "c"), **dict.fromkeys(sorted({*own.values()}), "d")}
    lifted = ["p(X)", "s(Y)", "g", *([chance.choice(["k(X,Y)", "r(Y)"])] if len(entities) < 6 else [])]
    fluents = tuple(dict.fromkeys(put(each, names) for each in lifted for names in ground(each, own)))
    place = {fluent: i for i, fluent in enumerate(fluents)}
    closed = chance.random() < 0.6
    names, actions = [], []
    for scheme in chance.sample(sorted(SCHEMES), chance.randint(1, 3)):
        variables, spoken = SCHEMES[scheme]
        lifted_name = f"{scheme}({','.join(variables)})" if variables else scheme
        before, after = (draw_values(chance, spoken, unknown=u) for u in (False, not closed))
        for each in {put(lifted_name, each): each for each in ground(lifted_name, own)}.values():
            names.append(put(lifted_name, each))
            sides = ({put(fluent, each): value for fluent, value in side.items()} for side in (before, after))
            actions.append(Action(scheme, *({place[f]: v for f, v in side.items() if f in place} for side in sides)))
    said = {"implies": [], "exclusive": [], "impossible": []}
    for predicate, one, other in chance.sample(INVARIANTS, chance.randint(0, 3)):
        for each in ground(f"{one} {other}", own):
            pair = (put(one, each), put(other, each))
            if all(fluent in place for fluent in pair) and chance.random() < 0.97:
                said[predicate].append((place[pair[0]], place[pair[1]]))
    initially: Values = dict.fromkeys(range(len(fluents)), False) if closed else {}
    for fluent, value in draw_values(chance, lifted).items():
        initially |= {place[put(fluent, each)]: bool(value) for each in ground(fluent, own)}
    toy = Toy(len(fluents), tuple(actions), initially, **{k: tuple(v) for k, v in said.items()})
    for _ in range(chance.choice([0, 0, 0, 1])):
        toy = disturbed(toy, chance)
    clauses = draw_clauses(chance, tuple(names), fluents, entities) if chance.random() < 0.4 else ()
    text, ending = chance.choice(ENDINGS) if closed and chance.random() < 0.5 else ENDINGS[0]
    text = " ".join(text.replace("OWN", f"X={x}, Y={y}") for x, y in (own.items() if "OWN" in text else [("", "")]))
    case = Case(toy, entities, fluents, tuple(names), clauses, text, lambda state: ending(own, state))
    return replace(case, order=chance.randrange(2**16)) if chance.random() < 0.5 else case
