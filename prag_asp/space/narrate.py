"""From words to tasks: what is known of the states that a plan passes, its subgoals and its goal."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import islice

import clingo

from prag_asp.domain.atom import Atom, parse_atom
from prag_asp.errors import EngineError
from prag_asp.logic.hindsight import Hindsight, Known, Plan, solved_states
from prag_asp.logic.model import Model
from prag_asp.logic.program import mentioned_entities
from prag_asp.space.task import Task

BATCH = 512
"""Plans that are told together; the first task of a long iteration waits for one batch at most."""


@dataclass(frozen=True)
class Narrator:
    """Tells the tasks of one domain from their plans."""

    model: Model

    @cached_property
    def _hindsight(self) -> Hindsight | None:
        try:
            return Hindsight(self.model.step)
        except EngineError:
            return None

    @cached_property
    def _atoms(self) -> dict[clingo.Symbol, Atom]:
        return {}

    @cached_property
    def _entities(self) -> Mapping[str, str]:
        return {str(entity): name for entity, name in self.model.domain.facts.entities.items()}

    def tasks(self, words: Iterable[tuple[Sequence[str], float | None]]) -> Iterator[Task]:
        """Yield the task of each plan, given as the texts of its actions and the log-probability of its draw.

        Batches grow from one plan, so that the first task comes at once.
        """
        actions = {str(action): action for action in self.model.domain.facts.actions}
        waiting = iter(words)
        size = 1
        while batch := list(islice(waiting, size)):
            plans = [tuple(actions[text] for text in word) for word, _ in batch]
            for plan, states, (_, probability) in zip(plans, self._states(plans), batch, strict=True):
                yield self._task(plan, states, probability)
            size = min(2 * size, BATCH)

    def _states(self, plans: Sequence[Plan]) -> list[list[Known]]:
        if self._hindsight is None:
            return [solved_states(self.model.program, plan) for plan in plans]
        return self._hindsight.states(plans)

    def _task(self, plan: Plan, states: Sequence[Known], log_probability: float | None) -> Task:
        facts = self.model.domain.facts
        told = [{self._atom(fluent): state[fluent] for fluent in sorted(state, key=self._rank)} for state in states]
        subgoals = [
            {
                self._atom(fluent): value == "true"
                for fluent, value in facts.postconditions.get(action, ())
                if value != "unknown"
            }
            for action in plan
        ]
        named = [*plan, *(fluent for state in states for fluent in state)]
        used = {entity for symbol in named for entity in self._named(symbol)}
        return Task(
            domain=self.model.domain.name,
            actions=tuple(map(self._atom, plan)),
            entities={str(entity): self._entities[str(entity)] for entity in sorted(used)},
            initial=told[0],
            states=tuple(told[1:]),
            subgoals=tuple(subgoals),
            goal={self._atom(fluent): value == "true" for fluent, value in facts.goal} or dict(told[-1]),
            log_probability=log_probability,
        )

    @cached_property
    def _rank_of(self) -> Mapping[clingo.Symbol, int]:
        return {fluent: rank for rank, fluent in enumerate(self.model.domain.facts.fluents)}

    def _rank(self, fluent: clingo.Symbol) -> int:
        return self._rank_of.get(fluent, len(self._rank_of))

    @cached_property
    def _names(self) -> dict[clingo.Symbol, tuple[clingo.Symbol, ...]]:
        return {}

    def _named(self, symbol: clingo.Symbol) -> tuple[clingo.Symbol, ...]:
        if symbol not in self._names:
            self._names[symbol] = tuple(mentioned_entities(symbol, self.model.domain.facts.entities))
        return self._names[symbol]

    def _atom(self, symbol: clingo.Symbol) -> Atom:
        if symbol not in self._atoms:
            self._atoms[symbol] = parse_atom(str(symbol))
        return self._atoms[symbol]
