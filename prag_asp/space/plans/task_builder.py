"""The construction of tasks from plans: the known fluents of each state, the subgoals and the goal."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from functools import reduce
from operator import or_
from typing import NamedTuple

import clingo
import numpy as np

from prag_asp.atom import Atom, atom_of
from prag_asp.batches import growing_batches
from prag_asp.errors import EngineError
from prag_asp.logic.domain_logic import DomainLogic
from prag_asp.logic.step.hindsight import TRUE, UNKNOWN, Hindsight
from prag_asp.logic.step.plan_states import PlanStates, SolvedPlanStates
from prag_asp.program.entity_names import mentioned_entities
from prag_asp.program.facts import Assignment
from prag_asp.task import FrozenDict, Task

BATCH = 2048
"""Maximum number of plans that are evaluated together; lazy iteration has to wait for one batch."""

BATCH_STATES = 1 << 14
"""Approximate number of states in a batch; cached states are dropped only between batches."""

Known = FrozenDict[Atom, bool]
Entities = int
"""A set of entities, in which bit i stands for the i-th entity."""

WeighedPlan = tuple[Sequence[str], "float | None"]
"""A plan as the texts of its actions, and the log-probability of its draw, or None if it was not sampled."""


class _Action(NamedTuple):
    atom: Atom
    effect: Known
    entities: Entities


class TaskBuilder:
    """A builder of the tasks of one domain from their plans; equal states, effects and goals share one object."""

    def __init__(self, model: DomainLogic) -> None:
        self._model = model
        self._plan_states = self._new_plan_states()
        self._states: list[Known] = []
        self._entities_of: list[Entities] = []
        self._classes: dict[Entities, FrozenDict[str, str]] = {}
        self._constants = FrozenDict(model.domain.constants)
        facts = model.domain.facts
        places = {entity: place for place, entity in enumerate(facts.entities)}

        def entities(symbol: clingo.Symbol) -> Entities:
            return reduce(or_, (1 << places[entity] for entity in mentioned_entities(symbol, places)), 0)

        self._action_numbers = {str(action): number for number, action in enumerate(self._plan_states.letters)}
        self._fluents = list(map(atom_of, facts.fluents))
        self._entities_of_fluent = list(map(entities, facts.fluents))
        self._actions = {
            str(action): _Action(atom_of(action), _values(facts.postconditions.get(action, ())), entities(action))
            for action in facts.actions
        }
        self._goal = _values(facts.goal)

    def tasks(self, plans: Iterable[WeighedPlan]) -> Iterator[Task]:
        """Yield the task of each plan, lazily, in growing batches that start with one plan."""
        for batch in growing_batches(plans, lambda plan: _batch_size(len(plan[0]))):
            yield from self.build(batch)

    def build(self, plans: Sequence[WeighedPlan]) -> list[Task]:
        """Return the task of each plan; plans of one length are evaluated together."""
        by_length: dict[int, list[int]] = {}
        for place, (plan, _) in enumerate(plans):
            by_length.setdefault(len(plan), []).append(place)
        tasks: dict[int, Task] = {}
        for length, places in by_length.items():
            size = _batch_size(length)
            for first in range(0, len(places), size):
                batch = places[first : first + size]
                states = self._state_numbers([plans[place][0] for place in batch])
                for place, numbers in zip(batch, states, strict=True):  # later batches may drop the states
                    tasks[place] = self._task(*plans[place], numbers)
        return [tasks[place] for place in range(len(plans))]

    def final_values(self, plans: Sequence[Sequence[str]]) -> list[tuple[int, ...]]:
        """Return the values of all fluents in the final state of each plan, as in `FluentValues`."""
        known = [self._states[numbers[-1]] for numbers in self._state_numbers(plans)] if plans else []
        return [tuple(int(state.get(fluent, UNKNOWN)) for fluent in self._fluents) for state in known]

    def _state_numbers(self, plans: Sequence[Sequence[str]]) -> list[list[int]]:
        """Return, for each plan, the numbers that its states have in `_states`; all plans have the same length."""
        if self._plan_states.full:
            self._plan_states = self._new_plan_states()
            self._states, self._entities_of, self._classes = [], [], {}
        actions = np.array([[self._action_numbers[text] for text in plan] for plan in plans], dtype=np.int64)
        numbers = self._plan_states.numbers(actions.reshape(len(plans), -1))
        new = range(len(self._states), int(numbers.max()) + 1)
        for column in self._plan_states.values(new).T:
            places = np.flatnonzero(column != UNKNOWN)
            values = (column[places] == TRUE).tolist()
            fluents = [self._fluents[place] for place in places.tolist()]
            self._states.append(FrozenDict(zip(fluents, values, strict=True)))
            self._entities_of.append(reduce(or_, (self._entities_of_fluent[place] for place in places.tolist()), 0))
        state_numbers: list[list[int]] = numbers.tolist()
        return state_numbers

    def _task(self, plan: Sequence[str], log_probability: float | None, numbers: Sequence[int]) -> Task:
        actions = [self._actions[text] for text in plan]
        states = [self._states[number] for number in numbers]
        used = 0
        for action in actions:
            used |= action.entities
        for number in {*numbers}:
            used |= self._entities_of[number]
        classes = self._classes.get(used)
        if classes is None:
            entities = enumerate(self._model.domain.facts.entity_names.items())
            classes = FrozenDict({entity: name for place, (entity, name) in entities if used >> place & 1})
            self._classes[used] = classes
        return Task(
            self._model.domain.name,
            tuple([action.atom for action in actions]),  # a list is faster than a generator
            classes,
            states[0],
            tuple(states[1:]),
            tuple([action.effect for action in actions]),
            self._goal or states[-1],
            log_probability,
            self._constants,
        )

    def _new_plan_states(self) -> PlanStates | SolvedPlanStates:
        try:
            return PlanStates(Hindsight(self._model.step, self._model.domain.facts.fluents))
        except EngineError:
            return SolvedPlanStates(self._model.program, self._model.domain.facts)


def _batch_size(length: int) -> int:
    """Return the maximum number of plans of a given length that are evaluated together."""
    return min(BATCH, max(BATCH_STATES // (length + 1), 1))


def _values(values: Assignment) -> Known:
    return FrozenDict({atom_of(fluent): value == "true" for fluent, value in values if value != "unknown"})
