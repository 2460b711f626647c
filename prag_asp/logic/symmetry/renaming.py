"""Terms as shapes with places for entities, and renamed terms."""

from __future__ import annotations

from collections.abc import Mapping

import clingo

Shaped = tuple[int, tuple[int, ...]]
"""The number of a shape, and the numbers of the entities that take its places, from the left."""

PLACE = 0
"""The shape of a single entity."""


class Shapes:
    """Shapes of terms: two terms have one shape if they differ only in the entities at its places.

    An entity has its number of `entities`. Each subterm is processed once, because clingo's terms are slow.
    """

    def __init__(self, entities: Mapping[clingo.Symbol, int]) -> None:
        self._entities = entities
        self._numbers: dict[object, int] = {}
        self._shaped: dict[clingo.Symbol, Shaped] = {}

    def of(self, term: clingo.Symbol) -> Shaped:
        """Return the shape of a term and the entities in it."""
        shaped = self._shaped.get(term)
        if shaped is None:
            shaped = self._shaped[term] = self._compute(term)
        return shaped

    def _compute(self, term: clingo.Symbol) -> Shaped:
        if term in self._entities:
            return PLACE, (self._entities[term],)
        if term.type != clingo.SymbolType.Function or not term.arguments:
            return self._number(str(term)), ()
        parts = [self.of(argument) for argument in term.arguments]
        shape = self._number((term.name, term.positive, *(number for number, _ in parts)))
        return shape, tuple(entity for _, entities in parts for entity in entities)

    def _number(self, shape: object) -> int:
        return self._numbers.setdefault(shape, len(self._numbers) + 1)


def renamed(term: clingo.Symbol, names: Mapping[clingo.Symbol, clingo.Symbol]) -> clingo.Symbol:
    """Return a term with its entities renamed."""
    if term in names:
        return names[term]
    if term.type == clingo.SymbolType.Function and term.arguments:
        return clingo.Function(term.name, [renamed(argument, names) for argument in term.arguments], term.positive)
    return term
