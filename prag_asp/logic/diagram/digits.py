"""The variables of a state grouped into digits, and the order of the digits; both determine the size of diagrams.

Mutually exclusive variables (such as the locations of one object) form one digit with few values. Which variables
exclude each other is estimated by random walks. A wrong estimate costs time but is not an error, because a digit may
take any value.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property
from weakref import WeakKeyDictionary

import numpy as np

from prag_asp.logic.step.packed import Rows, unpack
from prag_asp.logic.step.transition import Transition
from prag_asp.program.predicates import HOLDS

WALKERS, STEPS = 256, 24
"""The number of random walks, and their length in steps."""

EXPECTED = 5.0
"""Two variables that are both true in no state are assumed to exclude each other if more than this number of such
states would be expected of independent variables."""

MOST_DIGITS = 200
"""The maximum number of digits of a state, which is the recursion depth; if there are more, neighbouring digits are
merged."""

ROUNDS = 30
"""The number of rounds of the FORCE heuristic."""


@dataclass(frozen=True)
class Digits:
    """The indices of the variables of each digit, from the lowest bit up; the digits are in order of their levels."""

    places: tuple[tuple[int, ...], ...]

    @cached_property
    def at(self) -> dict[int, tuple[int, int]]:
        """The level of each variable, and its bit as a mask."""
        return {
            place: (level, 1 << bit) for level, places in enumerate(self.places) for bit, place in enumerate(places)
        }

    def word(self, row: Rows, variables: int) -> tuple[int, ...]:
        """Return the digits of a packed state of shape (1, words)."""
        true = unpack(row, variables)[:, 0].tolist()
        return tuple(sum(1 << bit for bit, place in enumerate(places) if true[place]) for places in self.places)


_digits_of: WeakKeyDictionary[Transition, Digits] = WeakKeyDictionary()


def find_digits(transition: Transition, look: Callable[[], None]) -> Digits:
    """Return digits for the states of a step function with an initial state; `look` is called regularly."""
    if transition in _digits_of:
        return _digits_of[transition]
    # An item is a fluent (its true value before its false one) or another variable.
    by_fluent: dict[object, list[int]] = {}
    for place, symbol in reversed(list(enumerate(transition.variables))):
        is_fluent = symbol.match(*HOLDS.without_time)
        by_fluent.setdefault(("holds", symbol.arguments[0]) if is_fluent else symbol, []).append(place)
    items = list(reversed(by_fluent.values()))
    walked = unpack(_walked(transition, look), len(transition.variables))
    true = walked[np.array([item[0] for item in items], dtype=np.intp)].astype(np.float64)
    often = true.sum(axis=1)
    excluded = (true @ true.T == 0) & (np.outer(often, often) >= EXPECTED * true.shape[1])
    groups: list[list[int]] = []
    for number in range(len(items)):
        look()
        home = next((group for group in groups if all(excluded[number, other] for other in group)), None)
        if home is None:
            groups.append([number])
        else:
            home.append(number)
    ordered = [tuple(place for number in group for place in items[number]) for group in groups]
    ordered = _in_order(ordered or [()], transition, look)
    while len(ordered) > MOST_DIGITS:
        ordered = [sum(ordered[place : place + 2], ()) for place in range(0, len(ordered), 2)]
    digits = _digits_of[transition] = Digits(tuple(ordered))
    return digits


def _walked(transition: Transition, look: Callable[[], None]) -> Rows:
    """Return the states of random walks from the initial state, with a fixed seed."""
    generator = np.random.default_rng(0)
    rows = np.repeat(transition.initial, WALKERS, axis=0)
    passed = [rows[:1]]
    for _ in range(STEPS):
        look()
        successors = [each for each in transition.expand(rows) if len(each.sources)]
        if not successors:
            break
        sources = np.concatenate([each.sources for each in successors])
        states = np.concatenate([each.states for each in successors])
        shuffled = generator.permutation(len(sources))
        walkers, chosen = np.unique(sources[shuffled], return_index=True)
        rows = states[shuffled[chosen]][np.resize(np.arange(len(walkers)), WALKERS)]
        passed.append(rows)
    return np.concatenate(passed)


def _in_order(groups: list[tuple[int, ...]], transition: Transition, look: Callable[[], None]) -> list[tuple[int, ...]]:
    """Return the groups of variables, ordered so that groups that the same action changes are close to each other.

    This is the FORCE heuristic of Aloul, Markov and Sakallah (2003).
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
