"""What an automaton engine explores of one level of a domain: whole or up to a limit, merged or not."""

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
from prag_asp.space.automaton.exploration import Explored, Extent, Watch, explore
from prag_asp.space.automaton.skeletons import skeleton_automaton
from prag_asp.space.limits import Budget
from prag_asp.space.weights.weights import Weights, weigh, weighing_facts

if TYPE_CHECKING:
    from prag_asp.logic.symmetry.canonical_states import Merging
    from prag_asp.space.automaton.merged_states import Merged
    from prag_asp.space.engines.engine import Level

PATIENCE, WORDS, LARGE = 250_000, 4, 100
"""Edges of a space beyond which its states are merged, where these take few words, and have so many renamings."""

FEW_STATES, FEW_EDGES = 4096, 50_000
"""States and edges up to which all levels share what was explored."""

MORE_PATIENCE = 5_000_000
"""Edges beyond which states are merged that have fewer renamings: plain arrays are faster as long as they fit."""

OUTGROWN, HALTED, UNFIT = "outgrown", "halted", "unfit"
"""Why exploring stopped where no limit ended it."""

Halt = Callable[[Extent], bool]
"""Tells, by how far exploring has come, whether to leave it."""

Forecast = Callable[[Extent, int], bool]
"""Tells, by how far exploring has come and the length, that it will not come to its end in the memory there is."""

Allow = Callable[[Rows], NDArray[np.bool_]]
"""Tells of states whether exploring may go on; where one of them forbids it, it is halted."""

Groups = Sequence[Sequence[Unit]]


@dataclass(frozen=True)
class Reach:
    """What is known of the words of a level.

    `letters` are the texts of the letters and `names` those of their actions' names. `merged` is what walks along words
    where states were merged; `stopped` says which limit ended the exploration, in words, and is empty where nothing is
    missing up to the automaton's horizon. With `sets`, the automaton's states are sets of the domain's.
    """

    letters: tuple[str, ...]
    names: tuple[str, ...]
    completions: Completions
    merged: Merged | None = None
    stopped: str = ""
    sets: bool = False

    @classmethod
    def of_merged(cls, letters: tuple[str, ...], names: tuple[str, ...], merged: Merged, stopped: str = "") -> Reach:
        """Return what is known where states were merged."""
        return cls(letters, names, Completions(merged.automaton), merged, stopped)

    @property
    def states(self) -> int:
        """The number of the domain's states that are listed."""
        return 0 if self.sets else self.completions.automaton.states

    def covers(self, length: int) -> bool:
        """Return whether all words of a length are known."""
        horizon = self.completions.automaton.horizon
        return not self.stopped and (horizon is None or horizon >= length)


class Unfit(Exception):
    """Exploring was given up, for it would not end in the memory there is; `reach` is what was found until then."""

    def __init__(self, reach: Reach) -> None:
        super().__init__(UNFIT)
        self.reach = reach


@dataclass(frozen=True)
class Explorer:
    """Explores one level of a domain; `merge` says whether states are merged, or is None to let their number decide.

    Exploring is given up, as unfit, where `hopeless` says so once it is decided whether states are merged.
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
        """Return what is reached within `length` steps, or until the budget is spent or `halt` or `allow` says so."""
        explored, merging = self._explored(transition, length, budget, Weights(), halt, allow)
        names = tuple(map(action_name, transition.actions))
        if self.level == "skeleton" and explored.stopped not in {HALTED, UNFIT}:
            stage("merging plans of one skeleton")
            letters = tuple(sorted(set(names)))
            numbers = np.array([letters.index(name) for name in names], dtype=np.int64)
            automaton, stopped = skeleton_automaton(explored.automaton, numbers, budget.spent)
            return Reach(letters, letters, Completions(automaton), None, explored.stopped or stopped)
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
        explored, merging = self._explored(transition, length, budget, weights, halt)
        own = explored.labels.shape[1] - len(read)
        automaton, scale = explored.automaton, 1
        if weights and explored.stopped not in {HALTED, UNFIT}:
            automaton, scale = weigh(automaton, explored.labels[:, :own], transition.actions, weights)
        return _known(transition, explored, merging, automaton), Fraction(1, scale), explored.labels[:, own:]

    def _explored(
        self,
        transition: Transition,
        length: int,
        budget: Budget,
        weights: Weights,
        halt: Halt | None = None,
        allow: Allow | None = None,
    ) -> tuple[Explored, Merging | None]:
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
        if explored.stopped == OUTGROWN:
            merging = self._merging(transition, weights)
            if merging is not None and prod(factorial(len(group)) for group in merging.groups) < LARGE:
                explored = explore(
                    transition, length, self._watch(length, budget, MORE_PATIENCE, halt), object_to=object_to
                )
                if explored.stopped != OUTGROWN:
                    return explored, None
            return explore(
                transition, length, self._watch(length, budget, halt=halt), merging=merging, object_to=object_to
            ), merging
        if not explored.stopped and explored.automaton.states <= FEW_STATES and len(explored.labels) <= FEW_EDGES:
            _small[transition] = explored
        return explored, None

    def _known_to_others(
        self, transition: Transition, length: int, budget: Budget, halt: Halt | None
    ) -> Explored | None:
        """Return what an engine of another level has explored, where it is small and this one would find the same.

        Who wants to hear of progress, or limits it, does so anew.
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

        def watch(extent: Extent) -> str | None:
            if self.tell:
                memory = f"{extent.nbytes / 10**6:,.0f} MB"
                self.tell(f"depth {extent.depth}: {extent.states:,} states, {extent.edges:,} edges, {memory}")
            if halt and halt(extent):
                return HALTED
            if patience is None and self.hopeless and self.hopeless(extent, length):
                return UNFIT
            outgrown = patience is not None and extent.edges > patience
            return OUTGROWN if outgrown else budget.spent(extent.nbytes // 2)

        return watch


_small: WeakKeyDictionary[Transition, Explored] = WeakKeyDictionary()
"""What was last explored of a step function, as long as there is one."""


def _known(transition: Transition, explored: Explored, merging: Merging | None, automaton: Automaton) -> Reach:
    """Return what was explored, with the weights of `automaton`."""
    letters, names = tuple(map(str, transition.actions)), tuple(map(action_name, transition.actions))
    if merging is None or explored.renamings is None:
        return Reach(letters, names, Completions(automaton), None, explored.stopped)
    from prag_asp.space.automaton.merged_states import Merged

    base = explored.automaton
    merged = Merged(base, explored.renamings, merging.actions, merging.groups, automaton.weights)
    return Reach.of_merged(letters, names, merged, explored.stopped)


def _objection(allow: Allow, rows: Rows) -> str:
    return "" if allow(rows).all() else HALTED


def _present(groups: Groups, transition: Transition) -> list[Sequence[Unit]]:
    """Return the groups of whose units a step function speaks alike: one of a part need not speak of all."""
    entities = {entity for group in groups for unit in group for entity in unit}
    spoken = {each for symbol in (*transition.actions, *transition.variables)
              for each in mentioned_entities(symbol, entities)}  # fmt: skip
    told = ({tuple(entity in spoken for entity in unit) for unit in group} for group in groups)
    return [group for group, kinds in zip(groups, told, strict=True) if len(kinds) == 1 and any(*kinds)]


def equal_groups(groups: Groups, weights: Weights) -> list[tuple[Unit, ...]]:
    """Return the groups of units that neither the domain nor the weights tell apart."""
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
