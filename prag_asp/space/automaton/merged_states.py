"""Words, ranks and samples of an automaton whose states are merged up to renaming of interchangeable entities.

A path of the merged automaton stands for many words. A walk composes the renamings edge by edge, and expands each edge
into the actions that it stands for. Words therefore have the same order as in the automaton without merging. A unit of
a joint group counts as an entity here, as in `Merging`.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from itertools import product
from typing import Any

import numpy as np
from numpy.typing import NDArray

from prag_asp.logic.symmetry.symmetries import Unit
from prag_asp.logic.symmetry.term_patterns import Patterns
from prag_asp.logic.symmetry.twins import Twins
from prag_asp.space.automaton.automaton import Automaton, Completions, Word
from prag_asp.space.automaton.exploration import Renamings
from prag_asp.space.automaton.walks import Choice, owner_of, words_along

Names = NDArray[np.int64]
"""For each entity of a merged state, the entity that it stands for, followed by -1, which stands for none."""


@dataclass(frozen=True)
class UnmergedState:
    """A state before merging: a merged state with the names of its entities."""

    state: int
    names: Names


@dataclass(frozen=True)
class _Branches:
    """The edges of a state before merging, in order of their letters, with their merged edges and entities."""

    edges: NDArray[np.intp]
    entities: NDArray[np.int64]
    letters: NDArray[np.int64]


@dataclass(frozen=True)
class MergedAutomaton:
    """An automaton with merged states.

    `base` has no weights; `own` holds, for each edge, the weight of a single action that it stands for, shape (edges,),
    or is None if all weights are 1.
    """

    base: Automaton
    renamings: Renamings
    actions: Patterns
    groups: tuple[tuple[Unit, ...], ...]
    own: NDArray[Any] | None = None
    _orbits: dict[int, tuple[NDArray[np.intp], NDArray[np.int64]]] = field(default_factory=dict, repr=False)

    @property
    def automaton(self) -> Automaton:
        """The merged automaton; the weight of an edge is the total weight of the actions that it stands for."""
        numbers = self.renamings.multiplicities
        weights = numbers if self.own is None else self.own * numbers.astype(object)
        return replace(self.base, weights=weights)

    @property
    def start(self) -> UnmergedState:
        """The initial state."""
        return UnmergedState(0, np.array([*range(self.actions.places), -1]))

    def branches(self, place: UnmergedState) -> _Branches:
        """Return the edges of a state in order of their letters."""
        edges, entities = self._orbit(place.state)
        patterns = self.actions.pattern[self.base.letters[edges]]
        letters = self.actions.find(patterns, place.names[entities])
        order = np.argsort(letters)
        return _Branches(edges[order], entities[order], letters[order])

    def after(self, place: UnmergedState, branches: _Branches, branch: int) -> UnmergedState:
        """Return the state to which a branch leads."""
        edge = int(branches.edges[branch])
        swapped = np.arange(self.actions.places)
        first = self.actions.entities[self.base.letters[edge]]
        for entity, named in zip(first.tolist(), branches.entities[branch].tolist(), strict=True):
            if entity >= 0:
                other = int(np.flatnonzero(swapped == named)[0])
                swapped[[entity, other]] = swapped[[other, entity]]
        order = self.renamings.orders[self.renamings.order_of[edge]]
        return UnmergedState(int(self.base.targets[edge]), np.append(place.names[swapped[order]], -1))

    def _orbit(self, state: int) -> tuple[NDArray[np.intp], NDArray[np.int64]]:
        """Return each edge of a state once for each exchange of twins in its action, with the resulting entities."""
        if state not in self._orbits:
            automaton, actions = self.base, self.actions
            twins = Twins.between(actions, self.renamings.twins[state : state + 1])
            edges: list[int] = []
            entities: list[tuple[int, ...]] = []
            for edge in range(int(automaton.offsets[state]), int(automaton.offsets[state + 1])):
                letter = int(automaton.letters[edge])
                named = actions.entities[letter, : actions.arity[letter]].tolist()
                rest = (-1,) * (actions.entities.shape[1] - len(named))
                for chosen in product(*(twins.members(entity) for entity in named)):
                    if len(set(chosen)) == len(chosen):
                        edges.append(edge)
                        entities.append((*chosen, *rest))
            shape = (len(edges), actions.entities.shape[1])
            entity_rows = np.array(entities, dtype=np.int64).reshape(shape)
            self._orbits[state] = np.array(edges, dtype=np.intp), entity_rows
        return self._orbits[state]


def accepts_merged(merged: MergedAutomaton, word: Sequence[int]) -> bool:
    """Return whether a word belongs to the automaton before merging."""
    automaton = merged.base
    if not automaton.states:
        return False
    place = merged.start
    for letter in word:
        branches = merged.branches(place)
        branch = int(np.searchsorted(branches.letters, letter))
        if branch == len(branches.letters) or branches.letters[branch] != letter:
            return False
        place = merged.after(place, branches, branch)
    return bool(automaton.accepting[place.state])


def count_merged(
    merged: MergedAutomaton, completions: Completions, length: int, prefix: Sequence[frozenset[int]] = ()
) -> int:
    """Return the total weight of the words of a given length whose first letters `prefix` allows."""
    if not completions.automaton.states or len(prefix) > length:
        return 0
    row = completions.last_row(length - len(prefix))
    return sum(weight * int(row[place.state]) for weight, place in _places_after(merged, prefix, []))


def count_following_merged(
    merged: MergedAutomaton, completions: Completions, length: int, prefix: Sequence[frozenset[int]] = ()
) -> dict[int, int]:
    """Return, for each letter that can follow `prefix`, the total weight of the words that continue with it."""
    found: dict[int, int] = {}
    if not completions.automaton.states or len(prefix) >= length:
        return found
    row = completions.row(length - len(prefix) - 1)
    for weight, place in _places_after(merged, prefix, list(range(merged.actions.places))):
        branches = merged.branches(place)
        for edge, letter in zip(branches.edges.tolist(), branches.letters.tolist(), strict=True):
            own = 1 if merged.own is None else int(merged.own[edge])
            found[letter] = found.get(letter, 0) + weight * own * int(row[merged.base.targets[edge]])
    return {letter: number for letter, number in sorted(found.items()) if number}


def _places_after(
    merged: MergedAutomaton, prefix: Sequence[frozenset[int]], distinguished_later: list[int]
) -> Iterable[tuple[int, UnmergedState]]:
    """Return the states after the words that `prefix` allows, each with the total weight of these words.

    States are combined if they differ only in entities that neither the rest of the prefix nor later letters
    distinguish.
    """
    reached: dict[tuple[int, ...], tuple[int, UnmergedState]] = {(): (1, merged.start)}
    for number, allowed in enumerate(prefix):
        distinguished = distinguished_later or _distinguished(merged.actions, prefix[number + 1 :])
        following: dict[tuple[int, ...], tuple[int, UnmergedState]] = {}
        for weight, place in reached.values():
            branches = merged.branches(place)
            for branch in range(len(branches.letters)):
                if int(branches.letters[branch]) not in allowed:
                    continue
                after = merged.after(place, branches, branch)
                own = 1 if merged.own is None else int(merged.own[branches.edges[branch]])
                roles = np.argsort(after.names[:-1])
                key = (after.state, *roles[distinguished].tolist())
                sofar, representative = following.get(key, (0, after))
                following[key] = (sofar + weight * own, representative)
        reached = following
    return reached.values()


def _distinguished(actions: Patterns, prefix: Sequence[frozenset[int]]) -> list[int]:
    """Return the entities that at least one set of letters in `prefix` distinguishes from others of their groups."""
    entities: set[int] = set()
    for allowed in prefix:
        letters = np.array(sorted(allowed), dtype=np.intp)
        patterns, counts = np.unique(actions.pattern[letters], return_counts=True)
        for pattern, number in zip(patterns, counts, strict=True):
            if number < (actions.pattern == pattern).sum():
                named = actions.entities[letters[actions.pattern[letters] == pattern]]
                entities.update(named[named >= 0].tolist())
    return sorted(entities)


def merged_words(
    merged: MergedAutomaton, completions: Completions, length: int, prefix: Sequence[frozenset[int]] = ()
) -> Iterator[Word]:
    """Yield the words of a given length in order, lazily; for `prefix`, see `count_merged`."""
    if not completions.automaton.states or len(prefix) > length:
        return

    def onward(place: UnmergedState, step: int) -> Iterator[tuple[int, UnmergedState]]:
        branches = merged.branches(place)
        for branch, letter in enumerate(branches.letters.tolist()):
            if step >= len(prefix) or letter in prefix[step]:
                after = merged.after(place, branches, branch)
                if completions.row(length - step - 1)[after.state]:
                    yield letter, after

    if completions.row(length)[0]:
        yield from words_along(merged.start, length, onward)


class MergedRanking:
    """The words of one length, ordered and ranked as in the automaton before merging; see `Ranking`."""

    def __init__(self, merged: MergedAutomaton, completions: Completions, length: int) -> None:
        self._merged = merged
        self._completions = completions
        self._length = length
        self.total = count_merged(merged, completions, length)
        completions.row(length)

    def unrank(self, rank: int) -> Word:
        """Return the word with a given rank, from 0 to total - 1."""
        return self.walk(owner_of(rank))[0]

    def rank(self, word: Sequence[int]) -> int | None:
        """Return the rank of a word in an automaton without weights, or None if it is not a word."""
        if len(word) != self._length or not accepts_merged(self._merged, word):
            return None
        rank, place = 0, self._merged.start
        for left, letter in zip(range(self._length, 0, -1), word, strict=True):
            branches = self._merged.branches(place)
            branch = int(np.searchsorted(branches.letters, letter))
            if branch:
                rank += int(self._totals(place, branches, left)[branch - 1])
            place = self._merged.after(place, branches, branch)
        return rank

    def _totals(self, place: UnmergedState, branches: _Branches, left: int) -> NDArray[Any]:
        """Return the running totals of the weights over the branches of a state with `left` remaining letters."""
        behind = self._completions.row(left - 1)[self._merged.base.targets[branches.edges]]
        exact = behind.astype(self._completions.row(left).dtype)
        return np.cumsum(exact if self._merged.own is None else exact * self._merged.own[branches.edges])

    def walk(self, choose: Choice) -> tuple[Word, int]:
        """Return a word and its weight.

        At each step, `choose` selects a branch, given the running totals of the weights.
        """
        word, weight, place = [], 1, self._merged.start
        for step in range(self._length):
            branches = self._merged.branches(place)
            totals = self._totals(place, branches, self._length - step)
            branch = choose(step, totals.tolist())
            if self._merged.own is not None:
                weight *= int(self._merged.own[branches.edges[branch]])
            word.append(int(branches.letters[branch]))
            place = self._merged.after(place, branches, branch)
        return tuple(word), weight
