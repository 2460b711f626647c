"""The automaton engine, which explores the states once, then counts, ranks and samples by dynamic programming."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from fractions import Fraction
from functools import cached_property
from math import lcm
from time import monotonic
from typing import TYPE_CHECKING

from prag_asp.logic.domain_logic import DomainLogic
from prag_asp.output.cache_files import cache_folder
from prag_asp.processes.progress_events import stage
from prag_asp.program.entity_names import action_name
from prag_asp.space.automaton.automaton import NO_PATHS, Ranking
from prag_asp.space.automaton.bounded_count import count_within
from prag_asp.space.automaton.recurrence import count_by_recurrence
from prag_asp.space.engines.engine import Letters, Level, Progress, prefix_sets
from prag_asp.space.engines.independent_components import IndependentParts
from prag_asp.space.engines.reachability import FORECAST, HALT, Explorer, Forecast, Halt, Reach, TooManyStates
from prag_asp.space.limits import UNLIMITED, LimitClock, Limits, limit_error
from prag_asp.space.weights.weights import Weighed, Weights, edge_weights, refuse_weights

if TYPE_CHECKING:
    from prag_asp.logic.step.transition import Transition
    from prag_asp.space.automaton.merged_states import MergedRanking
    from prag_asp.space.automaton.shuffle_product import ShuffledWords

WORTH_KEEPING = 0.2
"""Minimum time of an exploration, in seconds, for its result to be cached for the next run."""

RANKED = 8
"""Number of lengths for which rankings are cached."""

LONG = 10_000
"""Minimum length at which counting reports its progress."""


class AutomatonEngine:
    """An engine that explores the automaton of one domain at one level and keeps it between queries.

    `merge` determines whether states are merged up to renaming of interchangeable entities; with None, this depends on
    the number of states. Results are the same either way. `explorer` finds the states; by default, it lists them. If
    `hopeless` forecasts that the states will not fit into memory, queries raise `TooManyStates`.

    Raises:
        EngineError: the step is not a function of the state and the action.
    """

    def __init__(
        self,
        model: DomainLogic,
        level: Level,
        progress: Progress | None = None,
        limits: Limits = UNLIMITED,
        *,
        merge: bool | None = None,
        explorer: Explorer | None = None,
        hopeless: Forecast | None = None,
    ) -> None:
        self._model = model
        self._level = level
        self._limits = limits
        self._tell = progress or (lambda words: None)
        self._explorer: Explorer = explorer or Explorer(model, level, progress, merge, hopeless)
        lists = self._explorer.merge is False
        self._plain = self._explorer if lists else Explorer(model, level, progress, merge=False)
        folder = cache_folder() if limits.cached and explorer is None else None
        self._slot = None
        if folder is not None:
            from prag_asp.space.engines.stored_automata import automaton_slot

            self._slot = automaton_slot(folder, model, level, merge)
        self._reached: Reach | None = self._slot.read() if self._slot else None
        self._ranked: dict[int, Ranking | MergedRanking | ShuffledWords] = {}
        self._parts = IndependentParts(self._explorer, lambda: self._transition, self._tell)
        self._weighed: tuple[tuple[int, Weights, bool, bool], Weighed] | None = None
        begun = monotonic()
        if self._reached is None:
            self._transition  # noqa: B018  raises EngineError early
        self._prepared = monotonic() - begun

    @cached_property
    def _transition(self) -> Transition:
        return self._explorer.transition()

    @cached_property
    def letters(self) -> tuple[str, ...]:
        """The texts of the letters, in order."""
        if self._reached is not None:
            return self._reached.letters
        if self._level == "skeleton":
            return tuple(sorted(set(self._names)))
        return tuple(map(str, self._transition.actions))

    @cached_property
    def _names(self) -> tuple[str, ...]:
        """The action name of each letter."""
        if self._reached is not None:
            return self._reached.names
        return tuple(map(action_name, self._transition.actions))

    @cached_property
    def _numbers(self) -> dict[str, int]:
        return {letter: number for number, letter in enumerate(self.letters)}

    def count(self, length: int, prefix: Letters = ()) -> int:
        """Return the number of words of a given length.

        Raises:
            LimitReached: a limit ended the exploration; the error gives the number of words counted so far.
        """
        clock = self._limits.begin()
        reach = self._reach(length, clock, self._parts.spreads if prefix else self._parts.falls_apart)
        if reach.stop == HALT:
            if prefix:
                shuffled = self._parts.words(length, self._numbers, clock)
                if shuffled:
                    return shuffled.count(self._sets(prefix))
            elif (apart := self._parts.count(length, clock)) is not None:
                if not apart.stop:
                    return apart.found
                least = apart.found
                if self._level != "skeleton":  # the partial exploration contains plans
                    least = max(least, count_within(reach.completions, length, clock.to_close().reached_limit)[0])
                raise limit_error(apart.stop, least, self._level, length, apart.states)
            reach = self._reach(length, clock)
        stage("counting")
        if not prefix and not reach.stop and reach.completions.automaton.horizon is None:
            number = count_by_recurrence(reach.completions, length, clock.reached_limit)
            if number is not None:
                return number
        if prefix or (self._limits.seconds is None and length < LONG):
            counted, stop = reach.count(length, self._sets(prefix)), reach.stop
        else:
            counted, stop = count_within(reach.completions, length, clock.to_close().reached_limit, self._tell)
        reason = reach.stop or stop
        if reason:
            raise limit_error(reason, counted, self._level, length, reach.states)
        return counted

    def following(self, length: int, prefix: Letters = ()) -> dict[str, int]:
        """Return, for each letter that can follow `prefix`, the number of words that continue with it."""
        reach, sets = self.known(length), self._sets(prefix)
        found = reach.following(length, sets) if isinstance(reach, Reach) else reach.following(sets)
        return {self.letters[letter]: number for letter, number in found.items()}

    def words(self, length: int, prefix: Letters = ()) -> Iterator[Letters]:
        """Yield the words of a given length in order, lazily."""
        reach, sets = self.known(length), self._sets(prefix)
        for word in reach.words(length, sets) if isinstance(reach, Reach) else reach.words(sets):
            yield self._spell(word)

    def contains(self, word: Letters) -> bool:
        """Return whether a word belongs to the level."""
        if not all(letter in self._numbers for letter in word):
            return False
        reach = self.known(len(word))
        numbers = [self._numbers[letter] for letter in word]
        return reach.contains(numbers) if isinstance(reach, Reach) else reach.rank(numbers) is not None

    def unrank(self, length: int, rank: int) -> Letters:
        """Return the word with a given rank, from 0 to count - 1."""
        return self._spell(self._ranking(length).unrank(rank))

    def rank(self, word: Letters) -> int | None:
        """Return the rank of a word among the words of its length, or None if it is not a word."""
        if not all(letter in self._numbers for letter in word):
            return None
        return self._ranking(len(word)).rank([self._numbers[letter] for letter in word])

    def weighed(self, length: int, weights: Weights, *, goals: bool = False, plain: bool = False) -> Weighed:
        """Return the weighted words of a given length, and cache the latest result."""
        refuse_weights(self._level, weights, self._model, length)
        stage("weighing")
        key = (length, weights, goals, plain)
        if self._weighed is None or self._weighed[0] != key:
            self._weighed = (key, self._weigh(length, weights, goals, plain))
        return self._weighed[1]

    def _spell(self, word: Sequence[int]) -> Letters:
        return tuple(self.letters[letter] for letter in word)

    def _sets(self, prefix: Letters) -> list[frozenset[int]]:
        return prefix_sets(prefix, self._numbers, () if self._level == "skeleton" else self._names)

    def _reach(self, length: int, clock: LimitClock, halt: Halt | None = None) -> Reach:
        """Return the exploration for a given length, and keep it if it is complete."""
        if self._reached is not None and self._reached.covers(length):
            return self._reached
        begun = monotonic()
        stage("exploring")
        reach = self._explorer.reach(self._transition, length, clock, halt)
        if reach.stop == FORECAST and halt and self._parts.finds:
            return replace(reach, stop=HALT)
        if reach.stop == FORECAST:
            raise TooManyStates(reach)
        if reach.covers(length):
            self._reached = reach
            if self._slot and self._prepared + monotonic() - begun > WORTH_KEEPING:
                self._slot.write(reach)
        return reach

    def known(self, length: int) -> Reach | ShuffledWords:
        """Return the complete exploration for a length, or its words as shuffles of the words of independent parts.

        Raises:
            LimitReached: a limit ended the exploration.
        """
        clock = self._limits.begin()
        halted = self._parts.has_words(length) or self._reach(length, clock, self._parts.spreads).stop == HALT
        shuffled = self._parts.words(length, self._numbers, clock) if halted else None
        return shuffled or self.explored(length, clock)

    def explored(self, length: int, clock: LimitClock | None = None) -> Reach:
        """Return the complete exploration for a given length.

        Raises:
            LimitReached: a limit ended the exploration.
        """
        clock = clock or self._limits.begin()
        reach = self._reach(length, clock)
        if reach.stop:
            counted, _ = count_within(reach.completions, length, clock.to_close().reached_limit)
            raise limit_error(reach.stop, counted, self._level, length, reach.states)
        return reach

    def _ranking(self, length: int) -> Ranking | MergedRanking | ShuffledWords:
        """Return the ranking for a given length; the latest rankings are cached because lengths may alternate."""
        if length not in self._ranked:
            reach = self.known(length)
            stage("ranking")
            while len(self._ranked) >= RANKED:
                del self._ranked[next(iter(self._ranked))]
            if isinstance(reach, Reach):
                self._ranked[length] = reach.merged_ranking(length) or Ranking(reach.completions, length)
            else:
                self._ranked[length] = reach
        return self._ranked[length]

    def _weigh(self, length: int, weights: Weights, goals: bool, plain: bool) -> Weighed:
        from prag_asp.logic.step.hindsight import Hindsight, numbered_goals

        hindsight = Hindsight(self._model.step, self._model.domain.facts.fluents) if goals else None
        read = hindsight.last_read if hindsight else ()
        explorer = self._plain if plain or goals else self._explorer
        if not weights and not goals and not plain:
            words = self.known(length)
            if not isinstance(words, Reach):
                return Weighed(NO_PATHS, ranking=words)
            return Weighed(words.completions, ranking=words.merged_ranking(length))
        if not weights and not goals:
            whole = self.explored(length)
            if not whole.merged:
                return Weighed(whole.completions)
        clock = self._limits.begin()
        divides = weights.of_actions_alone and not (plain or goals)
        apart = self._weigh_apart(length, weights, clock) if divides and self._parts.has_words(length) else None
        if apart:
            return apart
        reach, unit, marks = explorer.weighed(length, weights, clock, read, self._parts.spreads if divides else None)
        if divides and reach.stop in {HALT, FORECAST} and self._parts.finds:
            apart = self._weigh_apart(length, weights, clock)
            if apart:
                return apart
            reach, unit, marks = explorer.weighed(length, weights, clock, read)
        if reach.stop == FORECAST:
            raise TooManyStates(reach)
        if reach.stop:
            raise limit_error(reach.stop, 0, self._level, length, reach.states)
        ends, values = numbered_goals(hindsight, marks) if hindsight else (None, None)
        return Weighed(reach.completions, unit**length, ends, reach.merged_ranking(length), values)

    def _weigh_apart(self, length: int, weights: Weights, clock: LimitClock) -> Weighed | None:
        """Return the words, weighted by action, as shuffles of words of independent parts, or None without parts."""
        words = self._parts.words(length, self._numbers, clock)
        if words is None:
            return None
        by_letter, _ = edge_weights(self._transition.actions, weights)
        scale = lcm(*(weight.denominator for weight in by_letter))
        whole = [int(weight * scale) for weight in by_letter]
        return Weighed(NO_PATHS, Fraction(1, scale**length), ranking=words.weighing(whole))
