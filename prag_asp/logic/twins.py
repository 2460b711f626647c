"""Entities that a state does not tell apart, and the actions that are the same up to swapping these."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from prag_asp.logic.patterns import Patterns


@dataclass(frozen=True)
class Twins:
    """Classes of twins in some states, each by its first entity.

    Of each entity, `first` is the first twin, `rank` the number of twins before it, and `count` the number of all its
    twins with itself; all have shape (states, entities).
    """

    actions: Patterns
    first: NDArray[np.int64]
    rank: NDArray[np.int64]
    count: NDArray[np.int64]

    @classmethod
    def between(cls, actions: Patterns, twins: NDArray[np.bool_]) -> Twins:
        """Return the classes, where `twins` says which entities are twins of the ones before them."""
        places = np.arange(twins.shape[1])
        first = np.maximum.accumulate(np.where(twins, 0, places), axis=1)
        count = np.zeros(first.shape, dtype=np.int64)
        np.add.at(count, (np.arange(len(first))[:, None], first), 1)
        return cls(actions, first, places - first, np.take_along_axis(count, first, axis=1))

    def wanted(self, letter: int) -> NDArray[np.bool_] | None:
        """Return in which states an action stands for its renamings by twins: the entities it names come in order."""
        result: NDArray[np.bool_] | None = None
        for entity, before in self._named(letter):
            rank = self.rank[:, entity] == self._earlier(entity, before, slice(None))
            result = rank if result is None else result & rank
        return result

    def multiplicity(self, letter: int, states: NDArray[np.intp]) -> NDArray[np.int64]:
        """Return how many renamings by twins an action has in each of some states."""
        result = np.ones(len(states), dtype=np.int64)
        for entity, before in self._named(letter):
            result *= self.count[states, entity] - self._earlier(entity, before, states)
        return result

    def members(self, entity: int) -> range:
        """Return all twins of an entity in the first state, with itself."""
        first = int(self.first[0, entity])
        return range(first, first + int(self.count[0, entity]))

    def _named(self, letter: int) -> list[tuple[int, list[int]]]:
        """Return the entities that an action names, each with the ones that it names before."""
        named = self.actions.entities[letter, : self.actions.arity[letter]].tolist()
        return [(entity, named[:place]) for place, entity in enumerate(named)]

    def _earlier(self, entity: int, before: list[int], states: NDArray[np.intp] | slice) -> NDArray[np.int64]:
        """Return how many of the entities `before` are twins of an entity."""
        found = np.zeros(len(self.first[states]), dtype=np.int64)
        for other in before:
            found += self.first[states, other] == self.first[states, entity]
        return found
