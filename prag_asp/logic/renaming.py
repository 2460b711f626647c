"""Terms under other names for their entities."""

from __future__ import annotations

from collections.abc import Mapping

import clingo


def renamed(term: clingo.Symbol, names: Mapping[clingo.Symbol, clingo.Symbol]) -> clingo.Symbol:
    """Return a term with other names for its entities."""
    if term in names:
        return names[term]
    if term.type == clingo.SymbolType.Function and term.arguments:
        return clingo.Function(term.name, [renamed(argument, names) for argument in term.arguments], term.positive)
    return term
