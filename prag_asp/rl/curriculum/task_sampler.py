"""The interfaces of curricula: samplers of tasks and of initial subgoals that learn from the results of episodes."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from itertools import islice
from typing import Any, NamedTuple, Protocol

from prag_asp.atom import Atom
from prag_asp.program.entity_names import action_name, mentioned_entities, shared_names
from prag_asp.program.facts import Facts
from prag_asp.rl.curriculum.task_pool import Proposal, TaskPool, Word

State = dict[str, Any]
"""The state of a sampler, as JSON values."""


class Attempt(NamedTuple):
    """A subgoal that was pursued: its action, the action before it in the task, and whether it was reached."""

    action: Atom
    before: Atom | None
    reached: bool


class EpisodeResult(NamedTuple):
    """The result of an episode: the number of subgoals of its task, the initial subgoal, and the attempts."""

    stages: int
    first: int
    attempts: Sequence[Attempt]
    success: bool


class TaskSampler(Protocol):
    """A sampler of tasks; their distribution may depend on the results of episodes."""

    def seed(self, seed: int) -> None:
        """Reset the sampler, and discard all results; later samples depend only on the seed and on later results."""

    def propose(self) -> Proposal:
        """Return the next task, which may be infeasible."""

    def note_feasibility(self, word: Word, feasible: bool) -> None:
        """Record whether a proposed task is feasible."""

    def update(self, result: EpisodeResult) -> None:
        """Record the result of an episode."""

    def summary(self) -> Mapping[str, int | str]:
        """Return the progress as numbers and words by name."""

    def state_dict(self) -> State:
        """Return the state as JSON values."""

    def load_state_dict(self, state: State) -> None:
        """Continue from a state returned by `state_dict`."""


class SubgoalSampler(Protocol):
    """A sampler of the initial subgoals of episodes; their distribution may depend on the results of episodes."""

    def seed(self, seed: int) -> None:
        """Reset the sampler."""

    def stage(self, stages: int) -> tuple[int, Fraction]:
        """Return the index of the initial subgoal among the `stages` subgoals of a task, and its probability."""

    def update(self, result: EpisodeResult) -> None:
        """Record the result of an episode."""

    def summary(self) -> Mapping[str, int | str]:
        """Return the progress as numbers and words by name."""

    def state_dict(self) -> State:
        """Return the state as JSON values."""

    def load_state_dict(self, state: State) -> None:
        """Continue from a state returned by `state_dict`."""


class TaskCurriculum(Protocol):
    """The parameters of a curriculum of tasks."""

    def task_sampler(self, pool: TaskPool) -> TaskSampler:
        """Return a sampler of the tasks of a pool.

        Raises:
            QueryError: the pool has no tasks for the curriculum.
        """
        ...


class StageCurriculum(Protocol):
    """The parameters of a curriculum of initial subgoals."""

    def subgoal_sampler(self) -> SubgoalSampler:
        """Return a sampler of initial subgoals."""
        ...


class DomainWeightsSampler:
    """A sampler of tasks with the weights of the domain, regardless of the results of episodes."""

    def __init__(self, pool: TaskPool):
        self._pool = pool
        self.seed(0)

    def seed(self, seed: int) -> None:
        """Reset the sampler."""
        self._seed, self._taken = seed, 0
        self._proposals: Iterator[Proposal] = self._pool.proposals(seed=seed)

    def propose(self) -> Proposal:
        """Return the next task."""
        self._taken += 1
        return next(self._proposals)

    def note_feasibility(self, word: Word, feasible: bool) -> None:
        """Do nothing."""

    def update(self, result: EpisodeResult) -> None:
        """Do nothing."""

    def summary(self) -> Mapping[str, int | str]:
        """Return nothing."""
        return {}

    def state_dict(self) -> State:
        """Return the state as JSON values."""
        return {"seed": self._seed, "taken": self._taken}

    def load_state_dict(self, state: State) -> None:
        """Continue from a state returned by `state_dict`."""
        self.seed(state["seed"])
        self._taken = state["taken"]
        skip(self._proposals, self._taken)


def skip(proposals: Iterator[Proposal], count: int) -> None:
    """Advance an iterator by `count` proposals."""
    next(islice(proposals, count, count), None)


@dataclass(frozen=True)
class ActionKeys:
    """The weight keys for the actions of a domain: action names, pairs of names, and classes."""

    facts: Facts

    def of(self, attempt: Attempt) -> Iterator[str]:
        """Yield the keys for an attempt at a subgoal."""
        name, classes = self._known[str(attempt.action)]
        if name in self.weighable:
            yield name
        if attempt.before is not None:
            yield f"{self._known[str(attempt.before)][0]}>{name}"
        yield from sorted(classes & self.weighable)

    def names(self, word: Word) -> tuple[str, ...]:
        """Return the skeleton of a task."""
        return tuple([self._known[action][0] for action in word])

    @cached_property
    def weighable(self) -> frozenset[str]:
        """The unambiguous action names, and the unambiguous classes with an entity in some action."""
        names_and_classes = self._known.values()
        names = {name for name, _ in names_and_classes} | {each for _, classes in names_and_classes for each in classes}
        return frozenset(names.difference(shared_names(self.facts)))

    @cached_property
    def _known(self) -> dict[str, tuple[str, frozenset[str]]]:
        """The name of each action and the classes of its entities, by the text of the action."""
        facts = self.facts
        result = {}
        for action in facts.actions:
            entities = set(mentioned_entities(action, facts.entities))
            classes = frozenset(str(name) for entity, name in facts.memberships if entity in entities)
            result[str(action)] = action_name(action), classes
        return result
