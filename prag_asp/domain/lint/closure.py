"""Why what is known contradicts the invariants: the chain of them that leads to a conflict."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

import clingo

from prag_asp.domain.facts import Facts

Literal = tuple[clingo.Symbol, bool]
Graph = Mapping[Literal, tuple[Literal, ...]]


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


def conflict(known: Iterable[Literal], graph: Graph) -> tuple[Literal, Literal] | None:
    """Return two literals of `known` (twice the same one, where it contradicts itself) that cannot both hold."""
    reason: dict[Literal, Literal] = {}
    for start in known:
        stack = [start]
        while stack:
            literal = stack.pop()
            fluent, value = literal
            if (fluent, not value) in reason:
                return reason[fluent, not value], start
            if literal not in reason:
                reason[literal] = start
                stack += graph.get(literal, ())
    return None


def entailed(known: Iterable[Literal], graph: Graph) -> list[Literal]:
    """Return what is known and all that follows from it."""
    found: dict[Literal, None] = {}
    stack = list(known)[::-1]
    while stack:
        literal = stack.pop()
        if literal not in found:
            found[literal] = None
            stack += graph.get(literal, ())
    return list(found)


def spell(literal: Literal) -> str:
    """Return a literal in words."""
    return f"{literal[0]} {'true' if literal[1] else 'false'}"
