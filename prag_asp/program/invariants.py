"""The consequences of fluent values under the invariants, and conflicts between them."""

from __future__ import annotations

from collections.abc import Hashable, Iterable, Mapping
from typing import TypeVar

import clingo

from prag_asp.program.facts import Facts

FluentValue = tuple[clingo.Symbol, bool]
"""A fluent with its value."""

Value = TypeVar("Value", bound=Hashable)
"""A fluent with its value, or a representation of such a pair."""

Graph = Mapping[FluentValue, tuple[FluentValue, ...]]
Reasons = Mapping[FluentValue, FluentValue]
"""The value from which each derived value follows."""


def invariant_graph(facts: Facts, *, impossible: bool = False) -> Graph:
    """Map each value to the values that a single invariant (with `impossible`, also an impossible pair) entails."""
    graph: dict[FluentValue, list[FluentValue]] = {}
    for first, second in (*facts.exclusive, *(facts.impossible if impossible else ())):
        graph.setdefault((first, True), []).append((second, False))
        graph.setdefault((second, True), []).append((first, False))
    for first, second in facts.implies:
        graph.setdefault((first, True), []).append((second, True))
        graph.setdefault((second, False), []).append((first, False))
    return {value: tuple(entailed) for value, entailed in graph.items()}


def entailed(values: Iterable[Value], graph: Mapping[Value, tuple[Value, ...]]) -> dict[Value, Value]:
    """Return values and their consequences, each mapped to the given value from which it follows."""
    if not graph:
        return {value: value for value in values}
    reasons: dict[Value, Value] = {}
    for start in values:
        stack = [start]
        while stack:
            value = stack.pop()
            if value not in reasons:
                reasons[value] = start
                stack += graph.get(value, ())
    return reasons


def conflict(reasons: Reasons, others: Reasons | None = None) -> tuple[FluentValue, FluentValue] | None:
    """Return two values with contradictory consequences (the same value twice if it contradicts itself), or None.

    With `others`, the first value comes from `others`, and the second from `reasons`.
    """
    against = reasons if others is None else others
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
