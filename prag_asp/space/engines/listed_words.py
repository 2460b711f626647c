"""Weighted words for engines that enumerate words, and the engine for lengths without words."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from math import lcm

import numpy as np

from prag_asp.logic.domain_logic import DomainLogic
from prag_asp.space.automaton.automaton import Automaton, Completions
from prag_asp.space.engines.engine import Letters, Level, all_letters
from prag_asp.space.weights.weights import Weighed, Weights, refuse_weights


def weigh_words(
    words: Iterable[Letters],
    letters: Letters,
    model: DomainLogic,
    level: Level,
    length: int,
    weights: Weights,
    goals: bool,
) -> Weighed:
    """Return the weighted words of a level and length; with `goals`, also the known part of their final states.

    Raises:
        QueryError: the weights distinguish interchangeable entities, or skeletons have weights.
    """
    from prag_asp.space.plans.task_builder import TaskBuilder

    refuse_weights(level, weights, model, length)
    everything = list(words)
    numbers = {letter: number for number, letter in enumerate(letters)}
    spelled = [[numbers[letter] for letter in word] for word in everything]
    if level == "skeleton":
        return word_tree(spelled, length)
    actions = {str(action): action for action in model.domain.facts.actions}
    weighs = [weights.of_plan([actions[letter] for letter in word]) for word in everything] if weights else None
    return word_tree(spelled, length, weighs, TaskBuilder(model).final_values(everything) if goals else None)


def word_tree(
    words: Sequence[Sequence[int]],
    length: int,
    weights: Sequence[Fraction] | None = None,
    ends: Sequence[tuple[int, ...]] | None = None,
) -> Weighed:
    """Return ordered words of one length as a tree with a leaf for each word.

    `ends` has the values of the fluents in the final state of each word, as in `FluentValues`.
    """
    numbers: dict[tuple[int, ...], int] = {} if not words else {(): 0}
    for depth in range(1, length + 1):
        for word in words:
            numbers.setdefault(tuple(word[:depth]), len(numbers))
    scale = lcm(*(weight.denominator for weight in weights)) if weights and length else 1
    whole = [1] * len(numbers)
    goals = [0] * len(numbers)
    kinds: dict[tuple[int, ...], int] = {}
    for place, word in enumerate(words):
        leaf = numbers[tuple(word)]
        whole[leaf] = int(weights[place] * scale) if weights and length else 1
        goals[leaf] = kinds.setdefault(ends[place], len(kinds)) if ends else 0
    prefixes = sorted(prefix for prefix in numbers if prefix)
    prefixes.sort(key=lambda prefix: numbers[prefix[:-1]])
    below = [numbers[prefix] for prefix in prefixes]
    sources = np.array([numbers[prefix[:-1]] for prefix in prefixes], dtype=np.int64)
    automaton = Automaton(
        np.searchsorted(sources, np.arange(len(numbers) + 1)).astype(np.int64),
        np.array([prefix[-1] for prefix in prefixes], dtype=np.int64),
        np.array(below, dtype=np.int64),
        np.array([len(prefix) == length for prefix in numbers], dtype=np.bool_),
        np.array([whole[leaf] for leaf in below], dtype=object) if weights else None,
        length,
    )
    if ends is None:
        return Weighed(Completions(automaton), Fraction(1, scale))
    ended = np.array([goals[leaf] for leaf in below], dtype=np.int64)
    values = np.array([*kinds], dtype=np.int8).T
    return Weighed(Completions(automaton), Fraction(1, scale), ended, goal_values=values)


@dataclass(frozen=True)
class NoWords:
    """The engine for lengths without words; it grounds nothing."""

    model: DomainLogic
    level: Level

    @property
    def letters(self) -> Letters:
        """The texts of the letters, in order."""
        return tuple(all_letters(self.model, self.level))

    def count(self, length: int, prefix: Letters = ()) -> int:
        """Return 0, because there are no words."""
        return 0

    def following(self, length: int, prefix: Letters = ()) -> dict[str, int]:
        """Return no counts, because no letter can follow `prefix`."""
        return {}

    def words(self, length: int, prefix: Letters = ()) -> Iterator[Letters]:
        """Yield the words of a given length in order."""
        return iter(())

    def contains(self, word: Letters) -> bool:
        """Return whether a word belongs to the level."""
        return False

    def unrank(self, length: int, rank: int) -> Letters:
        """Raise an IndexError, because there are no words."""
        raise IndexError(rank)

    def rank(self, word: Letters) -> int | None:
        """Return None, because there are no words."""
        return None

    def weighed(self, length: int, weights: Weights, *, goals: bool = False, plain: bool = False) -> Weighed:
        """Return the weighted words of a given length."""
        return weigh_words((), self.letters, self.model, self.level, length, Weights(), goals=False)
