"""Composites and the orders among declarations."""

from __future__ import annotations

import random

from clingo import Function, Symbol

from prag_asp.program.composition import find_cycle


def named(*names: str) -> list[Symbol]:
    return [Function(name) for name in names]


def test_the_reported_cycle_depends_on_the_terms_alone() -> None:
    edges = [("b", "c"), ("c", "d"), ("d", "b"), ("a", "b"), ("d", "e"), ("f", "g"), ("g", "f")]
    cycles = set()
    for seed in range(50):
        chance = random.Random(seed)
        shuffled = chance.sample(edges, len(edges))
        successors: dict[Symbol, list[Symbol]] = {}
        for one, other in shuffled:
            successors.setdefault(Function(one), []).append(Function(other))
        cycles.add(tuple(map(str, find_cycle(successors))))
    assert cycles == {("b", "c", "d", "b")}


def test_a_term_may_come_right_after_itself_and_without_a_cycle_there_is_none() -> None:
    (a, b, c) = named("a", "b", "c")
    assert find_cycle({b: [a, b]}) == [b, b]
    assert find_cycle({a: [b, c], b: [c]}) == []
    assert find_cycle({}) == []
