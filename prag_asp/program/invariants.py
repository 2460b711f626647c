"""What follows from values of fluents by the invariants, and which of them cannot hold together."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

import clingo

from prag_asp.program.facts import Facts

FluentValue = tuple[clingo.Symbol, bool]
"""A fluent with its value."""

Graph = Mapping[FluentValue, tuple[FluentValue, ...]]
Reasons = Mapping[FluentValue, FluentValue]
"""Which value each one was found to follow from."""


def invariant_graph(facts: Facts, *, impossible: bool = False) -> Graph:
    """Return what each value entails by one invariant, or, if asked for, by what is `impossible` as well."""
    graph: dict[FluentValue, list[FluentValue]] = {}
    for first, second in (*facts.exclusive, *(facts.impossible if impossible else ())):
        graph.setdefault((first, True), []).append((second, False))
        graph.setdefault((second, True), []).append((first, False))
    for first, second in facts.implies:
        graph.setdefault((first, True), []).append((second, True))
        graph.setdefault((second, False), []).append((first, False))
    return {value: tuple(entailed) for value, entailed in graph.items()}


def entailed(known: Iterable[FluentValue], graph: Graph) -> dict[FluentValue, FluentValue]:
    """Return what is known and all that follows from it, each with what it follows from."""
    reasons: dict[FluentValue, FluentValue] = {}
    for start in known:
        stack = [start]
        while stack:
            value = stack.pop()
            if value not in reasons:
                reasons[value] = start
                stack += graph.get(value, ())
    return reasons


def conflict(reasons: Reasons, given: Reasons | None = None) -> tuple[FluentValue, FluentValue] | None:
    """Return two values whose consequences contradict each other: the same one twice, where its own do.

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


def spell(value: FluentValue) -> str:
    """Return a value as text: ``open(door) = true``."""
    return f"{value[0]} = {'true' if value[1] else 'false'}"
