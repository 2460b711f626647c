"""Counts of the words of one length that begin with a given prefix and end in a state with certain facts.

The weights of the paths from the state after the prefix are computed step by step; for the last step, they are summed
separately for each set of known values in the final state. Numbers are exact.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass
from functools import cached_property, partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from prag_asp.atom import parse_atom
from prag_asp.errors import EngineError
from prag_asp.logic.domain_logic import DomainLogic
from prag_asp.logic.step.hindsight import FALSE, TRUE, FluentValues, Hindsight, numbered_goals
from prag_asp.space.automaton.automaton import Automaton, Completions, states_after
from prag_asp.space.automaton.exploration import Extent
from prag_asp.space.engines.engine import Engine, Letters, Level, name_in_prefix
from prag_asp.space.engines.reachability import HALT, Explorer
from prag_asp.space.limits import LimitClock, limit_error
from prag_asp.space.shortest_tasks import ShortestEngine
from prag_asp.space.weights.weights import Weights
from prag_asp.task import Task

Numbers = NDArray[Any]
"""Exact numbers: 64-bit integers while overflow is impossible, Python integers otherwise."""


FEW_EDGES, MANY_EDGES = 200_000, 2_000_000
"""Maximum number of edges of an automaton that remembers all fluents, and of one that remembers only the fluents that
plans need."""


FEW_TASKS = 200
"""Number of tasks up to which their final states are listed, which takes a fraction of a second."""


@dataclass(frozen=True)
class Ending:
    """The number of words after which one of the given facts is known to hold, and the number after which one may hold.

    In an open world, values may be unknown. Under the condition that one of the facts holds in the end, the `possible`
    words remain.
    """

    holding: int
    possible: int


@dataclass(frozen=True)
class FinalStates:
    """The known values of `fluents`, given by their numbers, in the final states of the words of one length.

    The words are the paths of `automaton` with `length` edges; `values` holds the distinct combinations of known
    values, shape (fluents, goals), and `goals` the index of the combination after each edge, shape (edges,). `letters`
    are the texts of the letters.
    """

    length: int
    letters: Letters
    automaton: Automaton
    goals: NDArray[np.int64]
    values: FluentValues
    fluents: tuple[int, ...]

    def count(self, prefix: Letters, facts: Sequence[Collection[int]]) -> list[Ending | None]:
        """Return, for each set of `facts`, how many words begin with `prefix` and end with a fact from the set.

        Facts are numbers of fluents. The result is None for a set with a fact that is not counted.
        """
        numbers = self._by_goal(prefix)
        found = np.flatnonzero(numbers)
        values, numbers = self.values[:, found], numbers[found]
        rows = {fluent: row for row, fluent in enumerate(self.fluents)}
        endings: list[Ending | None] = []
        for each in facts:
            if not all(fluent in rows for fluent in each):
                endings.append(None)
                continue
            chosen = values[[rows[fluent] for fluent in each]]
            true, possible = (chosen == TRUE).any(axis=0), (chosen != FALSE).any(axis=0)
            endings.append(Ending(int(numbers[true].sum()), int(numbers[possible].sum())))
        return endings

    def _by_goal(self, prefix: Letters) -> Numbers:
        """Return, for each goal, how many words begin with `prefix` and end with the goal's values; shape (goals,)."""
        automaton, left = self.automaton, self.length - len(prefix)
        total = np.zeros(self.values.shape[1], dtype=object)
        if left < 0 or not self.length or not automaton.states:
            return total
        early = [self._allowed(item).__contains__ for item in (prefix if left else prefix[:-1])]
        row = np.zeros(automaton.states, dtype=np.int64)
        for state, weight in states_after(automaton, early).items():
            row = row.astype(object) if weight >= 2**62 else row
            row[state] = weight
        for _ in range(left - 1):
            row = self._backward.following(row)
        edges = self._last
        if not left:
            edges = edges[np.isin(automaton.letters[edges], list(self._allowed(prefix[-1])))]
        weights = row[automaton.sources[edges]]
        edges, weights = edges[weights != 0], weights[weights != 0]
        if weights.dtype != object and float(weights.astype(float).sum()) < 2.0**62:
            total = np.zeros(len(total), dtype=np.int64)
        np.add.at(total, self.goals[edges], weights)
        return total

    def _allowed(self, item: str) -> frozenset[int]:
        """Return the letters that an item of a prefix allows."""
        name = name_in_prefix(item, self._numbers)
        if name is None:
            return frozenset([self._numbers[item]])
        return frozenset(number for text, number in self._numbers.items() if text.partition("(")[0] == name)

    @cached_property
    def _numbers(self) -> dict[str, int]:
        return {letter: number for number, letter in enumerate(self.letters)}

    @cached_property
    def _last(self) -> NDArray[np.intp]:
        """The edges that may be the last edge of a word."""
        return np.flatnonzero(self.automaton.accepting[self.automaton.targets])

    @cached_property
    def _backward(self) -> Completions:
        """The completions of the automaton with all edges reversed, whose rows sum over the edges into a state."""
        automaton = self.automaton
        order = np.argsort(automaton.targets, kind="stable")
        offsets = np.searchsorted(automaton.targets[order], np.arange(automaton.states + 1)).astype(np.int64)
        reversed_edges = Automaton(offsets, automaton.letters[order], automaton.sources[order], automaton.accepting)
        return Completions(reversed_edges)


def endings_of(tasks: Sequence[Task], facts: Sequence[Collection[str]]) -> list[Ending | None]:
    """Return, for each set of `facts`, how many of the given tasks end with a fact from the set."""
    finals = [task.states[-1] for task in tasks]
    endings: list[Ending | None] = []
    for each in facts:
        atoms = [parse_atom(fact) for fact in each]
        true = sum(any(final.get(atom) for atom in atoms) for final in finals)
        endings.append(Ending(true, sum(any(final.get(atom, True) for atom in atoms) for final in finals)))
    return endings


def final_states(
    model: DomainLogic, engine: Engine, level: Level, length: int, clock: LimitClock
) -> FinalStates | None:
    """Return the final states of the plans or tasks of a given length, or None if they take too many states.

    If tracking all fluents takes too many states, only the fluents that the variables of a step determine are counted.

    Raises:
        LimitReached: a limit ended the exploration of the states.
        EngineError: there are too many words to list.
    """
    fluents = model.domain.facts.fluents
    if isinstance(engine, ShortestEngine):
        return _listed(engine, length, len(fluents))
    try:
        step = model.step
        explorer = Explorer(model, level, merge=False)
        memory = frozenset(explorer.transition().variables)
    except EngineError:  # a step is not a function of the state and the action
        return _listed(engine, length, len(fluents))
    remembered = [place for place, each in enumerate(fluents) if memory.issuperset(Hindsight(step, (each,)).last_read)]
    for chosen, edges in ((list(range(len(fluents))), FEW_EDGES), (remembered, MANY_EDGES)):
        hindsight = Hindsight(step, tuple(fluents[place] for place in chosen))
        halt = partial(_exceeds, edges)
        reach, _, marks = explorer.weighed(length, Weights(), clock, hindsight.last_read, halt)
        if reach.stop is None:
            goals, values = numbered_goals(hindsight, marks)
            return FinalStates(length, reach.letters, reach.completions.automaton, goals, values, tuple(chosen))
        if reach.stop != HALT:
            raise limit_error(reach.stop, 0, level, length, reach.states)
    return None


def _listed(engine: Engine, length: int, fluents: int) -> FinalStates:
    """Return the final states of words if the engine lists their states or the words themselves."""
    weighed = engine.weighed(length, Weights(), goals=True)
    assert weighed.goals is not None and weighed.goal_values is not None, "goals are requested"
    values, places = weighed.goal_values, tuple(range(fluents))
    return FinalStates(length, engine.letters, weighed.automaton, weighed.goals, values, places)


def _exceeds(edges: int, extent: Extent) -> bool:
    return extent.edges > edges
