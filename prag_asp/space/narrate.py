"""From words to tasks: what is known of the states that a plan passes, its subgoals and its goal."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import islice

import clingo
import numpy as np

from prag_asp.domain.atom import Atom, parse_atom
from prag_asp.domain.facts import Assignment
from prag_asp.errors import EngineError
from prag_asp.logic.hindsight import TRUE, UNKNOWN, Hindsight, Plan, Told, solved_states
from prag_asp.logic.model import Model
from prag_asp.logic.program import mentioned_entities
from prag_asp.space.task import Task

BATCH = 512
"""Plans that are told together; the first task of a long iteration waits for one batch at most."""


@dataclass(frozen=True)
class Narrator:
    """Tells the tasks of one domain from their plans."""

    model: Model

    def tasks(self, words: Iterable[tuple[Sequence[str], float | None]]) -> Iterator[Task]:
        """Yield the task of each plan, given as the texts of its actions and the log-probability of its draw.

        Batches grow from one plan, so that the first task comes at once.
        """
        waiting = iter(words)
        size = 1
        while batch := list(islice(waiting, size)):
            told = self._told([tuple(self._actions[text] for text in word) for word, _ in batch])
            for column, (word, log_probability) in enumerate(batch):
                yield self._task(word, told[:, :, column], log_probability)
            size = min(2 * size, BATCH)

    @cached_property
    def _hindsight(self) -> Hindsight | None:
        try:
            return Hindsight(self.model.step, self.model.domain.facts.fluents)
        except EngineError:
            return None

    @cached_property
    def _actions(self) -> dict[str, clingo.Symbol]:
        return {str(action): action for action in self.model.domain.facts.actions}

    @cached_property
    def _fluents(self) -> list[Atom]:
        return [parse_atom(str(fluent)) for fluent in self.model.domain.facts.fluents]

    @cached_property
    def _named_by_fluent(self) -> list[frozenset[str]]:
        return [self._named(fluent) for fluent in self.model.domain.facts.fluents]

    @cached_property
    def _of_action(self) -> dict[str, tuple[Atom, dict[Atom, bool], frozenset[str]]]:
        """For each action: its atom, its known effects, and the entities that it names."""
        effects = self.model.domain.facts.postconditions
        return {
            text: (parse_atom(text), _values(effects.get(action, ())), self._named(action))
            for text, action in self._actions.items()
        }

    @cached_property
    def _goal(self) -> dict[Atom, bool]:
        return _values(self.model.domain.facts.goal)

    @cached_property
    def _entities(self) -> dict[str, str]:
        return {str(entity): name for entity, name in self.model.domain.facts.entities.items()}

    def _named(self, symbol: clingo.Symbol) -> frozenset[str]:
        return frozenset(map(str, mentioned_entities(symbol, self.model.domain.facts.entities)))

    def _told(self, plans: Sequence[Plan]) -> Told:
        if self._hindsight is not None:
            return self._hindsight.states(plans)
        fluents = self.model.domain.facts.fluents
        return np.concatenate([solved_states(self.model.program, plan, fluents) for plan in plans], axis=2)

    def _task(self, word: Sequence[str], told: Told, log_probability: float | None) -> Task:
        states = []
        for row in told:
            known = np.flatnonzero(row != UNKNOWN)
            values = (row[known] == TRUE).tolist()
            states.append({self._fluents[i]: value for i, value in zip(known.tolist(), values, strict=True)})
        actions = [self._of_action[text] for text in word]
        mentioned = np.flatnonzero((told != UNKNOWN).any(axis=0)).tolist()
        used = frozenset().union(*(named for _, _, named in actions), *(self._named_by_fluent[i] for i in mentioned))
        return Task(
            domain=self.model.domain.name,
            actions=tuple(atom for atom, _, _ in actions),
            entities={entity: name for entity, name in self._entities.items() if entity in used},
            initial=states[0],
            states=tuple(states[1:]),
            subgoals=tuple(dict(effect) for _, effect, _ in actions),
            goal=dict(self._goal) or dict(states[-1]),
            log_probability=log_probability,
        )


def _values(values: Assignment) -> dict[Atom, bool]:
    return {parse_atom(str(fluent)): value == "true" for fluent, value in values if value != "unknown"}
