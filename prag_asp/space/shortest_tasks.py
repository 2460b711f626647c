"""The engine for the condition ``shortest``: its words are the tasks whose goal no shorter plan reaches.

Whether there is a shorter plan depends on the whole plan, but only through the known values of its initial and its
final state. The states of the automaton are refined by both (``encodings/conditions/shortest.lp``), so that a state by
itself determines whether the plans of one length that end in it are accepted.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any

import clingo
import numpy as np
from numpy.typing import NDArray

from prag_asp.errors import EngineError, LimitReached
from prag_asp.logic.domain_logic import DomainLogic
from prag_asp.logic.step.transition import Transition
from prag_asp.processes.machine import usual_memory
from prag_asp.processes.progress_events import stage
from prag_asp.program.predicates import FINDING
from prag_asp.space.automaton.automaton import Automaton
from prag_asp.space.automaton.exploration import Exploration
from prag_asp.space.engines.automaton_engine import AutomatonEngine
from prag_asp.space.engines.engine import Letters, Level, Progress, all_letters
from prag_asp.space.engines.reachability import Allow, Explorer, Halt
from prag_asp.space.limits import UNLIMITED, LimitClock, Limits
from prag_asp.space.plans.shortest_plans import TRUTH, PlanSearch
from prag_asp.space.weights.weights import Weighed, Weights
from prag_asp.stop_reason import StopKind, StopReason

MOST_STARTS = 5000
"""Maximum number of different known initial states; a search from each of them takes about 10 ms."""


@dataclass(frozen=True)
class ShortestExplorer(Explorer):
    """An explorer whose states accept plans of `length` actions if no shorter plan has the same start and goal."""

    length: int = 0

    @property
    def _atoms(self) -> tuple[clingo.Symbol, ...]:
        """The atoms for the known values at the start, followed by those for the known values at the end."""
        fluents = self.model.domain.facts.fluents
        values = [(fluent, clingo.Function(text)) for fluent in fluents for text in TRUTH.values()]
        return tuple(FINDING.timeless(clingo.Function(kind, [*each])) for kind in ("began", "ended") for each in values)

    def transition(self, weights: Weights | None = None, read: Sequence[clingo.Symbol] = ()) -> Transition:
        """Return the step function to explore, whose last labels are the known values at the start and at the end.

        Raises:
            EngineError: the step is not a function of the state and the action.
        """
        return super().transition(weights, (*read, *self._atoms))

    def _explore(
        self, transition: Transition, length: int, clock: LimitClock, weights: Weights, halt: Halt | None = None,
        allow: Allow | None = None,
    ) -> tuple[Exploration, Any]:  # fmt: skip
        explored, merging = super()._explore(transition, length, clock, weights, halt, allow)
        own = explored.labels.shape[1] - len(self._atoms)
        automaton = explored.automaton
        accepting = np.zeros(automaton.states, dtype=np.bool_)
        if not explored.stop:
            stage("comparing plans with shorter ones")
            accepting = self._shortest(automaton, explored.labels[:, own:], clock)
        return replace(
            explored, automaton=replace(automaton, accepting=accepting), labels=explored.labels[:, :own]
        ), merging

    def _shortest(self, automaton: Automaton, labels: NDArray[np.bool_], clock: LimitClock) -> NDArray[np.bool_]:
        """Return which states accept plans of `length` actions."""
        accepting = _reached(automaton, self.length) & automaton.accepting
        if not self.length:
            return accepting
        into, edges = np.unique(automaton.targets, return_index=True)
        chosen = accepting[into]
        into, edges = into[chosen], edges[chosen]
        starts, ends = np.split(np.ascontiguousarray(labels[edges]), 2, axis=1)
        kinds, kind_of = np.unique(starts, axis=0, return_inverse=True)
        if len(kinds) > MOST_STARTS:
            raise LimitReached(
                f"the condition shortest compares plans from {len(kinds):,} different initial states, more than "
                f"{MOST_STARTS:,}; state more of the initial state (starts ...), or take a shorter length",
                0, StopReason(StopKind.FORECAST),
            )  # fmt: skip
        search, goals = PlanSearch(self.model), np.packbits(ends, axis=1)
        if self.model.domain.facts.goal:
            goals[:] = search.goal_row((fluent, value == "true") for fluent, value in self.model.domain.facts.goal)
        values = [(fluent, value) for fluent in self.model.domain.facts.fluents for value in TRUTH]
        members = [np.flatnonzero(kind_of.ravel() == number) for number in range(len(kinds))]
        begun = [[values[place] for place in np.flatnonzero(kind)] for kind in kinds]
        different = [np.unique(goals[own], axis=0, return_inverse=True) for own in members]
        if self.tell:
            self.tell(f"searching for shorter plans from {len(kinds):,} initial states")
        found = search.solvable(begun, [each for each, _ in different], self.length - 1, clock)
        for own, (_, goal_of), solved in zip(members, different, found, strict=True):
            accepting[into[own[solved[goal_of.ravel()]]]] = False
        return accepting


def _reached(automaton: Automaton, length: int) -> NDArray[np.bool_]:
    """Return which states some word of a given length reaches."""
    reached = np.zeros(automaton.states, dtype=np.bool_)
    reached[:1] = True
    for _ in range(length):
        targets = automaton.targets[reached[automaton.sources]]
        reached = np.zeros_like(reached)
        reached[targets] = True
    return reached


class ShortestEngine:
    """The engine for one level of the tasks whose goal no shorter plan reaches, with one automaton for each length.

    Raises:
        EngineError: another engine is requested, or the step is not a function of the state and the action.
    """

    def __init__(
        self, name: str, model: DomainLogic, level: Level, progress: Progress | None = None, limits: Limits = UNLIMITED
    ) -> None:
        if name not in ("auto", "automaton"):
            raise EngineError(f"the condition shortest needs the engine automaton; got {name}")
        if model.obstacles:
            raise model.obstacles[0].error()
        memory = usual_memory() if limits.memory_bytes is None else limits.memory_bytes
        self._request = (model, level, progress, replace(limits, memory_bytes=memory))
        self._engines: dict[int, AutomatonEngine] = {}

    @property
    def letters(self) -> Letters:
        """The texts of the letters, in order."""
        model, level, *_ = self._request
        return tuple(all_letters(model, level))

    def count(self, length: int, prefix: Letters = ()) -> int:
        """Return the number of words of a given length.

        Raises:
            LimitReached: a limit ended the exploration or the search for shorter plans.
        """
        return self._engine(length).count(length, prefix)

    def following(self, length: int, prefix: Letters = ()) -> dict[str, int]:
        """Return, for each letter that can follow `prefix`, the number of words that continue with it."""
        return self._engine(length).following(length, prefix)

    def words(self, length: int, prefix: Letters = ()) -> Iterator[Letters]:
        """Yield the words of a given length in order, lazily."""
        return self._engine(length).words(length, prefix)

    def contains(self, word: Letters) -> bool:
        """Return whether a word belongs to the level."""
        return self._engine(len(word)).contains(word)

    def unrank(self, length: int, rank: int) -> Letters:
        """Return the word with a given rank, from 0 to count - 1."""
        return self._engine(length).unrank(length, rank)

    def rank(self, word: Letters) -> int | None:
        """Return the rank of a word among the words of its length, or None if it is not a word."""
        return self._engine(len(word)).rank(word)

    def weighed(self, length: int, weights: Weights, *, goals: bool = False, plain: bool = False) -> Weighed:
        """Return the weighted words of a given length."""
        return self._engine(length).weighed(length, weights, goals=goals, plain=plain)

    def _engine(self, length: int) -> AutomatonEngine:
        if length not in self._engines:
            model, level, progress, limits = self._request
            explorer = ShortestExplorer(model, level, progress, merge=False, length=length)
            self._engines[length] = AutomatonEngine(model, level, progress, limits, explorer=explorer)
        return self._engines[length]
