"""Random conditions for hypothesis: their words, and what they mean for one run of a plan, in plain Python.

A run is a plan with the complete states that it passes. A condition of the library holds for a plan if one run
satisfies all of its clauses.
"""

from __future__ import annotations

import itertools
import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass

from hypothesis import strategies as st

from tests.brute_force import State, Toy, agrees, term

Plan = tuple[int, ...]
Test = Callable[[Toy, Plan, tuple[State, ...]], bool]


@dataclass(frozen=True)
class Clause:
    words: str
    holds: Test


def entities(toy: Toy) -> str:
    """Make the number in each action an entity of a class of its own, which is below `even` or `odd`."""
    numbers = range(len(toy.actions))
    lines = ["class(even). class(odd)."]
    lines += [f"class(kind_{i}, {('even', 'odd')[i % 2]}). class(kind_{i}). entity({i}, kind_{i})." for i in numbers]
    return "\n".join(lines) + "\n"


def runs(toy: Toy, plan: Plan) -> Iterator[tuple[State, ...]]:
    """Yield the states of every run that executes a plan, whether its end reaches the goal or not."""

    def extend(states: tuple[State, ...]) -> Iterator[tuple[State, ...]]:
        done = len(states) - 1
        if done == len(plan):
            yield states
            return
        for after in toy.after(frozenset(states[-1:]), plan[:done], plan[done]):
            yield from extend((*states, after))

    for state in toy.start():
        yield from extend((state,))


def satisfied(toy: Toy, plan: Plan, clauses: list[Clause]) -> bool:
    """Return whether some run of a plan reaches the goal and satisfies all clauses."""
    return any(
        agrees(states[-1], toy.goal) and all(clause.holds(toy, plan, states) for clause in clauses)
        for states in runs(toy, plan)
    )


@st.composite
def clauses(draw: st.DrawFn, toy: Toy) -> Clause:
    kinds = [begins, has, uses, some_use, matches, part_of_run, ends, achieves]
    clause: Clause = draw(draw(st.sampled_from(kinds))(toy))
    return clause


def names(toy: Toy) -> list[str]:
    return sorted({action.name for action in toy.actions})


@st.composite
def begins(draw: st.DrawFn, toy: Toy) -> Clause:
    items = draw(
        st.lists(st.sampled_from(names(toy) + [term(toy, i) for i in range(len(toy.actions))]), min_size=1, max_size=3)
    )

    def holds(toy: Toy, plan: Plan, states: tuple[State, ...]) -> bool:
        fits = (item in (term(toy, i), toy.actions[i].name) for item, i in zip(items, plan, strict=False))
        return len(plan) >= len(items) and all(fits)

    return Clause(f"begins {', '.join(items)}", holds)


@st.composite
def quantity(draw: st.DrawFn) -> tuple[str, Callable[[int], bool]]:
    k = draw(st.integers(0, 3))
    kinds: list[tuple[str, Callable[[int], bool]]] = [
        (f"at least {k} ", lambda n: n >= k),
        (f"at most {k} ", lambda n: n <= k),
        (f"exactly {k} ", lambda n: n == k),
    ]
    return draw(st.sampled_from(kinds))


@st.composite
def has(draw: st.DrawFn, toy: Toy) -> Clause:
    words, test = draw(st.one_of(quantity(), st.just(("", lambda n: n >= 1)), st.just(("lacks", lambda n: n == 0))))
    one = st.sampled_from(names(toy))
    what = draw(
        st.one_of(
            one, st.sampled_from([term(toy, i) for i in range(len(toy.actions))]), one.map(lambda name: f"{name}(_)"),
            st.tuples(one, one).map(lambda pair: f"{pair[0]} > {pair[1]}"),
        )
    )  # fmt: skip

    def holds(toy: Toy, plan: Plan, states: tuple[State, ...]) -> bool:
        called = [toy.actions[i].name for i in plan]
        if ">" in what:
            number = sum(f"{a} > {b}" == what for a, b in itertools.pairwise(called))
        else:
            number = sum(what in (name, f"{name}(_)", term(toy, i)) for name, i in zip(called, plan, strict=True))
        return test(number)

    return Clause(f"lacks {what}" if words == "lacks" else f"has {words}{what}", holds)


def members(toy: Toy, kind: str) -> set[int]:
    return {i for i in range(len(toy.actions)) if kind in (str(i), f"kind_{i}", ("even", "odd")[i % 2])}


def kinds_of(toy: Toy) -> st.SearchStrategy[str]:
    numbers = range(len(toy.actions))
    return st.sampled_from(
        ["even", *(["odd"] if len(numbers) > 1 else []), *map(str, numbers), *(f"kind_{i}" for i in numbers)]
    )


@st.composite
def uses(draw: st.DrawFn, toy: Toy) -> Clause:
    kind = draw(kinds_of(toy))
    words, test = draw(quantity())
    return Clause(f"uses {words}{kind}", lambda toy, plan, states: test(len(members(toy, kind) & set(plan))))


@st.composite
def some_use(draw: st.DrawFn, toy: Toy) -> Clause:
    kind = draw(kinds_of(toy))
    if draw(st.booleans()):
        return Clause(f"uses {kind}", lambda toy, plan, states: bool(members(toy, kind) & set(plan)))
    return Clause(f"avoids {kind}", lambda toy, plan, states: not members(toy, kind) & set(plan))


@st.composite
def matches(draw: st.DrawFn, toy: Toy) -> Clause:
    """Names of one letter make the expression one of Python's own."""
    leaf = st.sampled_from([*names(toy), "."])
    repeats = st.sampled_from(["*", "+", "?", "{2}", "{1,2}", "{1,}"])
    inner = st.recursive(
        leaf,
        lambda part: st.one_of(
            st.tuples(part, part).map(lambda both: f"({both[0]} {both[1]})"),
            st.tuples(part, part).map(lambda both: f"({both[0]}|{both[1]})"),
            st.tuples(part, repeats).map(lambda both: f"({both[0]}){both[1]}"),
        ),
        max_leaves=5,
    )  # fmt: skip
    expression = draw(inner)
    inverse = draw(st.booleans())
    pattern = re.compile(expression.replace(" ", ""))

    def holds(toy: Toy, plan: Plan, states: tuple[State, ...]) -> bool:
        return bool(pattern.fullmatch("".join(toy.actions[i].name for i in plan))) != inverse

    return Clause(f"{'not ' * inverse}matches {expression}", holds)


@st.composite
def part_of_run(draw: st.DrawFn, toy: Toy) -> Clause:
    values = draw(st.dictionaries(st.integers(0, toy.fluents - 1), st.booleans(), min_size=1, max_size=2))
    step = draw(st.integers(0, 3))
    formula = ", ".join(f"{'' if value else 'not '}f{f}" for f, value in values.items())

    def holds(toy: Toy, plan: Plan, states: tuple[State, ...]) -> bool:
        return len(states) > step and agrees(states[step], dict(values))

    start = step == 0 and draw(st.booleans())
    return Clause(f"starts {formula}" if start else f"after {step}: {formula}", holds)


Formula = tuple[str, Callable[[State], bool]]


def both(pair: tuple[Formula, Formula]) -> Formula:
    (first, one), (second, other) = pair
    return f"({first} and {second})", lambda state: one(state) and other(state)


def either(pair: tuple[Formula, Formula]) -> Formula:
    (first, one), (second, other) = pair
    return f"({first} or {second})", lambda state: one(state) or other(state)


@st.composite
def ends(draw: st.DrawFn, toy: Toy) -> Clause:
    words, test = draw(formulas(toy))
    return Clause(f"ends {words}", lambda toy, plan, states: test(states[-1]))


@st.composite
def achieves(draw: st.DrawFn, toy: Toy) -> Clause:
    words, test = draw(formulas(toy))
    return Clause(f"achieves {words}", lambda toy, plan, states: test(states[-1]) and not test(states[0]))


def formulas(toy: Toy) -> st.SearchStrategy[Formula]:
    number = st.integers(0, toy.fluents - 1)
    leaf: st.SearchStrategy[Formula] = number.map(lambda f: (f"f{f}", lambda state: state[f]))
    return st.recursive(
        leaf,
        lambda part: st.one_of(
            part.map(lambda p: (f"not ({p[0]})", lambda state: not p[1](state))),
            st.tuples(part, part).map(both),
            st.tuples(part, part).map(either),
        ),
        max_leaves=5,
    )
