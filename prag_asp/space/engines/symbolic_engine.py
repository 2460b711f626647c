"""The symbolic engine: decision diagrams over the states, for spaces whose states do not fit into memory."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import suppress
from fractions import Fraction
from math import lcm, prod

from prag_asp.errors import LimitReached
from prag_asp.logic.domain_logic import DomainLogic
from prag_asp.processes.progress_events import stage
from prag_asp.program.entity_names import action_name
from prag_asp.space.automaton.automaton import NO_PATHS
from prag_asp.space.automaton.layers import LayeredWords, Layers, count_along
from prag_asp.space.engines.automaton_engine import AutomatonEngine
from prag_asp.space.engines.engine import Engine, Letters, Level, Progress, prefix_sets
from prag_asp.space.engines.reachability import Explorer
from prag_asp.space.engines.set_explorer import SetExplorer
from prag_asp.space.limits import UNLIMITED, Limits, limit_error
from prag_asp.space.weights.weights import Weighed, Weights, edge_weights, refuse_weights, weighing_facts


def symbolic_engine(
    model: DomainLogic, level: Level, progress: Progress | None = None, limits: Limits = UNLIMITED
) -> Engine:
    """Return the symbolic engine of one domain at one level, which caches its computations between queries.

    Skeletons are the words of an automaton whose states are sets of states of the domain. Each set is a diagram, and
    usually few sets are reached.

    Raises:
        EngineError: the step is not a function of the state and the action.
    """
    if level == "skeleton":
        return AutomatonEngine(model, level, progress, limits, explorer=SetExplorer(model, level, progress))
    return SymbolicEngine(model, level, progress, limits)


class SymbolicEngine:
    """The engine for plans or tasks, each of which is one path of states."""

    def __init__(
        self, model: DomainLogic, level: Level, progress: Progress | None = None, limits: Limits = UNLIMITED
    ) -> None:
        self._model = model
        self._level = level
        self._limits = limits
        self._tell = progress or (lambda words: None)
        self._transition = Explorer(model, level).transition()
        self.letters = tuple(map(str, self._transition.actions))
        self._numbers = {letter: number for number, letter in enumerate(self.letters)}
        self._clock, self._length = limits.begin(), 0
        self._layers: Layers | None = None
        self._weighed: tuple[tuple[int, Weights], Weighed] | None = None
        self._listed: AutomatonEngine | None = None

    def count(self, length: int, prefix: Letters = ()) -> int:
        """Return the number of words of a given length.

        Raises:
            LimitReached: a limit ended the count; the error gives the number of words counted so far.
        """
        try:
            return self._words(length, prefix).total
        except LimitReached as reached:
            least = 0
            if self._layers is not None and len(prefix) <= length:
                self._clock = self._clock.to_report()
                with suppress(LimitReached):
                    least = count_along(self._layers, length, self._sets(prefix), self._clock.reached_limit)
            raise limit_error(reached.reason, least, self._level, length) from None

    def following(self, length: int, prefix: Letters = ()) -> dict[str, int]:
        """Return, for each letter that can follow `prefix`, the number of words that continue with it."""
        found = self._words(length, prefix).following()
        return {self.letters[letter]: number for letter, number in found.items()}

    def words(self, length: int, prefix: Letters = ()) -> Iterator[Letters]:
        """Yield the words of a given length in order, lazily."""
        for word in self._words(length, prefix):
            yield tuple(self.letters[letter] for letter in word)

    def contains(self, word: Letters) -> bool:
        """Return whether a word belongs to the level."""
        return self.rank(word) is not None

    def unrank(self, length: int, rank: int) -> Letters:
        """Return the word with a given rank, from 0 to count - 1."""
        return tuple(self.letters[letter] for letter in self._words(length).unrank(rank))

    def rank(self, word: Letters) -> int | None:
        """Return the rank of a word among the words of its length, or None if it is not a word."""
        if not all(letter in self._numbers for letter in word):
            return None
        return self._words(len(word)).rank([self._numbers[letter] for letter in word])

    def weighed(self, length: int, weights: Weights, *, goals: bool = False, plain: bool = False) -> Weighed:
        """Return the weighted words of a given length, and cache the latest result.

        With `goals` or `plain`, each path is one word, so the states have to be listed, within the same limits.
        """
        refuse_weights(self._level, weights, self._model, length)
        if goals or plain:
            if self._listed is None:
                self._tell("listing states, because each path is one word")
                self._listed = AutomatonEngine(self._model, self._level, self._tell, self._limits)
            return self._listed.weighed(length, weights, goals=goals, plain=plain)
        if self._weighed is None or self._weighed[0] != (length, weights):
            stage("weighing")
            words = self._weighed_words(length, weights) if weights else Weighed(NO_PATHS, ranking=self._words(length))
            self._weighed = ((length, weights), words)
        return self._weighed[1]

    def _weighed_words(self, length: int, weights: Weights) -> Weighed:
        facts, labels = weighing_facts(weights)
        transition = self._model.transition(tasks=self._level == "task", weighed=facts, labels=labels)
        by_letter, by_label = edge_weights(transition.actions, weights)
        scale = prod(
            (weight.denominator for weight in by_label), start=lcm(*(weight.denominator for weight in by_letter))
        )

        def weigh(letter: int, true: tuple[int, ...]) -> int:
            return int(prod((by_label[label] for label in true), start=by_letter[letter] * scale))

        self._begin(length)
        layers = Layers(transition, self._look, self._tell, weigh)
        return Weighed(NO_PATHS, Fraction(1, scale**length), ranking=LayeredWords(layers, length))

    def _words(self, length: int, prefix: Letters = ()) -> LayeredWords:
        self._begin(length)
        if self._layers is None:
            self._layers = Layers(self._transition, self._look, self._tell)
        return LayeredWords(self._layers, length, self._sets(prefix))

    def _begin(self, length: int) -> None:
        stage("exploring")
        self._clock, self._length = self._limits.begin(), length

    def _look(self) -> None:
        stop = self._clock.reached_limit()
        if stop:
            raise limit_error(stop, 0, self._level, self._length)

    def _sets(self, prefix: Letters) -> list[frozenset[int]]:
        return prefix_sets(prefix, self._numbers, list(map(action_name, self._transition.actions)))
