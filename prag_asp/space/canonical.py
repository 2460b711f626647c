"""The canonical name of a plan: interchangeable entities introduced in their order."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

import clingo

from prag_asp.domain.atom import Atom, parse_atom
from prag_asp.logic.program import mentioned_entities


def canonical_names(
    plan: Iterable[Atom], groups: Sequence[Sequence[clingo.Symbol]]
) -> dict[clingo.Symbol, clingo.Symbol]:
    """Return new names for the entities of `groups` that a plan uses: in each group, the first used is the first."""
    group_of = {entity: group for group in groups for entity in group}
    names: dict[clingo.Symbol, clingo.Symbol] = {}
    introduced: dict[clingo.Symbol, int] = {}
    for action in plan:
        for entity in mentioned_entities(clingo.parse_term(str(action)), group_of):
            if entity not in names:
                group = group_of[entity]
                names[entity] = group[introduced.setdefault(group[0], 0)]
                introduced[group[0]] += 1
    return names


def renamed(plan: Iterable[Atom], names: Mapping[clingo.Symbol, clingo.Symbol]) -> list[Atom]:
    """Return a plan with other names for its entities."""
    return [parse_atom(str(_renamed(clingo.parse_term(str(action)), names))) for action in plan]


def _renamed(term: clingo.Symbol, names: Mapping[clingo.Symbol, clingo.Symbol]) -> clingo.Symbol:
    if term in names:
        return names[term]
    if term.type == clingo.SymbolType.Function and term.arguments:
        return clingo.Function(term.name, [_renamed(argument, names) for argument in term.arguments], term.positive)
    return term
