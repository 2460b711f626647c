"""How the variables of a state are gathered into digits, and these put in order: it decides how small diagrams are.

Variables of which no two are ever true together (the places where a thing may be) make one digit of few values. Which
those are is guessed from random walks. A wrong guess costs time and no more, for a digit takes any values.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property
from weakref import WeakKeyDictionary

import clingo
import numpy as np
from numpy.typing import NDArray

from prag_asp.logic.step.packed import Rows, unpack
from prag_asp.logic.step.transition import Transition
from prag_asp.program.predicates import HOLDS

WALKERS, STEPS = 256, 24
"""Random walks, and their length."""

EXPECTED = 5.0
"""How often two variables should have been seen true together, were they independent, to hold that they exclude."""

MOST_DIGITS = 200
"""Digits of a state at most: recursion goes so deep. Where there are more, neighbours become one."""

ROUNDS = 30
"""Rounds in which digits are put nearer to those that actions join them with."""


@dataclass(frozen=True)
class Digits:
    """The places of the variables that each digit is made of, as bits from the lowest on, in order of the levels."""

    places: tuple[tuple[int, ...], ...]

    @cached_property
    def at(self) -> dict[int, tuple[int, int]]:
        """The level of each variable and its bit there, as a mask."""
        return {
            place: (level, 1 << bit) for level, places in enumerate(self.places) for bit, place in enumerate(places)
        }

    def word(self, row: Rows, variables: int) -> tuple[int, ...]:
        """Return the digits of a packed state, shape (1, words)."""
        true = unpack(row, variables)[:, 0].tolist()
        return tuple(sum(1 << bit for bit, place in enumerate(places) if true[place]) for places in self.places)


_known: WeakKeyDictionary[Transition, Digits] = WeakKeyDictionary()


def find_digits(transition: Transition, look: Callable[[], None]) -> Digits:
    """Return digits for the states of a step function that has an initial state; `look` is called now and then."""
    known = _known.get(transition)
    if known is None:
        known = _known[transition] = _found(transition, look)
    return known


def _found(transition: Transition, look: Callable[[], None]) -> Digits:
    items = _items(transition.variables)
    walked = unpack(_walked(transition, look), len(transition.variables))
    excluded = _never_together(walked[np.array([item[0] for item in items], dtype=np.intp)].astype(np.float64))
    groups: list[list[int]] = []
    for number in range(len(items)):
        look()
        home = next((group for group in groups if all(excluded[number, other] for other in group)), None)
        if home is None:
            groups.append([number])
        else:
            home.append(number)
    found = [tuple(place for number in group for place in items[number]) for group in groups]
    found = _in_order(found or [()], transition, look)
    while len(found) > MOST_DIGITS:
        found = [sum(found[place : place + 2], ()) for place in range(0, len(found), 2)]
    return Digits(tuple(found))


def _items(variables: Sequence[clingo.Symbol]) -> list[list[int]]:
    """Return the places of variables: of each fluent what makes it true, then what makes it false, else one by one."""
    found: dict[object, list[int]] = {}
    for place, symbol in reversed(list(enumerate(variables))):
        fluent = symbol.arguments[0] if symbol.match(*HOLDS.without_time) else symbol
        found.setdefault(("holds", fluent) if fluent is not symbol else symbol, []).append(place)
    return list(reversed(found.values()))


def _walked(transition: Transition, look: Callable[[], None]) -> Rows:
    """Return the states that random walks from the start pass, the same ones each time."""
    generator = np.random.default_rng(0)
    rows = np.repeat(transition.initial, WALKERS, axis=0)
    passed = [rows[:1]]
    for _ in range(STEPS):
        look()
        found = [each for each in transition.expand(rows) if len(each.sources)]
        if not found:
            break
        sources = np.concatenate([each.sources for each in found])
        states = np.concatenate([each.states for each in found])
        shuffled = generator.permutation(len(sources))
        walkers, chosen = np.unique(sources[shuffled], return_index=True)
        rows = states[shuffled[chosen]][np.resize(np.arange(len(walkers)), WALKERS)]
        passed.append(rows)
    return np.concatenate(passed)


def _never_together(true: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Return which items were never seen true together, though often enough each by itself; shape (items, items)."""
    often = true.sum(axis=1)
    never: NDArray[np.bool_] = (true @ true.T == 0) & (np.outer(often, often) >= EXPECTED * true.shape[1])
    return never


def _in_order(groups: list[tuple[int, ...]], transition: Transition, look: Callable[[], None]) -> list[tuple[int, ...]]:
    """Return groups so that those that an action changes lie near each other: each goes to the middle of its actions.

    The heuristic FORCE of Aloul, Markov and Sakallah (2003).
    """
    group_of = {place: number for number, places in enumerate(groups) for place in places}
    joined: set[frozenset[int]] = set()
    for letter in range(len(transition.actions)):
        look()
        joined.add(frozenset(group_of[place] for place in transition.places_set(transition.move(letter))))
    edges = sorted(sorted(each) for each in joined if len(each) > 1)
    position = dict(enumerate(range(len(groups))))
    best, least = list(range(len(groups))), _span(edges, position)
    for _ in range(ROUNDS if edges else 0):
        look()
        pulled: dict[int, list[float]] = {}
        for edge in edges:
            middle = sum(position[number] for number in edge) / len(edge)
            for number in edge:
                pulled.setdefault(number, []).append(middle)
        wish = {n: sum(pulled[n]) / len(pulled[n]) if n in pulled else float(position[n]) for n in position}
        order = sorted(position, key=lambda number: (wish[number], position[number]))
        position = {number: place for place, number in enumerate(order)}
        span = _span(edges, position)
        if span >= least:
            break
        best, least = order, span
    return [groups[number] for number in best]


def _span(edges: Iterable[Sequence[int]], position: dict[int, int]) -> int:
    return sum(max(position[n] for n in edge) - min(position[n] for n in edge) for edge in edges)
