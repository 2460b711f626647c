"""What follows from literals by the invariants, and which of them cannot hold together."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

import clingo

from prag_asp.program.facts import Facts

Literal = tuple[clingo.Symbol, bool]
Graph = Mapping[Literal, tuple[Literal, ...]]
Reasons = Mapping[Literal, Literal]
"""Which literal each one was found to follow from."""


def invariant_graph(facts: Facts) -> Graph:
    """Return what each literal entails by one invariant."""
    graph: dict[Literal, list[Literal]] = {}
    for first, second in facts.exclusive:
        graph.setdefault((first, True), []).append((second, False))
        graph.setdefault((second, True), []).append((first, False))
    for first, second in facts.implies:
        graph.setdefault((first, True), []).append((second, True))
        graph.setdefault((second, False), []).append((first, False))
    return {literal: tuple(entailed) for literal, entailed in graph.items()}


def entailed(known: Iterable[Literal], graph: Graph) -> dict[Literal, Literal]:
    """Return what is known and all that follows from it, each with what it follows from."""
    reasons: dict[Literal, Literal] = {}
    for start in known:
        stack = [start]
        while stack:
            literal = stack.pop()
            if literal not in reasons:
                reasons[literal] = start
                stack += graph.get(literal, ())
    return reasons


def conflict(reasons: Reasons, given: Reasons | None = None) -> tuple[Literal, Literal] | None:
    """Return two literals whose consequences contradict each other: the same one twice, where its own do.

    With `given`, the first of them is one of its reasons.
    """
    against = reasons if given is None else given
    if not against:
        return None
    for (fluent, value), start in reasons.items():
        other = against.get((fluent, not value))
        if other is not None:
            return other, start
    return None


def spell(literal: Literal) -> str:
    """Return a literal as text: ``open(door) = true``."""
    return f"{literal[0]} = {'true' if literal[1] else 'false'}"
