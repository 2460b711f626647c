"""The automaton engine: explore the states once, then count, rank and draw by dynamic programming."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from fractions import Fraction
from functools import cached_property

import numpy as np

from prag_asp.logic.hindsight import Hindsight
from prag_asp.logic.model import Model
from prag_asp.logic.program import action_name
from prag_asp.space.automaton import Completions, Ranking, accepts, count_words, words
from prag_asp.space.engines.protocol import Letters, Level, Progress
from prag_asp.space.explore import explore
from prag_asp.space.skeletons import skeleton_automaton
from prag_asp.space.weights import Weighed, Weights, refuse_weights, weigh, weighing_facts


class AutomatonEngine:
    """Answers for one domain at one level; what was explored is kept for the next question.

    Raises:
        EngineError: the step is not a function of the state and the action.
    """

    def __init__(self, model: Model, level: Level, progress: Progress | None = None) -> None:
        self._model = model
        self._level = level
        self._progress = progress
        self._explored: Completions | None = None
        self._ranked: tuple[int, Ranking] | None = None
        self._weighed: tuple[int, Weights, bool, Weighed] | None = None
        self._transition = model.transition(tasks=level != "plan")

    @cached_property
    def letters(self) -> tuple[str, ...]:
        """The texts of the letters, in their order."""
        actions = self._transition.actions
        if self._level == "skeleton":
            return tuple(sorted({action_name(action) for action in actions}))
        return tuple(map(str, actions))

    @cached_property
    def _numbers(self) -> dict[str, int]:
        return {letter: number for number, letter in enumerate(self.letters)}

    def count(self, length: int, prefix: Letters = ()) -> int:
        """Return the number of words of a length."""
        return count_words(self._completions(length), length, self._tests(prefix))

    def words(self, length: int, prefix: Letters = ()) -> Iterator[Letters]:
        """Yield the words of a length in order, lazily."""
        for word in words(self._completions(length), length, self._tests(prefix)):
            yield self._spelled(word)

    def contains(self, word: Letters) -> bool:
        """Return whether a word belongs to the level."""
        if not all(letter in self._numbers for letter in word):
            return False
        return accepts(self._completions(len(word)).automaton, [self._numbers[letter] for letter in word])

    def unrank(self, length: int, rank: int) -> Letters:
        """Return the word of a rank from 0 to count - 1."""
        return self._spelled(self._ranking(length).unrank(rank))

    def rank(self, word: Letters) -> int | None:
        """Return the rank of a word among those of its length, or None where it is no word."""
        if not all(letter in self._numbers for letter in word):
            return None
        return self._ranking(len(word)).rank([self._numbers[letter] for letter in word])

    def weighed(self, length: int, weights: Weights, *, goals: bool = False) -> Weighed:
        """Return the words of a length with their weights, and keep the last ones made."""
        refuse_weights(self._level, weights, self._model, length)
        if not weights and not goals:
            return Weighed(self._completions(length))
        if self._weighed is None or self._weighed[:3] != (length, weights, goals):
            self._weighed = (length, weights, goals, self._weigh(length, weights, goals))
        return self._weighed[3]

    def _spelled(self, word: Sequence[int]) -> Letters:
        return tuple(self.letters[letter] for letter in word)

    def _tests(self, prefix: Letters) -> list[Callable[[int], bool]]:
        return [self._matching(text).__contains__ for text in prefix]

    def _matching(self, text: str) -> frozenset[int]:
        if self._level == "skeleton" or text in self._numbers:
            return frozenset({self._numbers[text]} if text in self._numbers else ())
        names = enumerate(map(action_name, self._transition.actions))
        return frozenset(number for number, name in names if name == text)

    def _completions(self, length: int) -> Completions:
        found = self._explored
        if found is None or (found.automaton.horizon is not None and found.automaton.horizon < length):
            automaton, _ = explore(self._transition, length, self._report)
            if self._level == "skeleton":
                names = [self._numbers[action_name(action)] for action in self._transition.actions]
                automaton = skeleton_automaton(automaton, np.array(names, dtype=np.int64))
            found = self._explored = Completions(automaton)
        return found

    def _ranking(self, length: int) -> Ranking:
        """Return the ranking of a length, and keep the last one made."""
        if self._ranked is None or self._ranked[0] != length:
            self._ranked = (length, Ranking(self._completions(length), length))
        return self._ranked[1]

    def _weigh(self, length: int, weights: Weights, goals: bool) -> Weighed:
        facts, labels = weighing_facts(weights)
        hindsight = Hindsight(self._model.step, self._model.domain.facts.fluents) if goals else None
        read = hindsight.last_read if hindsight else ()
        transition = self._model.transition(tasks=self._level != "plan", weighed=facts, labels=(*labels, *read))
        automaton, marks = explore(transition, length, self._report)
        scale = 1
        if weights:
            automaton, scale = weigh(automaton, marks[:, : len(labels)], transition.actions, weights)
        ends = None
        if hindsight:
            kinds, places = np.unique(marks[:, len(labels) :], axis=0, return_inverse=True)
            _, goal_of = np.unique(hindsight.tell_ends(kinds.T), axis=1, return_inverse=True)
            ends = goal_of.reshape(-1)[places.reshape(-1)]
        return Weighed(Completions(automaton), Fraction(1, scale**length), ends)

    def _report(self, depth: int, states: int) -> None:
        if self._progress:
            self._progress(f"depth {depth}: {states:,} states")
