"""Terms as shapes with slots for entities, and the renaming of terms."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

import clingo

Shaped = tuple[int, tuple[int, ...]]
"""The number of a shape, and the numbers of the entities in its slots, from left to right."""

PLACE = 0
"""The shape of a single entity."""


class Shapes:
    """Shapes of terms: two terms have the same shape if they differ at most in their entities.

    `entities` maps each entity to its number. Each subterm is processed once, because access to clingo's terms is slow.
    """

    def __init__(self, entities: Mapping[clingo.Symbol, int]) -> None:
        self._entities = entities
        self._numbers: dict[object, int] = {}
        self._shaped: dict[clingo.Symbol, Shaped] = {}

    def of(self, term: clingo.Symbol) -> Shaped:
        """Return the shape of a term and the entities in it."""
        shaped = self._shaped.get(term)
        if shaped is None:
            if term in self._entities:
                shaped = PLACE, (self._entities[term],)
            else:
                arguments = term.arguments if term.type == clingo.SymbolType.Function else ()
                parts = [self.of(argument) for argument in arguments]
                shape = (term.name, term.positive, *(number for number, _ in parts)) if parts else str(term)
                number = self._numbers.setdefault(shape, len(self._numbers) + 1)
                shaped = number, tuple(entity for _, entities in parts for entity in entities)
            self._shaped[term] = shaped
        return shaped


def by_entity(terms: Iterable[Shaped]) -> dict[int, list[Shaped]]:
    """Return the terms that name each entity."""
    naming: dict[int, list[Shaped]] = {}
    for term in terms:
        for entity in set(term[1]):
            naming.setdefault(entity, []).append(term)
    return naming


def renamed(term: clingo.Symbol, names: Mapping[clingo.Symbol, clingo.Symbol]) -> clingo.Symbol:
    """Return a term with its entities renamed."""
    if term in names:
        return names[term]
    if term.type == clingo.SymbolType.Function and term.arguments:
        return clingo.Function(term.name, [renamed(argument, names) for argument in term.arguments], term.positive)
    return term
