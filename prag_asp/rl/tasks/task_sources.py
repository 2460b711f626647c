"""Where the tasks of an environment come from, each with a witness: one task, a task space, or a data set."""

from __future__ import annotations

from collections.abc import Mapping
from contextlib import ExitStack
from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING, NamedTuple, Protocol

import numpy as np

from prag_asp.errors import NotFound, QueryError
from prag_asp.physics import Budget, Situation, Validator, Witness, open_validator, physical_task
from prag_asp.rl.curriculum.course import Course, Episode, State
from prag_asp.rl.curriculum.task_pool import Pool
from prag_asp.space.task_space import TaskSpace

if TYPE_CHECKING:
    from prag_asp.dataset.store.dataset import Dataset
    from prag_asp.scene.scene import Scene
    from prag_asp.task import Task

PATIENCE = 1000
"""How many tasks in a row are drawn at most until one has a witness."""


class Assignment(NamedTuple):
    """A task that an agent is given, with a witness, and its rank among all of its length where that is known.

    `probability` is the exact one of the draw that it came of, None where it was not drawn; `rejected` is how many
    draws since the last task that was given had none that could be given: it is not feasible, or not of the part.
    """

    task: Task
    witness: Witness
    rank: int | None = None
    probability: Fraction | None = None
    rejected: int = 0


class Source(Protocol):
    """Gives tasks."""

    def seed(self, seed: int) -> None:
        """Begin the draws anew; what is drawn from now on depends on the seed, and on what is reported, alone."""

    def draw(self) -> Assignment:
        """Return the next task.

        Raises:
            NotFound: so many were drawn in vain.
        """

    def ranked(self, rank: int) -> Assignment:
        """Return the task of a rank.

        Raises:
            QueryError: there is none, or it has no witness.
        """

    def report(self, episode: Episode) -> None:
        """Hear how an episode has ended."""

    def told(self) -> Mapping[str, int | str]:
        """Return in few words what its curriculum has come to."""

    def state_dict(self) -> State:
        """Return what it has come to, of what JSON can write."""

    def load_state_dict(self, state: State) -> None:
        """Go on from what `state_dict` returned."""


class Finder:
    """Finds witnesses of tasks, by one validator that is opened where it is first needed."""

    def __init__(self, scene: Scene, resources: ExitStack, budget: Budget | None):
        self.scene, self._resources, self._budget = scene, resources, budget
        self._validator: Validator | None = None

    def witness(self, task: Task, *, seed: int = 0, index: int = 0) -> Witness | None:
        """Return a witness of a task, None where none is found; it depends on nothing but what is given.

        Raises:
            SceneError: the task speaks about something for which the scene has no shape.
        """
        if self._validator is None:
            self._validator = self._resources.enter_context(open_validator(self.scene))
        return self._validator.validate(task, seed=seed, index=index, budget=self._budget).witness

    def forget(self) -> None:
        """Forget the validator, which was closed."""
        self._validator = None

    def required(self, task: Task) -> Witness:
        """Return a witness of a task.

        Raises:
            QueryError: none is found.
        """
        witness = self.witness(task)
        if witness is None:
            raise QueryError(f"no witness is found for the task {task}; take another, or give a larger budget")
        return witness


@dataclass
class OneTask:
    """Gives the same task again and again."""

    given: Assignment

    def seed(self, seed: int) -> None:
        """There is nothing to draw."""

    def draw(self) -> Assignment:
        """Return the task."""
        return self.given._replace(probability=Fraction(1))

    def ranked(self, rank: int) -> Assignment:
        """Refuse.

        Raises:
            QueryError: a single task has no rank.
        """
        raise QueryError(f"rank {rank}: there is one task alone; give a space or a data set")

    def report(self, episode: Episode) -> None:
        """Nothing depends on it."""

    def told(self) -> Mapping[str, int | str]:
        """There is nothing to tell."""
        return {}

    def state_dict(self) -> State:
        """There is nothing to keep."""
        return {}

    def load_state_dict(self, state: State) -> None:
        """There is nothing to go on from."""


def fitting(task: Task, witness: Witness, scene: Scene) -> Assignment:
    """Return a task with a witness that somebody gives for it.

    Raises:
        QueryError: it is of another task: not all facts of a state hold in it, or it has too few or too many states.
        SceneError: the task speaks about something for which the scene has no shape.
    """
    states, moments = physical_task(task, scene).states, witness.moments
    if len(states) != len(moments):
        raise QueryError(f"the witness has {len(moments)} states, the task {len(states)}; give that of the task")
    sized = scene.with_sizes(witness.sizes)
    for number, (facts, moment) in enumerate(zip(states, moments, strict=True)):
        situation = Situation(sized, moment.poses, moment.arms, moment.openings)
        for fact in facts:
            if not fact.is_satisfied(situation):
                told = f"in state {number} of the witness it does not hold that {fact.sentence()}"
                raise QueryError(f"{told}; give the witness of the task")
    return Assignment(task, witness)


def require_rank(rank: object, count: int) -> int:
    """Return a rank that there is.

    Raises:
        QueryError: there is none.
    """
    if isinstance(rank, bool) or not isinstance(rank, int | np.integer) or not 0 <= rank < count:
        raise QueryError(f"rank {rank!r}: give a whole number from 0 to {count - 1}")
    return int(rank)


class SpaceSource:
    """Draws the tasks of a pool by a course through them, and takes those that have a witness."""

    def __init__(self, pool: Pool, course: Course, finder: Finder):
        self._pool, self._course, self._finder = pool, course, finder
        self._seed, self._number = 0, 0

    def seed(self, seed: int) -> None:
        """Begin the draws anew."""
        self._seed, self._number = seed, 0
        self._course.seed(seed)

    def draw(self) -> Assignment:
        """Return the next task that has a witness.

        Raises:
            NotFound: so many in a row have none.
        """
        rejected = 0
        for _ in range(PATIENCE):
            offer = self._course.offer()
            task, index = self._pool.task(offer), self._number + offer.passed
            witness = self._finder.witness(task, seed=self._seed, index=index)
            self._course.settle(offer.word, witness is not None)
            self._number = index + 1
            rejected += offer.passed
            if witness is not None:
                return Assignment(task, witness, probability=offer.probability, rejected=rejected)
            rejected += 1
        raise NotFound(f"none of {PATIENCE} tasks drawn in a row is feasible; take another space, or a larger budget")

    def ranked(self, rank: int) -> Assignment:
        """Return the task of a rank, with a witness.

        Raises:
            QueryError: there is none of that rank, it has no witness, it is not of the part, or the space has tasks of
                several lengths.
        """
        space = self._pool.space
        if not isinstance(space, TaskSpace):
            raise QueryError("a rank is that among the tasks of one length; give a space of one length")
        task = space[require_rank(rank, space.count())]
        if not self._pool.has(tuple(map(str, task.actions))):
            raise QueryError(f"rank {rank} is not one of the part that is given; give a rank of that")
        return Assignment(task, self._finder.required(task), rank)

    def report(self, episode: Episode) -> None:
        """Let the course hear how an episode has ended."""
        self._course.report(episode)

    def told(self) -> Mapping[str, int | str]:
        """Return in few words what the course has come to."""
        return self._course.told()

    def state_dict(self) -> State:
        """Return what it has come to."""
        return {"seed": self._seed, "number": self._number, "course": self._course.state_dict()}

    def load_state_dict(self, state: State) -> None:
        """Go on from what `state_dict` returned."""
        self._seed, self._number = state["seed"], state["number"]
        self._course.load_state_dict(state["course"])


class DatasetSource:
    """Gives the tasks of a data set in random order, each from a first state that it has a witness for."""

    def __init__(self, dataset: Dataset):
        self._dataset, self._count = dataset, dataset.count()
        if self._count == 0:
            raise QueryError(f"{dataset.folder}: there is no task to be given")
        self.seed(0)

    def seed(self, seed: int) -> None:
        """Begin the draws anew."""
        self._rng = np.random.default_rng(seed)

    def draw(self) -> Assignment:
        """Return a task that has an action, all equally likely, from one of its first states.

        Raises:
            NotFound: so many in a row have none.
        """
        for rejected in range(PATIENCE):
            given = self._given(int(self._rng.integers(self._count)))
            if given.task.actions:
                return given._replace(probability=Fraction(1, self._count), rejected=rejected)
        raise NotFound(f"{self._dataset.folder}: {PATIENCE} tasks in a row have no action; take another data set")

    def ranked(self, rank: int) -> Assignment:
        """Return the task of a number of the data set.

        Raises:
            QueryError: there is none.
        """
        return self._given(require_rank(rank, self._count))

    def report(self, episode: Episode) -> None:
        """Nothing depends on it."""

    def told(self) -> Mapping[str, int | str]:
        """There is nothing to tell."""
        return {}

    def state_dict(self) -> State:
        """Return what it has come to."""
        return {"rng": dict(self._rng.bit_generator.state)}

    def load_state_dict(self, state: State) -> None:
        """Go on from what `state_dict` returned."""
        self._rng.bit_generator.state = state["rng"]

    def _given(self, number: int) -> Assignment:
        entry = self._dataset.entry(number)
        if entry.starts == 0:
            raise QueryError(f"{self._dataset.folder}: its tasks have no witnesses; generate it with physics")
        start = int(self._rng.integers(entry.starts))
        return Assignment(entry.task, self._dataset.witness(number, start), entry.rank)
