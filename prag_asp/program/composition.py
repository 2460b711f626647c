"""The actions of composites, and cycles among declarations."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from graphlib import CycleError, TopologicalSorter

import clingo

from prag_asp.program.facts import Facts

Actions = tuple[clingo.Symbol, ...]


def composite_actions(facts: Facts) -> Mapping[clingo.Symbol, Actions]:
    """Return the atomic actions of each composite in order; composites must not form a cycle.

    A composite comes after the composites that it contains.
    """
    actions_of: dict[clingo.Symbol, Actions] = {}
    for composite in _innermost_first(facts):
        parts = (part for _, part in facts.stages[composite])
        actions_of[composite] = tuple(action for part in parts for action in actions_of.get(part, (part,)))
    return actions_of


def composite_sizes(facts: Facts) -> Mapping[clingo.Symbol, int]:
    """Return the number of atomic actions in each composite; composites must not form a cycle."""
    sizes: dict[clingo.Symbol, int] = {}
    for composite in _innermost_first(facts):
        sizes[composite] = sum(sizes.get(part, 1) for _, part in facts.stages[composite])
    return sizes


def inner_composites(facts: Facts) -> Mapping[clingo.Symbol, list[clingo.Symbol]]:
    """Return, for each composite, those of its stages that are composites themselves."""
    return {c: [part for _, part in facts.stages.get(c, ()) if part in facts.stages] for c in facts.composites}


def _innermost_first(facts: Facts) -> Iterable[clingo.Symbol]:
    return TopologicalSorter(inner_composites(facts)).static_order()


def find_cycle(successors: Mapping[clingo.Symbol, Iterable[clingo.Symbol]]) -> list[clingo.Symbol]:
    """Return a cycle as a list that begins and ends with its smallest term, or an empty list.

    If there are several cycles, the choice depends only on the terms.
    """
    sorter: TopologicalSorter[clingo.Symbol] = TopologicalSorter()
    for term, others in sorted(successors.items()):
        for other in sorted(others):
            sorter.add(other, term)
    try:
        sorter.prepare()
    except CycleError as error:
        cycle: list[clingo.Symbol] = error.args[1][1:]
        least = cycle.index(min(cycle))
        return [*cycle[least:], *cycle[:least], cycle[least]]
    return []
