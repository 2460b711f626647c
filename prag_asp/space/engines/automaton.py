"""The automaton engine: explore the states once, then count, rank and draw by dynamic programming."""

from __future__ import annotations

import random
from collections.abc import Callable, Iterator, Sequence
from fractions import Fraction
from functools import cached_property

import numpy as np

from prag_asp.errors import QueryError
from prag_asp.logic.model import Model
from prag_asp.logic.program import action_name
from prag_asp.space.automaton import Completions, Ranking, accepts, count_words, words
from prag_asp.space.engines.protocol import Draw, Letters, Level, Progress
from prag_asp.space.explore import explore
from prag_asp.space.skeletons import skeleton_automaton
from prag_asp.space.weights import Weights, refuse_unequal, weigh, weighing_facts


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
        self._ranked: tuple[int, Weights, Ranking] | None = None
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
        return self._spelled(self._ranking(length, Weights()).unrank(rank))

    def rank(self, word: Letters) -> int | None:
        """Return the rank of a word among those of its length, or None where it is no word."""
        if not all(letter in self._numbers for letter in word):
            return None
        return self._ranking(len(word), Weights()).rank([self._numbers[letter] for letter in word])

    def draws(self, length: int, generator: random.Random, weights: Weights) -> Iterator[Draw]:
        """Yield words drawn independently, each with a probability proportional to its weight, without end."""
        ranking = self._ranking(length, weights)
        if not ranking.total:
            raise QueryError(f"there is no {self._level} of length {length} to draw")
        share = Fraction(1, ranking.total)
        while True:
            word, weight = ranking.draw(generator)
            yield Draw(self._spelled(word), share if weight == 1 else weight * share)

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
            automaton = explore(self._transition, length, self._report).automaton
            if self._level == "skeleton":
                names = [self._numbers[action_name(action)] for action in self._transition.actions]
                automaton = skeleton_automaton(automaton, np.array(names, dtype=np.int64))
            found = self._explored = Completions(automaton)
        return found

    def _ranking(self, length: int, weights: Weights) -> Ranking:
        """Return the ranking of a length by weights, and keep the last one made."""
        if self._ranked is None or self._ranked[:2] != (length, weights):
            made = self._weighed(length, weights) if weights else self._completions(length)
            self._ranked = (length, weights, Ranking(made, length))
        return self._ranked[2]

    def _weighed(self, length: int, weights: Weights) -> Completions:
        if self._level == "task":
            refuse_unequal(weights, self._model.groups(length))
        facts, labels = weighing_facts(weights)
        transition = self._model.transition(tasks=self._level != "plan", weighed=facts, labels=labels)
        found = explore(transition, length, self._report)
        return Completions(weigh(found.automaton, found.labels, transition, weights))

    def _report(self, depth: int, states: int, nbytes: int) -> None:
        if self._progress:
            self._progress(f"depth {depth}: {states:,} states")
