"""What a curriculum is, and what it hears of: subgoals that were pursued, by name, pair and class."""

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
from prag_asp.rl.curriculum.task_pool import Offer, Pool, Word

State = dict[str, Any]
"""What a course has come to, of what JSON can write."""


class Attempt(NamedTuple):
    """A subgoal that was pursued: its action, that before it in the task, and whether it was reached."""

    action: Atom
    before: Atom | None
    reached: bool


class Episode(NamedTuple):
    """An episode that has ended: how many subgoals its task has, with which it began, and how it went."""

    stages: int
    begun: int
    attempts: Sequence[Attempt]
    success: bool


class Course(Protocol):
    """Says which task comes next, by what was reported."""

    def seed(self, seed: int) -> None:
        """Begin anew: nothing was reported, and what is drawn from now on depends on the seed and the reports alone."""

    def offer(self) -> Offer:
        """Return the next task that is drawn, whether it is feasible or not."""

    def settle(self, word: Word, feasible: bool) -> None:
        """Hear whether a task that was offered is feasible."""

    def report(self, episode: Episode) -> None:
        """Hear how an episode has ended."""

    def told(self) -> Mapping[str, int | str]:
        """Return in few words what it has come to."""

    def state_dict(self) -> State:
        """Return what it has come to, of what JSON can write."""

    def load_state_dict(self, state: State) -> None:
        """Go on from what `state_dict` returned."""


class Walk(Protocol):
    """Says with which subgoal an episode begins, by what was reported."""

    def seed(self, seed: int) -> None:
        """Begin anew."""

    def stage(self, stages: int) -> tuple[int, Fraction]:
        """Return the subgoal to begin with of a task of so many, and with which probability it was drawn."""

    def report(self, episode: Episode) -> None:
        """Hear how an episode has ended."""

    def told(self) -> Mapping[str, int | str]:
        """Return in few words what it has come to."""

    def state_dict(self) -> State:
        """Return what it has come to, of what JSON can write."""

    def load_state_dict(self, state: State) -> None:
        """Go on from what `state_dict` returned."""


class TaskCurriculum(Protocol):
    """A value that says in which order tasks come."""

    def course(self, pool: Pool) -> Course:
        """Return a course through the tasks of a pool.

        Raises:
            QueryError: the pool has nothing for it.
        """
        ...


class StageCurriculum(Protocol):
    """A value that says in which order the subgoals of tasks come."""

    def walk(self) -> Walk:
        """Return a course through subgoals."""
        ...


class Plain:
    """Tasks by the weights of the domain, whatever is reported."""

    def __init__(self, pool: Pool):
        self._pool = pool
        self.seed(0)

    def seed(self, seed: int) -> None:
        """Begin the draws anew."""
        self._seed, self._taken = seed, 0
        self._offers: Iterator[Offer] = self._pool.offers(seed=seed)

    def offer(self) -> Offer:
        """Return the next task."""
        self._taken += 1
        return next(self._offers)

    def settle(self, word: Word, feasible: bool) -> None:
        """Nothing depends on it."""

    def report(self, episode: Episode) -> None:
        """Nothing depends on it."""

    def told(self) -> Mapping[str, int | str]:
        """There is nothing to tell."""
        return {}

    def state_dict(self) -> State:
        """Return what it has come to."""
        return {"seed": self._seed, "taken": self._taken}

    def load_state_dict(self, state: State) -> None:
        """Go on from what `state_dict` returned."""
        self.seed(state["seed"])
        self._taken = state["taken"]
        skip(self._offers, self._taken)


def skip(offers: Iterator[Offer], count: int) -> None:
    """Take so many offers, and forget them."""
    next(islice(offers, count, count), None)


@dataclass(frozen=True)
class Keys:
    """The names, pairs of names and classes by which the actions of a domain are told apart, as weights spell them."""

    facts: Facts

    def of(self, attempt: Attempt) -> Iterator[str]:
        """Yield the keys of a subgoal."""
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
        """The names, and the classes of which some action mentions an entity, that are not spelled like another."""
        known = self._known.values()
        found = {name for name, _ in known} | {each for _, classes in known for each in classes}
        return frozenset(found.difference(shared_names(self.facts)))

    @cached_property
    def _known(self) -> dict[str, tuple[str, frozenset[str]]]:
        """For the text of each action its name, and the classes of the entities that it mentions."""
        facts = self.facts
        found = {}
        for action in facts.actions:
            entities = set(mentioned_entities(action, facts.entities))
            classes = frozenset(str(name) for entity, name in facts.memberships if entity in entities)
            found[str(action)] = action_name(action), classes
        return found
