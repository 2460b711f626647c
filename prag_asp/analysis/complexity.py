"""The logical complexity of a task: its length, its choices, and its distance from a shortest plan."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass
from functools import cached_property
from math import log2

import numpy as np

from prag_asp.analysis.layered_automaton import LayeredAutomaton, layered_words
from prag_asp.atom import Atom
from prag_asp.errors import QueryError
from prag_asp.similarity.symbols import entities_in
from prag_asp.space.plans.shortest_plans import PlanSearch
from prag_asp.space.task_space import TaskSpace
from prag_asp.task import Task


@dataclass(frozen=True)
class Complexity:
    """The complexity of a task.

    `entities` is the number of entities that occur in the actions. `undone` is the number of changes that are undone:
    one action changes the value of a fluent, and a later action changes it back. `choices` holds, for each action of
    the task, the number of alternatives, including itself, that can be continued to a plan of the space. `shortest` is
    the length of the shortest plans of the domain that lead from the initial state of the task to its goal without
    further assumptions about the initial state; `shortest_plans` is their number.
    """

    length: int
    entities: int
    undone: int
    choices: tuple[int, ...]
    shortest: int
    shortest_plans: int

    @property
    def bits(self) -> float:
        """The information in the choices, in bits: -log2 of the probability of the task if each choice is uniform."""
        return sum(map(log2, self.choices))

    @property
    def detour(self) -> int:
        """The number of actions in excess of a shortest plan."""
        return self.length - self.shortest


@dataclass(frozen=True)
class ComplexityMeasure:
    """A measure of the complexity of tasks from a space with one length; it caches data that all tasks share."""

    space: TaskSpace

    @cached_property
    def _words(self) -> LayeredAutomaton:
        return layered_words(self.space, "plan")

    @cached_property
    def _search(self) -> PlanSearch:
        return PlanSearch(self.space.engines.model)

    def of(self, task: Task) -> Complexity:
        """Return the complexity of a task.

        Raises:
            QueryError: the task is not in the space, or the states of the space are too many to be listed.
            EngineError: the step of the domain is not a function of the state and the action.
            LimitReached: a limit was reached.
        """
        choices = self._choices(task)
        found = self._search.solve(task.initial, task.goal, len(task), self.space.engines.limits.begin())
        assert found is not None, "the plan of a task leads from its initial state to its goal"
        mentioned = {entity for action in task.actions for entity in entities_in(action, task.entities)}
        return Complexity(len(task), len(mentioned), undone(task), choices, found.length, found.number)

    def _choices(self, task: Task) -> tuple[int, ...]:
        """Return the number of alternatives to each action of a task, including itself."""
        words, state, choices = self._words, 0, []
        if len(task) != words.length or words.edges is None:
            raise QueryError(f"no task of {self.space.title}: {task}")
        letters = {letter: number for number, letter in enumerate(words.letters)}
        for action, step in zip(map(str, task.actions), words.edges, strict=True):
            edges = np.flatnonzero(step.sources == state)
            chosen = edges[step.letters[edges] == letters.get(action, -1)]
            if not len(chosen):
                raise QueryError(f"no task of {self.space.title}: {task}")
            choices.append(len(edges))
            state = int(step.targets[chosen[0]])
        return tuple(choices)


def complexity_of(task: Task, within: TaskSpace) -> Complexity:
    """Return the complexity of a task from a space; for many tasks, `ComplexityMeasure` is faster.

    Raises:
        QueryError: the task is not in the space, or the states of the space are too many to be listed.
        EngineError: the step of the domain is not a function of the state and the action.
        LimitReached: a limit was reached.
    """
    return ComplexityMeasure(within.at(len(task))).of(task)


def undone(task: Task) -> int:
    """Return the number of changes of facts that a later action undoes.

    An action changes a fluent if it gives the fluent a value that differs from its last known value, if there is one.
    """
    values, changes = dict(task.initial), Counter[Atom]()
    for state in task.states:
        changes.update(fluent for fluent, value in state.items() if values.get(fluent) != value)
        values.update(state)
    return sum(number - 1 for number in changes.values())
