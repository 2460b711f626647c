"""Random domains that tell entities apart by little, by nothing, or only in their words."""

from __future__ import annotations

import itertools
import random
import re
from collections.abc import Callable, Iterable, Iterator
from dataclasses import replace

from tests.brute_force import Action, Toy, Values
from tests.orbits.case import Case, Names
from tests.orbits.conditions import Kind, draw_clauses

CLASSES = {"x": "c", "y": "d"}
SCHEMES = {"a": "X", "b": "X", "t": "XZ", "u": "XY", "n": ""}
"""Names of actions, and what they name: X and Z are two entities of one class, Y one of another."""

SPOKEN = {"": ["g"], "X": ["p(X)", "q(X)", "r(X)", "g"], "XZ": ["p(X)", "p(Z)", "q(Z)", "l(X,Z)"],
          "XY": ["p(X)", "s(Y)", "g"]}  # fmt: skip
"""The fluents that actions refer to."""


def ground(text: str, entities: dict[str, str]) -> Iterator[Names]:
    """Yield the ways to put entities for the variables in a text."""
    variables = sorted(set(re.findall(r"\b[XYZ]\b", text)))
    choices = [[e for e in entities if e[0] == ("y" if v == "Y" else "x")] for v in variables]
    for chosen in itertools.product(*choices):
        names = dict(zip(variables, chosen, strict=True))
        if names.get("X") != names.get("Z") or "Z" not in names:
            yield names


def put(text: str, names: Names) -> str:
    return re.sub(r"\b[XYZ]\b", lambda found: names[found[0]], text)


INVARIANTS = [
    ("implies", "p(X)", "q(X)"), ("implies", "q(X)", "p(X)"), ("implies", "q(X)", "r(X)"), ("implies", "r(X)", "p(X)"),
    ("implies", "p(X)", "r(X)"), ("implies", "p(X)", "g"), ("implies", "g", "p(X)"), ("implies", "s(Y)", "p(X)"),
    ("exclusive", "p(X)", "p(Z)"), ("exclusive", "p(X)", "r(X)"), ("exclusive", "q(X)", "s(Y)"),
    ("exclusive", "p(X)", "q(Z)"), ("implies", "p(X)", "p(Z)"), ("implies", "l(X,Z)", "l(Z,X)"),
    ("exclusive", "l(X,Z)", "l(Z,X)"), ("implies", "l(X,Z)", "p(X)"), ("exclusive", "r(X)", "r(X)"),
    ("impossible", "q(X)", "g"), ("impossible", "r(X)", "r(Z)"),
]  # fmt: skip

ENDINGS = (
    ("", lambda entities, state: True),
    (
        "linked(X) :- holds(p(X),true,t). linked(Z) :- linked(X), holds(l(X,Z),true,t). :- entity(X,c), not linked(X).",
        lambda entities, state: linked(entities, state) == things(entities),
    ),
    (
        "on(X) :- holds(q(X),true,t). on(X) :- off(X). off(X) :- on(X), entity(X,c). "
        "off(X) :- on(X), holds(g,true,t). :- off(X) : entity(X,c).",
        lambda entities, state: not all(state[f"q({x})"] for x in things(entities)),
    ),
    (
        "chain(X,Z) :- holds(l(X,Z),true,t). chain(X,W) :- chain(X,Z), chain(Z,W). :- chain(X,X).",
        lambda entities, state: not any(x in reached(entities, state, x) for x in things(entities)),
    ),
)
"""Rules for the last state that go around, and what they say."""


def things(entities: Iterable[str]) -> set[str]:
    return {e for e in entities if e[0] == "x"}


def reached(entities: Iterable[str], state: dict[str, bool], start: str) -> set[str]:
    found: set[str] = set()
    waiting = [start]
    while waiting:
        one = waiting.pop()
        new = {z for z in things(entities) if state.get(f"l({one},{z})")} - found
        found |= new
        waiting += new
    return found


def linked(entities: Iterable[str], state: dict[str, bool]) -> set[str]:
    first = {x for x in things(entities) if state[f"p({x})"]}
    return first.union(*(reached(entities, state, x) for x in first))


def draw_sensible(draw: Callable[[], Case]) -> Case:
    """Draw cases until each action of one can occur."""
    return next(case for case in iter(draw, None) if case.sensible)


def draw_case(chance: random.Random) -> Case:
    """Draw a small domain that tells entities apart by little, by nothing, or only in its words."""
    return draw_sensible(lambda: draw_any(chance))


def draw_redundant(chance: random.Random) -> Case:
    """Draw a domain that says again, in other words and of single entities, much of what its invariants entail."""

    def draw() -> Case:
        case = draw_sensible(
            lambda: draw_any(chance, invariants=chance.randint(2, 5), disturbances=chance.choice([0, 0, 0, 1]))
        )
        toy = with_chains(case.toy, chance) if chance.random() < 0.5 else case.toy
        for _ in range(chance.randint(1, 4)):
            toy = said_again(toy, chance)
        return replace(case, toy=toy, order=chance.randrange(2**16))

    return draw_sensible(draw)


def draw_closed(chance: random.Random, kind: Kind) -> Case:
    """Draw a small domain whose initial state is given whole, under a condition of a kind and perhaps others."""
    return draw_sensible(lambda: draw_any(chance, closed=True, kind=kind))


def draw_any(
    chance: random.Random,
    invariants: int | None = None,
    disturbances: int | None = None,
    *,
    closed: bool | None = None,
    kind: Kind | None = None,
) -> Case:
    numbers = chance.choice([(2, 0), (2, 1), (3, 0), (2, 2), (3, 1)])
    names_of = zip(CLASSES, numbers, strict=True)
    entities = {f"{letter}{i}": CLASSES[letter] for letter, n in names_of for i in range(1, n + 1)}
    relation = numbers[0] == 2 and chance.random() < 0.5
    lifted = ["p(X)", "q(X)", "g", "s(Y)", *(["l(X,Z)"] if relation else ["r(X)"] if numbers[0] == 2 else [])]
    fluents = tuple(dict.fromkeys(put(each, names) for each in lifted for names in ground(each, entities)))
    place = {fluent: i for i, fluent in enumerate(fluents)}
    closed = chance.random() < 0.4 if closed is None else closed
    names, actions = [], []
    schemes = [scheme for scheme in sorted(SCHEMES) if "Y" not in SCHEMES[scheme] or numbers[1]]
    for scheme in chance.sample(schemes, chance.randint(1, 3)):
        lifted_name = f"{scheme}({','.join(SCHEMES[scheme])})" if SCHEMES[scheme] else scheme
        before, after = (draw_values(chance, SPOKEN[SCHEMES[scheme]], unknown=u) for u in (False, not closed))
        for each in ground(lifted_name, entities):
            names.append(put(lifted_name, each))
            sides = ({put(fluent, each): value for fluent, value in side.items()} for side in (before, after))
            actions.append(Action(scheme, *({place[f]: v for f, v in side.items() if f in place} for side in sides)))
    said = {"implies": [], "exclusive": [], "impossible": []}
    for predicate, one, other in chance.sample(INVARIANTS, chance.randint(0, 4) if invariants is None else invariants):
        for each in ground(f"{one} {other}", entities):
            pair = (put(one, each), put(other, each))
            if all(fluent in place for fluent in pair):
                said[predicate].append((place[pair[0]], place[pair[1]]))
    initially: Values = dict.fromkeys(range(len(fluents)), False) if closed else {}
    for lifted_fluent, value in draw_values(chance, lifted).items():
        initially |= {place[put(lifted_fluent, each)]: bool(value) for each in ground(lifted_fluent, entities)}
    goal: Values = {}
    if chance.random() < 0.3:
        goal = {place[put("p(X)", each)]: True for each in ground("p(X)", entities)}
    toy = Toy(len(fluents), tuple(actions), initially, goal=goal, **{k: tuple(v) for k, v in said.items()})
    ending_text, ending = chance.choice(ENDINGS) if closed and chance.random() < 0.6 else ENDINGS[0]
    if "l(X,Z)" in ending_text and not relation:
        ending_text, ending = ENDINGS[2]
    for _ in range(chance.choice([0, 0, 1, 1, 2]) if disturbances is None else disturbances):
        toy = disturbed(toy, chance)
    clauses = draw_clauses(chance, tuple(names), fluents, entities, kind)
    return Case(toy, entities, fluents, tuple(names), clauses, ending_text, lambda state: ending(entities, state))


def draw_values(chance: random.Random, fluents: list[str], *, unknown: bool = False) -> dict[str, bool | None]:
    chosen = chance.sample(fluents, chance.randint(0, min(2, len(fluents))))
    return {fluent: chance.choice([True, True, False, None] if unknown else [True, True, False]) for fluent in chosen}


DISTURBANCES = ("entailed", "entailed", "self", "invariant", "initially", "goal", "never_after", "before", "after")


def disturbed(toy: Toy, chance: random.Random) -> Toy:
    """Return a domain that says something more of single fluents, often nothing new."""
    kind = chance.choice(DISTURBANCES)
    i, j = (chance.randrange(toy.fluents) for _ in range(2))
    number = chance.randrange(len(toy.actions))
    if kind == "entailed":
        implied = entailed(replace(toy, impossible=()))
        kind, i, j = chance.choice(implied or [("self", i, i)])
        if implied:
            return replace(toy, **{kind: (*getattr(toy, kind), (i, j))})
    if kind == "self":
        return replace(toy, implies=(*toy.implies, (i, i)))
    if kind == "invariant":
        kind = chance.choice(["implies", "exclusive"])
        return replace(toy, **{kind: (*getattr(toy, kind), (i, j))})
    if kind in ("initially", "goal"):
        return replace(toy, **{kind: {**getattr(toy, kind), i: chance.random() < 0.6}})
    if kind == "never_after":
        return replace(toy, never_after=(*toy.never_after, (number, chance.randrange(len(toy.actions)))))
    action = toy.actions[number]
    values = {**getattr(action, kind), i: chance.random() < 0.5}
    changed = replace(action, **{kind: values})
    return replace(toy, actions=(*toy.actions[:number], changed, *toy.actions[number + 1 :]))


def entailed(toy: Toy, *, alone: bool = False) -> list[tuple[str, int, int]]:
    """Return the invariants of two fluents, or of a fluent alone as well, that all states satisfy which are allowed."""
    states = [state for state in itertools.product((False, True), repeat=toy.fluents) if toy.allowed(state)]
    pairs = [(a, b) for a in range(toy.fluents) for b in range(toy.fluents) if a != b or alone]
    implied = [("implies", a, b) for a, b in pairs if all(s[b] for s in states if s[a])]
    return implied + [("exclusive", a, b) for a, b in pairs if not any(s[a] and s[b] for s in states)]


def said_again(toy: Toy, chance: random.Random) -> Toy:
    """Return a domain with more that its invariants entail: of states, of the goal, or of what an action needs."""
    known = entailed(replace(toy, impossible=()))
    kind = chance.choice(["invariant", "invariant", "invariant", "impossible", "self", "goal", "before"])
    if kind == "invariant" and known:
        kind, i, j = chance.choice(known)
        return replace(toy, **{kind: (*getattr(toy, kind), (i, j))})
    if kind == "impossible":
        pairs = [(i, j) for predicate, i, j in entailed(toy, alone=True) if predicate == "exclusive"]
        return replace(toy, impossible=(*toy.impossible, chance.choice(pairs))) if pairs else toy
    if kind == "goal":
        return replace(toy, goal=with_entailed(toy.goal, known, chance))
    number = chance.randrange(len(toy.actions))
    if kind == "before":
        action = toy.actions[number]
        changed = replace(action, before=with_entailed(action.before, known, chance))
        return replace(toy, actions=(*toy.actions[:number], changed, *toy.actions[number + 1 :]))
    i = chance.randrange(toy.fluents)
    return replace(toy, implies=(*toy.implies, (i, i)))


def with_entailed(values: Values, known: Iterable[tuple[str, int, int]], chance: random.Random) -> Values:
    """Return values of some fluents with one more that follows from them."""
    more = [(j, kind == "implies") for kind, i, j in known if values.get(i) is True]
    more += [(i, False) for kind, i, j in known if kind == "implies" and values.get(j) is False]
    return {**dict([chance.choice(more)]), **values} if more else values


def with_chains(toy: Toy, chance: random.Random) -> Toy:
    """Return a domain whose implications are joined by some of their shortcuts, and exclusions turned around."""
    shortcuts = [(a, d) for a, b in toy.implies for c, d in toy.implies if b == c]
    further = [pair for a, b in toy.implies for c, d in toy.exclusive for pair in ((a, d), (d, a)) if b == c]
    turned = [(b, a) for a, b in toy.exclusive]
    return replace(
        toy,
        implies=(*toy.implies, *(each for each in shortcuts if chance.random() < 0.3)),
        exclusive=(*(each for each in (*toy.exclusive, *turned, *further) if chance.random() < 0.7), *toy.exclusive),
    )
