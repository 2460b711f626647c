"""From words to tasks: what is known of the states that a plan passes, its subgoals and its goal."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from functools import cached_property, reduce
from itertools import groupby, islice
from operator import or_
from typing import NamedTuple

import clingo
import numpy as np

from prag_asp.atom import Atom, atom_of
from prag_asp.errors import EngineError
from prag_asp.logic.domain_logic import DomainLogic
from prag_asp.logic.step.hindsight import TRUE, UNKNOWN, Hindsight
from prag_asp.logic.step.plan_states import PlanStates, SolvedPlanStates
from prag_asp.program.entity_names import mentioned_entities
from prag_asp.program.facts import Assignment
from prag_asp.task import FrozenDict, Task

BATCH = 2048
"""Plans that are told together; the first task of a long iteration waits for one batch at most."""

BATCH_STATES = 1 << 14
"""States that these plans pass together, about: what is remembered is forgotten between batches alone."""

Known = FrozenDict[Atom, bool]
Entities = int
"""A set of entities: bit i for the i-th."""


class _Action(NamedTuple):
    atom: Atom
    effect: Known
    entities: Entities


class Narrator:
    """Tells the tasks of one domain from their plans; equal states, effects and goals are one object."""

    def __init__(self, model: DomainLogic) -> None:
        self._model = model
        self._plan_states = self._new_plan_states()
        self._states: list[Known] = []
        self._named: list[Entities] = []
        self._classes: dict[Entities, FrozenDict[str, str]] = {}
        self._constants = FrozenDict(model.domain.constants)

    def tasks(self, words: Iterable[tuple[Sequence[str], float | None]]) -> Iterator[Task]:
        """Yield the task of each plan, given as the texts of its actions and the log-probability of its draw.

        Batches grow from one plan, so that the first task comes at once.
        """
        waiting = iter(words)
        size = 1
        while batch := list(islice(waiting, size)):
            yield from self.told(batch)
            size = min(2 * size, _most(batch[0][0]))

    def told(self, words: Sequence[tuple[Sequence[str], float | None]]) -> list[Task]:
        """Return the task of each of some plans, told together.

        They are told at once: whoever tells others before they are used may have the states forgotten.
        """
        size = _most(words[0][0]) if words else 1
        return [
            self._task([self._actions[text] for text in word], numbers, log_probability)
            for first in range(0, len(words), size)
            for (word, log_probability), numbers in self._numbered(words[first : first + size])
        ]

    def _numbered(
        self, words: Sequence[tuple[Sequence[str], float | None]]
    ) -> Iterator[tuple[tuple[Sequence[str], float | None], list[int]]]:
        """Yield each plan with the places of its states; those of one length in a row are told together."""
        for _, row in groupby(words, key=lambda each: len(each[0])):
            several = list(row)
            yield from zip(several, self._told([word for word, _ in several]), strict=True)

    def last_states(self, words: Sequence[Sequence[str]]) -> list[Known]:
        """Return what is known of the last state of each of some plans."""
        return [self._states[numbers[-1]] for numbers in self._told(words)] if words else []

    def _told(self, words: Sequence[Sequence[str]]) -> list[list[int]]:
        """Return the places in `_states` of what is known of the states of each plan."""
        if self._plan_states.full:
            self._plan_states = self._new_plan_states()
            self._states, self._named, self._classes = [], [], {}
        plans = np.array([[self._letters[text] for text in word] for word in words], dtype=np.int64)
        numbers = self._plan_states.numbers(plans.reshape(len(words), -1))
        new = range(len(self._states), int(numbers.max()) + 1)
        for column in self._plan_states.values(new).T:
            places = np.flatnonzero(column != UNKNOWN)
            values = (column[places] == TRUE).tolist()
            fluents = [self._fluents[place] for place in places.tolist()]
            self._states.append(FrozenDict(zip(fluents, values, strict=True)))
            self._named.append(reduce(or_, (self._named_by_fluent[place] for place in places.tolist()), 0))
        told: list[list[int]] = numbers.tolist()
        return told

    def _task(self, plan: Sequence[_Action], told: Sequence[int], log_probability: float | None) -> Task:
        states = [self._states[number] for number in told]
        used = 0
        for action in plan:
            used |= action.entities
        for number in {*told}:
            used |= self._named[number]
        return Task(
            self._model.domain.name,
            tuple([action.atom for action in plan]),  # a list is faster than a generator
            self._classes_of(used),
            states[0],
            tuple(states[1:]),
            tuple([action.effect for action in plan]),
            self._goal or states[-1],
            log_probability,
            self._constants,
        )

    def _classes_of(self, used: Entities) -> FrozenDict[str, str]:
        found = self._classes.get(used)
        if found is None:
            entities = enumerate(self._model.domain.facts.entity_names.items())
            found = FrozenDict({entity: name for place, (entity, name) in entities if used >> place & 1})
            self._classes[used] = found
        return found

    def _new_plan_states(self) -> PlanStates | SolvedPlanStates:
        try:
            return PlanStates(Hindsight(self._model.step, self._model.domain.facts.fluents))
        except EngineError:
            return SolvedPlanStates(self._model.program, self._model.domain.facts)

    @cached_property
    def _letters(self) -> dict[str, int]:
        return {str(action): number for number, action in enumerate(self._plan_states.letters)}

    @cached_property
    def _fluents(self) -> list[Atom]:
        return [atom_of(fluent) for fluent in self._model.domain.facts.fluents]

    @cached_property
    def _named_by_fluent(self) -> list[Entities]:
        return [self._mentioned(fluent) for fluent in self._model.domain.facts.fluents]

    @cached_property
    def _actions(self) -> dict[str, _Action]:
        facts = self._model.domain.facts
        return {
            str(action): _Action(
                atom_of(action), _values(facts.postconditions.get(action, ())), self._mentioned(action)
            )
            for action in facts.actions
        }

    @cached_property
    def _goal(self) -> Known:
        return _values(self._model.domain.facts.goal)

    @cached_property
    def _places(self) -> dict[clingo.Symbol, int]:
        return {entity: place for place, entity in enumerate(self._model.domain.facts.entities)}

    def _mentioned(self, symbol: clingo.Symbol) -> Entities:
        return reduce(or_, (1 << self._places[entity] for entity in mentioned_entities(symbol, self._places)), 0)


def _most(word: Sequence[str]) -> int:
    """Return how many plans as long as one are told together at most."""
    return min(BATCH, max(BATCH_STATES // (len(word) + 1), 1))


def _values(values: Assignment) -> Known:
    return FrozenDict({atom_of(fluent): value == "true" for fluent, value in values if value != "unknown"})
