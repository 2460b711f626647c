"""Where the tasks of an environment come from, each with a witness: one task, a task space, or a data set."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import ExitStack
from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple, Protocol

import numpy as np

from prag_asp.errors import NotFound, QueryError
from prag_asp.physics import Budget, Situation, Validator, Witness, open_validator, physical_task
from prag_asp.space.ordered import drawn_tasks, lengths_of
from prag_asp.space.task_space import TaskSpace

if TYPE_CHECKING:
    from prag_asp.dataset.store.dataset import Dataset
    from prag_asp.scene.model import Scene
    from prag_asp.space.task_spaces import TaskSpaces
    from prag_asp.task import Task

PATIENCE = 1000
"""How many tasks in a row are drawn at most until one has a witness."""


class Given(NamedTuple):
    """A task that an agent is given, with a witness, and its rank among all of its length where that is known."""

    task: Task
    witness: Witness
    rank: int | None = None


class Source(Protocol):
    """Gives tasks."""

    def seed(self, seed: int) -> None:
        """Begin the draws anew; what is drawn from now on depends on the seed alone."""

    def draw(self) -> Given:
        """Return the next task.

        Raises:
            NotFound: so many were drawn in vain.
        """

    def ranked(self, rank: int) -> Given:
        """Return the task of a rank.

        Raises:
            QueryError: there is none, or it has no witness.
        """


class Finder:
    """Finds witnesses of tasks, by one validator that is opened where it is first needed."""

    def __init__(self, scene: Scene, resources: ExitStack, budget: Budget | None):
        self._scene, self._resources, self._budget = scene, resources, budget
        self._validator: Validator | None = None

    def witness(self, task: Task, *, seed: int = 0, index: int = 0) -> Witness | None:
        """Return a witness of a task, None where none is found; it depends on nothing but what is given.

        Raises:
            SceneError: the task speaks about something for which the scene has no shape.
        """
        if self._validator is None:
            self._validator = self._resources.enter_context(open_validator(self._scene))
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

    given: Given

    def seed(self, seed: int) -> None:
        """There is nothing to draw."""

    def draw(self) -> Given:
        """Return the task."""
        return self.given

    def ranked(self, rank: int) -> Given:
        """Refuse.

        Raises:
            QueryError: a single task has no rank.
        """
        raise QueryError(f"rank {rank}: there is one task alone; give a space or a data set")


def fitting(task: Task, witness: Witness, scene: Scene) -> Given:
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
            if not fact.satisfied(situation):
                told = f"in state {number} of the witness it does not hold that {fact.sentence()}"
                raise QueryError(f"{told}; give the witness of the task")
    return Given(task, witness)


def require_rank(rank: object, count: int) -> int:
    """Return a rank that there is.

    Raises:
        QueryError: there is none.
    """
    if isinstance(rank, bool) or not isinstance(rank, int | np.integer) or not 0 <= rank < count:
        raise QueryError(f"rank {rank!r}: give a whole number from 0 to {count - 1}")
    return int(rank)


class SpaceSource:
    """Draws tasks from a space by its weights, and takes those that have a witness."""

    def __init__(self, space: TaskSpace | TaskSpaces, finder: Finder):
        if not any(lengths_of(space)):
            raise QueryError("tasks of no action have no subgoal; give a space of another length")
        self._space, self._finder = space, finder
        self.seed(0)

    def seed(self, seed: int) -> None:
        """Begin the draws anew."""
        self._seed = seed
        self._draws: Iterator[tuple[int, Task]] = enumerate(drawn_tasks(self._space, seed=seed))

    def draw(self) -> Given:
        """Return the next task that has a witness.

        Raises:
            NotFound: so many in a row have none.
        """
        for _ in range(PATIENCE):
            index, task = next(self._draws)
            witness = self._finder.witness(task, seed=self._seed, index=index) if task.actions else None
            if witness is not None:
                return Given(task, witness)
        raise NotFound(f"none of {PATIENCE} tasks drawn in a row is feasible; take another space, or a larger budget")

    def ranked(self, rank: int) -> Given:
        """Return the task of a rank, with a witness.

        Raises:
            QueryError: there is none of that rank, it has no witness, or the space has tasks of several lengths.
        """
        if not isinstance(self._space, TaskSpace):
            raise QueryError("a rank is that among the tasks of one length; give a space of one length")
        task = self._space[require_rank(rank, self._space.count())]
        return Given(task, self._finder.required(task), rank)


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

    def draw(self) -> Given:
        """Return a task that has an action, all equally likely, from one of its first states.

        Raises:
            NotFound: so many in a row have none.
        """
        for _ in range(PATIENCE):
            given = self._given(int(self._rng.integers(self._count)))
            if given.task.actions:
                return given
        raise NotFound(f"{self._dataset.folder}: {PATIENCE} tasks in a row have no action; take another data set")

    def ranked(self, rank: int) -> Given:
        """Return the task of a number of the data set.

        Raises:
            QueryError: there is none.
        """
        return self._given(require_rank(rank, self._count))

    def _given(self, number: int) -> Given:
        entry = self._dataset.entry(number)
        if entry.starts == 0:
            raise QueryError(f"{self._dataset.folder}: its tasks have no witnesses; generate it with physics")
        start = int(self._rng.integers(entry.starts))
        return Given(entry.task, self._dataset.witness(number, start), entry.rank)
