"""The automaton of one level of a domain: whole or up to a limit, with or without merged states."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import partial
from math import factorial, prod
from typing import TYPE_CHECKING
from weakref import WeakKeyDictionary

import clingo
import numpy as np
from numpy.typing import NDArray

from prag_asp.logic.domain_logic import DomainLogic
from prag_asp.logic.step.packed import Rows
from prag_asp.logic.step.transition import Transition
from prag_asp.logic.symmetry.symmetries import Unit
from prag_asp.processes.progress_events import stage
from prag_asp.program.entity_names import action_name, mentioned_entities
from prag_asp.space.automaton.automaton import Automaton, Completions
from prag_asp.space.automaton.exploration import Exploration, Extent, Watch, explore
from prag_asp.space.automaton.skeletons import skeleton_automaton
from prag_asp.space.limits import Budget
from prag_asp.space.weights.weights import Weights, weigh, weighing_facts
from prag_asp.stop_reason import StopKind, StopReason

if TYPE_CHECKING:
    from prag_asp.logic.symmetry.canonical_states import Merging
    from prag_asp.space.automaton.merged_states import MergedAutomaton
    from prag_asp.space.engines.engine import Level

PATIENCE, WORDS, LARGE = 250_000, 4, 100
"""Edges beyond which states are merged, 64-bit words of a state up to which that holds, and the least number of
renamings for it."""

FEW_STATES, FEW_EDGES = 4096, 50_000
"""States and edges up to which all levels share what was explored."""

MORE_PATIENCE = 5_000_000
"""Edges beyond which states with fewer renamings are merged; plain arrays are faster as long as they fit."""

SIZE, HALT, FORECAST = StopReason(StopKind.SIZE), StopReason(StopKind.HALT), StopReason(StopKind.FORECAST)
"""Why exploration ended where no limit did."""

Halt = Callable[[Extent], bool]
"""Returns, for the extent of an exploration, whether to stop it."""

Forecast = Callable[[Extent, int], bool]
"""Returns, for the extent of an exploration and the length, whether it is forecast to exceed the memory."""

Allow = Callable[[Rows], NDArray[np.bool_]]
"""Returns for each state whether exploration may go on; one that forbids it halts the exploration."""

Groups = Sequence[Sequence[Unit]]


@dataclass(frozen=True)
class Reach:
    """The known words of a level.

    `letters` are the texts of the letters and `names` those of their actions' names. `merged` is what walks along words
    where states were merged; `stop` says what ended the exploration, and is None where nothing is
    missing up to the automaton's horizon. With `sets`, the automaton's states are sets of the domain's.
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
        """Return what is known where states were merged."""
        return cls(letters, names, Completions(merged.automaton), merged, stop)

    @property
    def states(self) -> int:
        """The number of the domain's states that are listed."""
        return 0 if self.sets else self.completions.automaton.states

    def covers(self, length: int) -> bool:
        """Return whether all words of a length are known."""
        horizon = self.completions.automaton.horizon
        return not self.stop and (horizon is None or horizon >= length)


class TooManyStates(Exception):
    """Exploration would exceed the memory limit; `reach` is what was found until then."""

    def __init__(self, reach: Reach) -> None:
        super().__init__(StopKind.FORECAST.value)
        self.reach = reach


@dataclass(frozen=True)
class Explorer:
    """Explores one level of a domain; `merge` says whether states are merged, or is None to let their number decide.

    Exploration stops if `hopeless` forecasts too many states, once it is decided whether states are merged.
    """

    model: DomainLogic
    level: Level
    tell: Callable[[str], None] | None = None
    merge: bool | None = None
    hopeless: Forecast | None = None

    def transition(self, weights: Weights | None = None, read: Sequence[clingo.Symbol] = ()) -> Transition:
        """Return the step function that is explored; its labels are those of the weights, then the atoms `read`.

        A skeleton has a plan wherever it has a task, so that skeletons need no canonical names.

        Raises:
            EngineError: the step is not a function of the state and the action.
        """
        facts, labels = weighing_facts(weights or Weights())
        return self.model.transition(tasks=self.level == "task", weighed=facts, labels=(*labels, *read))

    def reach(
        self,
        transition: Transition,
        length: int,
        budget: Budget,
        halt: Halt | None = None,
        allow: Allow | None = None,
    ) -> Reach:
        """Return what is reached within `length` steps, or until a limit is reached or `halt` or `allow` stops it."""
        explored, merging = self._explore(transition, length, budget, Weights(), halt, allow)
        names = tuple(map(action_name, transition.actions))
        if self.level == "skeleton" and explored.stop not in {HALT, FORECAST}:
            stage("merging plans of one skeleton")
            letters = tuple(sorted(set(names)))
            numbers = np.array([letters.index(name) for name in names], dtype=np.int64)
            automaton, stop = skeleton_automaton(explored.automaton, numbers, budget.reached_limit)
            return Reach(letters, letters, Completions(automaton), None, explored.stop or stop)
        return _known(transition, explored, merging, explored.automaton)

    def weighed(
        self,
        length: int,
        weights: Weights,
        budget: Budget,
        read: Sequence[clingo.Symbol] = (),
        halt: Halt | None = None,
    ) -> tuple[Reach, Fraction, NDArray[np.bool_]]:
        """Return the same with a whole number on each edge, what 1 stands for, and the truth of `read` after each edge.

        The latter has shape (edges, atoms read).
        """
        transition = self.transition(weights, read)
        explored, merging = self._explore(transition, length, budget, weights, halt)
        own = explored.labels.shape[1] - len(read)
        automaton, scale = explored.automaton, 1
        if weights and explored.stop not in {HALT, FORECAST}:
            automaton, scale = weigh(automaton, explored.labels[:, :own], transition.actions, weights)
        return _known(transition, explored, merging, automaton), Fraction(1, scale), explored.labels[:, own:]

    def _explore(
        self,
        transition: Transition,
        length: int,
        budget: Budget,
        weights: Weights,
        halt: Halt | None = None,
        allow: Allow | None = None,
    ) -> tuple[Exploration, Merging | None]:
        if self.merge:
            merging = self._merging(transition, weights)
            return explore(transition, length, self._watch(length, budget), merging=merging), merging
        object_to = partial(_objection, allow) if allow else None
        known = None if allow else self._known_to_others(transition, length, budget, halt)
        if known is not None:
            return known, None
        words = transition.initial.shape[1]
        patience = None if self.merge is False else PATIENCE // max(words // WORDS, 1)
        explored = explore(transition, length, self._watch(length, budget, patience, halt), object_to=object_to)
        if explored.stop == SIZE:
            merging = self._merging(transition, weights)
            if merging is not None and prod(factorial(len(group)) for group in merging.groups) < LARGE:
                explored = explore(
                    transition, length, self._watch(length, budget, MORE_PATIENCE, halt), object_to=object_to
                )
                if explored.stop != SIZE:
                    return explored, None
            return explore(
                transition, length, self._watch(length, budget, halt=halt), merging=merging, object_to=object_to
            ), merging
        if not explored.stop and explored.automaton.states <= FEW_STATES and len(explored.labels) <= FEW_EDGES:
            _small[transition] = explored
        return explored, None

    def _known_to_others(
        self, transition: Transition, length: int, budget: Budget, halt: Halt | None
    ) -> Exploration | None:
        """Return the exploration of an engine of another level, if it is small and this one would find the same.

        With limits, or where progress is reported, the exploration is done again.
        """
        limits, known = budget.limits, _small.get(transition)
        if known is None or self.tell or (limits.seconds, limits.memory_bytes) != (None, None):
            return None
        if halt and halt(Extent(length, known.automaton.states, len(known.labels), 0)):
            return None
        return known if known.automaton.horizon in (None, length) else None

    def _merging(self, transition: Transition, weights: Weights) -> Merging | None:
        from prag_asp.logic.symmetry.canonical_states import find_merging

        found = self.model.symmetries(0)
        groups = _present(equal_groups(found.innermost, weights), transition)
        return find_merging(transition, groups, found if self.level == "task" else None)

    def _watch(self, length: int, budget: Budget, patience: int | None = None, halt: Halt | None = None) -> Watch:
        """Return what tells of progress, and says when to stop: by the budget, `patience` with the edges, or `halt`."""

        def watch(extent: Extent) -> StopReason | None:
            if self.tell:
                memory = f"{extent.nbytes / 10**6:,.0f} MB"
                self.tell(f"depth {extent.depth}: {extent.states:,} states, {extent.edges:,} edges, {memory}")
            if halt and halt(extent):
                return HALT
            if patience is None and self.hopeless and self.hopeless(extent, length):
                return FORECAST
            outgrown = patience is not None and extent.edges > patience
            return SIZE if outgrown else budget.reached_limit(extent.nbytes // 2)

        return watch


_small: WeakKeyDictionary[Transition, Exploration] = WeakKeyDictionary()
"""The last exploration of a step function, as long as the function exists."""


def _known(transition: Transition, explored: Exploration, merging: Merging | None, automaton: Automaton) -> Reach:
    """Return what was explored, with the weights of `automaton`."""
    letters, names = tuple(map(str, transition.actions)), tuple(map(action_name, transition.actions))
    if merging is None or explored.renamings is None:
        return Reach(letters, names, Completions(automaton), None, explored.stop)
    from prag_asp.space.automaton.merged_states import MergedAutomaton

    base = explored.automaton
    merged = MergedAutomaton(base, explored.renamings, merging.actions, merging.groups, automaton.weights)
    return Reach.of_merged(letters, names, merged, explored.stop)


def _objection(allow: Allow, rows: Rows) -> StopReason | None:
    return None if allow(rows).all() else HALT


def _present(groups: Groups, transition: Transition) -> list[Sequence[Unit]]:
    """Return the groups of whose units a step function speaks alike: one of a part need not speak of all."""
    entities = {entity for group in groups for unit in group for entity in unit}
    spoken = {each for symbol in (*transition.actions, *transition.variables)
              for each in mentioned_entities(symbol, entities)}  # fmt: skip
    told = ({tuple(entity in spoken for entity in unit) for unit in group} for group in groups)
    return [group for group, kinds in zip(groups, told, strict=True) if len(kinds) == 1 and any(*kinds)]


def equal_groups(groups: Groups, weights: Weights) -> list[tuple[Unit, ...]]:
    """Return the groups of units that neither the domain nor the weights distinguish."""
    entities = {entity for group in groups for unit in group for entity in unit}
    single = {entity for action in weights.actions for entity in mentioned_entities(action, entities)}
    found: list[tuple[Unit, ...]] = []
    for group in groups:
        by_weight: dict[object, list[Unit]] = {}
        for unit in group:
            if single.isdisjoint(unit):
                by_weight.setdefault(tuple(map(weights.entities.get, unit)), []).append(unit)
        found += [tuple(members) for members in by_weight.values() if len(members) > 1]
    return found
