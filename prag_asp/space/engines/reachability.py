"""The automaton of one level of a domain, explored completely or up to a limit, with or without merged states."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from math import factorial, prod
from typing import TYPE_CHECKING
from weakref import WeakKeyDictionary

import clingo
import numpy as np
from numpy.typing import NDArray

from prag_asp.logic.domain_logic import DomainLogic
from prag_asp.logic.step.packed import Rows
from prag_asp.logic.symmetry.symmetries import Unit
from prag_asp.processes.progress_events import stage
from prag_asp.program.entity_names import action_name, mentioned_entities
from prag_asp.space.automaton.automaton import (
    Automaton,
    Completions,
    Word,
    accepts,
    count_following,
    count_words,
    words,
)
from prag_asp.space.automaton.exploration import Exploration, Extent, Watch, explore
from prag_asp.space.automaton.outlook import Outlook
from prag_asp.space.automaton.skeletons import skeleton_automaton
from prag_asp.space.limits import LimitClock
from prag_asp.space.weights.weights import Weights, weigh, weighing_facts
from prag_asp.stop_reason import StopKind, StopReason

if TYPE_CHECKING:
    from prag_asp.logic.step.transition import Transition
    from prag_asp.logic.symmetry.canonical_states import Merging
    from prag_asp.space.automaton.merged_states import MergedAutomaton, MergedRanking
    from prag_asp.space.engines.engine import Level

PATIENCE, WORDS, LARGE = 250_000, 4, 100
"""Number of edges above which states are merged, the number of 64-bit words per state for which it is meant, and the
minimum number of renamings."""

FEW_STATES, FEW_EDGES = 4096, 50_000
"""Maximum numbers of states and edges of an exploration that levels share."""

MORE_PATIENCE = 5_000_000
"""Number of edges above which states with fewer renamings are merged; plain arrays are faster as long as they fit."""

SIZE, HALT, FORECAST = StopReason(StopKind.SIZE), StopReason(StopKind.HALT), StopReason(StopKind.FORECAST)
"""Reasons other than limits that end an exploration."""

Halt = Callable[[Extent], bool]
"""A function that returns whether to stop an exploration of a given extent."""

Forecast = Callable[[Extent, int], bool]
"""A function that returns whether an exploration of a given extent is forecast to exceed the memory within a length."""

Allow = Callable[[Rows], NDArray[np.bool_]]
"""A function that returns, for each state, whether the state is allowed; any other state halts the exploration."""

Groups = Sequence[Sequence[Unit]]


@dataclass(frozen=True)
class Reach:
    """The known words of a level.

    `letters` are the texts of the letters and `names` the names of their actions. If states were merged, `merged` finds
    words, ranks and counts. `stop` is the reason why exploration ended early, or None if it is complete up to the
    automaton's horizon. With `sets`, the automaton's states are sets of states of the domain.
    """

    letters: tuple[str, ...]
    names: tuple[str, ...]
    completions: Completions
    merged: MergedAutomaton | None = None
    stop: StopReason | None = None
    sets: bool = False

    @classmethod
    def of_merged(
        cls, letters: tuple[str, ...], names: tuple[str, ...], merged: MergedAutomaton, stop: StopReason | None = None
    ) -> Reach:
        """Return the words of an automaton with merged states."""
        return cls(letters, names, Completions(merged.automaton), merged, stop)

    @property
    def states(self) -> int:
        """The number of listed states of the domain."""
        return 0 if self.sets else self.completions.automaton.states

    def covers(self, length: int) -> bool:
        """Return whether all words of a given length are known."""
        horizon = self.completions.automaton.horizon
        return not self.stop and (horizon is None or horizon >= length)

    def count(self, length: int, prefix: Sequence[frozenset[int]]) -> int:
        """Return the total weight of the words of a given length whose first letters `prefix` allows."""
        if not self.merged:
            return count_words(self.completions, length, [allowed.__contains__ for allowed in prefix])
        from prag_asp.space.automaton.merged_states import count_merged

        return count_merged(self.merged, self.completions, length, prefix)

    def following(self, length: int, prefix: Sequence[frozenset[int]]) -> dict[int, int]:
        """Return, for each letter that can follow `prefix`, the total weight of the words that continue with it."""
        if not self.merged:
            return count_following(self.completions, length, [allowed.__contains__ for allowed in prefix])
        from prag_asp.space.automaton.merged_states import count_following_merged

        return count_following_merged(self.merged, self.completions, length, prefix)

    def words(self, length: int, prefix: Sequence[frozenset[int]]) -> Iterator[Word]:
        """Yield the words of a given length whose first letters `prefix` allows, in order, lazily."""
        if not self.merged:
            return words(self.completions, length, [allowed.__contains__ for allowed in prefix])
        from prag_asp.space.automaton.merged_states import merged_words

        return merged_words(self.merged, self.completions, length, prefix)

    def contains(self, word: Sequence[int]) -> bool:
        """Return whether a word is known."""
        if not self.merged:
            return accepts(self.completions.automaton, word)
        from prag_asp.space.automaton.merged_states import accepts_merged

        return accepts_merged(self.merged, word)

    def merged_ranking(self, length: int) -> MergedRanking | None:
        """Return the ranking of the words of a given length if states were merged."""
        if not self.merged:
            return None
        from prag_asp.space.automaton.merged_states import MergedRanking

        return MergedRanking(self.merged, self.completions, length)


class TooManyStates(Exception):
    """Exploration would exceed the memory limit; `reach` is the partial result."""

    def __init__(self, reach: Reach) -> None:
        super().__init__(StopKind.FORECAST.value)
        self.reach = reach


@dataclass(frozen=True)
class Explorer:
    """The exploration of one level of a domain; if `merge` is None, whether states are merged depends on their number.

    Once the decision to merge is made, exploration stops if `hopeless` forecasts too many states.
    """

    model: DomainLogic
    level: Level
    tell: Callable[[str], None] | None = None
    merge: bool | None = None
    hopeless: Forecast | None = None

    def transition(self, weights: Weights | None = None, read: Sequence[clingo.Symbol] = ()) -> Transition:
        """Return the step function to explore; its labels are those of the weights, followed by the atoms in `read`.

        Skeletons need no canonical names because a skeleton has a plan if and only if it has a task.

        Raises:
            EngineError: the step is not a function of the state and the action.
        """
        facts, labels = weighing_facts(weights or Weights())
        return self.model.transition(tasks=self.level == "task", weighed=facts, labels=(*labels, *read))

    def reach(
        self,
        transition: Transition,
        length: int,
        clock: LimitClock,
        halt: Halt | None = None,
        allow: Allow | None = None,
    ) -> Reach:
        """Return the words of up to `length` steps, as far as the limits, `halt` and `allow` permit."""
        explored, merging = self._explore(transition, length, clock, Weights(), halt, allow)
        names = tuple(map(action_name, transition.actions))
        if self.level == "skeleton" and explored.stop not in {HALT, FORECAST}:
            stage("merging plans with the same skeleton")
            letters = tuple(sorted(set(names)))
            numbers = np.array([letters.index(name) for name in names], dtype=np.int64)
            automaton, stop = skeleton_automaton(explored.automaton, numbers, clock.reached_limit)
            return Reach(letters, letters, Completions(automaton), None, explored.stop or stop)
        return _known(transition, explored, merging, explored.automaton)

    def weighed(
        self,
        length: int,
        weights: Weights,
        clock: LimitClock,
        read: Sequence[clingo.Symbol] = (),
        halt: Halt | None = None,
    ) -> tuple[Reach, Fraction, NDArray[np.bool_]]:
        """Return the words with integer edge weights, their unit, and the truth values of `read` after each edge.

        The truth values have shape (edges, atoms in `read`).
        """
        transition = self.transition(weights, read)
        explored, merging = self._explore(transition, length, clock, weights, halt)
        own = explored.labels.shape[1] - len(read)
        automaton, scale = explored.automaton, 1
        if weights and explored.stop not in {HALT, FORECAST}:
            automaton, scale = weigh(automaton, explored.labels[:, :own], transition.actions, weights)
        return _known(transition, explored, merging, automaton), Fraction(1, scale), explored.labels[:, own:]

    def _explore(
        self,
        transition: Transition,
        length: int,
        clock: LimitClock,
        weights: Weights,
        halt: Halt | None = None,
        allow: Allow | None = None,
    ) -> tuple[Exploration, Merging | None]:
        if self.merge:
            merging = self._merging(transition, weights)
            return explore(transition, length, self._watch(transition, length, clock), merging=merging), merging
        object_to = (lambda rows: None if allow(rows).all() else HALT) if allow else None
        shared = None if allow else self._shared_exploration(transition, length, clock, halt)
        if shared is not None:
            return shared, None
        width = transition.initial.shape[1]
        patience = None if self.merge is False else PATIENCE // max(width // WORDS, 1)
        explored = explore(
            transition, length, self._watch(transition, length, clock, patience, halt), object_to=object_to
        )
        if explored.stop == SIZE:
            merging = self._merging(transition, weights)
            if merging is not None and prod(factorial(len(group)) for group in merging.groups) < LARGE:
                explored = explore(
                    transition, length, self._watch(transition, length, clock, MORE_PATIENCE, halt), object_to=object_to
                )
                if explored.stop != SIZE:
                    return explored, None
            return explore(
                transition,
                length,
                self._watch(transition, length, clock, halt=halt),
                merging=merging,
                object_to=object_to,
            ), merging
        if not explored.stop and explored.automaton.states <= FEW_STATES and len(explored.labels) <= FEW_EDGES:
            _small[transition] = explored
        return explored, None

    def _shared_exploration(
        self, transition: Transition, length: int, clock: LimitClock, halt: Halt | None
    ) -> Exploration | None:
        """Return a small exploration of the same step function by the engine of another level, or None.

        With limits or progress reports, the exploration is repeated.
        """
        limits, explored = clock.limits, _small.get(transition)
        if explored is None or self.tell or (limits.seconds, limits.memory_bytes) != (None, None):
            return None
        if halt and halt(Extent(length, explored.automaton.states, len(explored.labels), 0)):
            return None
        return explored if explored.automaton.horizon in (None, length) else None

    def _merging(self, transition: Transition, weights: Weights) -> Merging | None:
        from prag_asp.logic.symmetry.canonical_states import find_merging

        symmetries = self.model.symmetries(0)
        groups = _present(equal_groups(symmetries.innermost, weights), transition)
        return find_merging(transition, groups, symmetries if self.level == "task" else None)

    def _watch(
        self,
        transition: Transition,
        length: int,
        clock: LimitClock,
        patience: int | None = None,
        halt: Halt | None = None,
    ) -> Watch:
        """Return the callback that reports progress and decides whether to stop.

        It stops at a limit, at `patience` edges, or if `halt` returns true.
        """
        names = [action_name(action) for action in transition.actions] if self.tell else []
        outlook = Outlook(self.tell, names, length, transition.initial.shape[1]) if self.tell else None

        def watch(extent: Extent) -> StopReason | None:
            if self.tell:
                memory = f"{extent.nbytes / 10**6:,.0f} MB"
                self.tell(f"depth {extent.depth}: {extent.states:,} states, {extent.edges:,} edges, {memory}")
            if outlook:
                outlook.watch(extent)
            if halt and halt(extent):
                return HALT
            if patience is None and self.hopeless and self.hopeless(extent, length):
                return FORECAST
            outgrown = patience is not None and extent.edges > patience
            return SIZE if outgrown else clock.reached_limit(extent.nbytes // 2)

        return watch


_small: WeakKeyDictionary[Transition, Exploration] = WeakKeyDictionary()
"""The latest small exploration of each step function that still exists."""


def _known(transition: Transition, explored: Exploration, merging: Merging | None, automaton: Automaton) -> Reach:
    """Return the words of an exploration with the weights of `automaton`."""
    letters, names = tuple(map(str, transition.actions)), tuple(map(action_name, transition.actions))
    if merging is None or explored.renamings is None:
        return Reach(letters, names, Completions(automaton), None, explored.stop)
    from prag_asp.space.automaton.merged_states import MergedAutomaton

    base = explored.automaton
    merged = MergedAutomaton(base, explored.renamings, merging.actions, merging.groups, automaton.weights)
    return Reach.of_merged(letters, names, merged, explored.stop)


def _present(groups: Groups, transition: Transition) -> list[Sequence[Unit]]:
    """Return the groups whose units all occur in the same way in a step function.

    The step function of an independent part may lack some units.
    """
    entities = {entity for group in groups for unit in group for entity in unit}
    present = {entity for symbol in (*transition.actions, *transition.variables)
               for entity in mentioned_entities(symbol, entities)}  # fmt: skip
    patterns = ({tuple(entity in present for entity in unit) for unit in group} for group in groups)
    return [group for group, kinds in zip(groups, patterns, strict=True) if len(kinds) == 1 and any(*kinds)]


def equal_groups(groups: Groups, weights: Weights) -> list[tuple[Unit, ...]]:
    """Return the groups of units that neither the domain nor the weights distinguish."""
    entities = {entity for group in groups for unit in group for entity in unit}
    single = {entity for action in weights.actions for entity in mentioned_entities(action, entities)}
    equal: list[tuple[Unit, ...]] = []
    for group in groups:
        by_weight: dict[object, list[Unit]] = {}
        for unit in group:
            if single.isdisjoint(unit):
                by_weight.setdefault(tuple(map(weights.entities.get, unit)), []).append(unit)
        equal += [tuple(members) for members in by_weight.values() if len(members) > 1]
    return equal
