"""Twins: entities whose swap does not change a state, and the actions that are equal up to such swaps."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from prag_asp.logic.symmetry.term_patterns import Patterns


@dataclass(frozen=True)
class Twins:
    """Classes of twins in given states, each represented by its first entity.

    For each entity, `first` is the first twin, `rank` the number of twins before it, and `count` the number of all its
    twins including itself; all have shape (states, entities).
    """

    actions: Patterns
    first: NDArray[np.int64]
    rank: NDArray[np.int64]
    count: NDArray[np.int64]

    @classmethod
    def between(cls, actions: Patterns, twins: NDArray[np.bool_]) -> Twins:
        """Return the classes, given which entities are twins of the previous entity, shape (states, entities)."""
        places = np.arange(twins.shape[1])
        first = np.maximum.accumulate(np.where(twins, 0, places), axis=1)
        count = np.zeros(first.shape, dtype=np.int64)
        np.add.at(count, (np.arange(len(first))[:, None], first), 1)
        return cls(actions, first, places - first, np.take_along_axis(count, first, axis=1))

    def representatives(self) -> NDArray[np.bool_]:
        """Return, for each state, which actions represent their renamings by twins, shape (states, actions).

        These are the actions that name the entities of each class in their order.
        """
        entities = self.actions.entities
        result = np.ones((len(self.first), len(entities)), dtype=np.bool_)
        for place, entity in enumerate(entities.T):
            named = np.flatnonzero(entity >= 0)
            due = self._twins_before(entities[named], place, slice(None))
            result[:, named] &= self.rank[:, entity[named]] == due
        return result

    def multiplicity(self, letter: int, states: NDArray[np.intp]) -> NDArray[np.int64]:
        """Return the number of renamings by twins of an action in each of the given states, shape (states,)."""
        entities = self.actions.entities[letter : letter + 1]
        result = np.ones(len(states), dtype=np.int64)
        for place in range(int(self.actions.arity[letter])):
            before = self._twins_before(entities, place, states)
            result *= (self.count[states][:, entities[:, place]] - before)[:, 0]
        return result

    def members(self, entity: int) -> range:
        """Return all twins of an entity in state 0, including itself."""
        first = int(self.first[0, entity])
        return range(first, first + int(self.count[0, entity]))

    def _twins_before(
        self, entities: NDArray[np.int64], place: int, states: NDArray[np.intp] | slice
    ) -> NDArray[np.int64]:
        """Return how many twins of an action's entity at index `place` the action names before this index.

        `entities` has a row for each action; the result has shape (states, actions).
        """
        first = self.first[states]
        counts = np.zeros((len(first), len(entities)), dtype=np.int64)
        for earlier in range(place):
            counts += first[:, entities[:, earlier]] == first[:, entities[:, place]]
        return counts
