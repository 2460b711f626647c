"""The sources of an environment's tasks, each with a witness: a single task, a task space, or a dataset."""

from __future__ import annotations

from collections.abc import Mapping
from contextlib import ExitStack
from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING, NamedTuple, Protocol

import numpy as np

from prag_asp.dataset.scenario import Scenario, SearchStart
from prag_asp.dataset.scenarios import Scenarios
from prag_asp.dataset.store.instructions import TaskTexts
from prag_asp.errors import NotFound, QueryError
from prag_asp.physics import Budget, Situation, Validator, Witness, open_validator, physical_task
from prag_asp.rl.curriculum.task_pool import TaskPool
from prag_asp.rl.curriculum.task_sampler import EpisodeResult, State, TaskSampler
from prag_asp.space.task_space import TaskSpace

if TYPE_CHECKING:
    from prag_asp.dataset.store.dataset import Dataset
    from prag_asp.scene.scene import Scene
    from prag_asp.task import Task

PATIENCE = 1000
"""The maximum number of consecutive sampled tasks without a witness."""


class Assignment(NamedTuple):
    """A task for the agent, with a witness and, if known, its rank among all tasks of its length.

    `probability` is the exact probability of the sample, or None if the task was not sampled; `rejected` counts the
    samples since the last assignment that are infeasible or not in the part. `texts` holds the instructions stored in a
    dataset. `scenario` identifies the task and its initial state, if the space or the dataset is known.
    """

    task: Task
    witness: Witness
    rank: int | None = None
    probability: Fraction | None = None
    rejected: int = 0
    texts: TaskTexts | None = None
    scenario: Scenario | None = None


class TaskSource(Protocol):
    """A source of tasks with witnesses."""

    def seed(self, seed: int) -> None:
        """Reset the source; all later samples depend only on the seed and on the results of episodes."""

    def draw(self) -> Assignment:
        """Return the next task.

        Raises:
            NotFound: `PATIENCE` samples in a row have no witness.
        """

    def ranked(self, rank: int) -> Assignment:
        """Return the task with a given rank.

        Raises:
            QueryError: there is no such task, or the task has no witness.
        """

    def update(self, result: EpisodeResult) -> None:
        """Record the result of an episode."""

    def summary(self) -> Mapping[str, int | str]:
        """Return the progress of the curriculum, if there is one."""

    def state_dict(self) -> State:
        """Return the state as JSON values."""

    def load_state_dict(self, state: State) -> None:
        """Continue from a state returned by `state_dict`."""


class WitnessFinder:
    """A finder of witnesses of tasks; its validator is opened lazily."""

    def __init__(self, scene: Scene, resources: ExitStack, budget: Budget | None):
        self.scene, self.budget, self._resources = scene, budget, resources
        self._validator: Validator | None = None

    def witness(self, task: Task, *, seed: int = 0, index: int = 0) -> Witness | None:
        """Return a witness of a task, or None if none is found; the result depends only on the arguments.

        Raises:
            SceneError: the task refers to an entity without a shape in the scene.
        """
        return self.validator.validate(task, seed=seed, index=index, budget=self.budget).witness

    @property
    def validator(self) -> Validator:
        """The validator, which is opened on first use."""
        if self._validator is None:
            self._validator = self._resources.enter_context(open_validator(self.scene))
        return self._validator

    def forget(self) -> None:
        """Forget the validator, which is already closed."""
        self._validator = None

    def required(self, task: Task) -> Witness:
        """Return a witness of a task.

        Raises:
            QueryError: the search finds no witness within its budget.
        """
        witness = self.witness(task)
        if witness is None:
            raise QueryError(f"no witness was found for the task {task}; choose another, or give a larger budget")
        return witness


@dataclass
class SingleTask:
    """A source that returns the same task repeatedly."""

    assignment: Assignment

    def seed(self, seed: int) -> None:
        """Ignore the seed, because the order is fixed."""

    def draw(self) -> Assignment:
        """Return the task."""
        return self.assignment._replace(probability=Fraction(1))

    def ranked(self, rank: int) -> Assignment:
        """Raise an error.

        Raises:
            QueryError: a single task has no rank.
        """
        raise QueryError(f"rank {rank}: there is only one task; give a space or a dataset")

    def update(self, result: EpisodeResult) -> None:
        """Do nothing."""

    def summary(self) -> Mapping[str, int | str]:
        """Return nothing."""
        return {}

    def state_dict(self) -> State:
        """Return an empty state."""
        return {}

    def load_state_dict(self, state: State) -> None:
        """Do nothing."""


def assign_witness(task: Task, witness: Witness, scene: Scene) -> Assignment:
    """Return a task with a given witness, which is checked.

    Raises:
        QueryError: the witness is for another task: a fact of a state does not hold in it, or it has the wrong number
            of states.
        SceneError: the task refers to an entity without a shape in the scene.
    """
    states, moments = physical_task(task, scene).states, witness.moments
    if len(states) != len(moments):
        raise QueryError(f"the witness has {len(moments)} states, the task {len(states)}; give a witness of the task")
    sized = scene.with_sizes(witness.sizes)
    for number, (facts, moment) in enumerate(zip(states, moments, strict=True)):
        situation = Situation(sized, moment.poses, moment.arms, moment.openings)
        for fact in facts:
            if not fact.is_satisfied(situation):
                text = f"in state {number} of the witness, this fact does not hold: {fact.sentence()}"
                raise QueryError(f"{text}; give the witness of the task")
    return Assignment(task, witness)


def require_rank(rank: object, count: int) -> int:
    """Return a valid rank below `count`.

    Raises:
        QueryError: the rank is not a whole number from 0 to `count` - 1.
    """
    if isinstance(rank, bool) or not isinstance(rank, int | np.integer) or not 0 <= rank < count:
        raise QueryError(f"rank {rank!r}: give a whole number from 0 to {count - 1}")
    return int(rank)


class SpaceSource:
    """A source that samples the tasks of a pool with a curriculum, and rejects tasks without a witness.

    Unless `trivial` is true, it also rejects tasks whose final state equals the initial state.
    """

    def __init__(self, pool: TaskPool, sampler: TaskSampler, finder: WitnessFinder, *, trivial: bool = False):
        self._pool, self._sampler, self._finder, self._trivial = pool, sampler, finder, trivial
        self._scenarios = Scenarios(pool.space.domain, pool.space)
        self._seed, self._number = 0, 0

    def seed(self, seed: int) -> None:
        """Reset the sampler."""
        self._seed, self._number = seed, 0
        self._sampler.seed(seed)

    def draw(self) -> Assignment:
        """Return the next accepted task.

        Raises:
            NotFound: `PATIENCE` samples in a row are rejected.
        """
        rejected = trivial = 0
        for _ in range(PATIENCE):
            proposal = self._sampler.propose()
            task, index = self._pool.task(proposal), self._number + proposal.passed
            left_out = task.trivial and not self._trivial
            trivial += left_out
            witness = None if left_out else self._finder.witness(task, seed=self._seed, index=index)
            self._sampler.note_feasibility(proposal.word, witness is not None)
            self._number = index + 1
            rejected += proposal.passed
            if witness is not None:
                return Assignment(
                    task, witness, probability=proposal.probability, rejected=rejected,
                    scenario=self._scenario(task, self._seed, index),
                )  # fmt: skip
            rejected += 1
        if trivial == PATIENCE:
            raise NotFound(f"{PATIENCE} sampled tasks in a row end in their initial state; keep them with trivial=True")
        raise NotFound(
            f"none of {PATIENCE} sampled tasks in a row is feasible; choose another space, or give a larger budget"
        )

    def ranked(self, rank: int) -> Assignment:
        """Return the task with a given rank, together with a witness.

        Raises:
            QueryError: no task has that rank, the task has no witness or is not in the part, or the space has tasks of
                several lengths.
        """
        space = self._pool.space
        if not isinstance(space, TaskSpace):
            raise QueryError("a rank is that among the tasks of one length; give a space of one length")
        task = space[require_rank(rank, space.count())]
        if not self._pool.has(tuple(map(str, task.actions))):
            raise QueryError(f"rank {rank} is not in the part; give a rank of the part")
        return Assignment(task, self._finder.required(task), rank, scenario=self._scenario(task, 0, 0))

    def _scenario(self, task: Task, seed: int, index: int) -> Scenario:
        """Return the scenario of a task and of the search for its witness."""
        return self._scenarios.of(self._pool.space, task, SearchStart.of(seed, index, self._finder.budget))

    def update(self, result: EpisodeResult) -> None:
        """Update the curriculum with the result of an episode."""
        self._sampler.update(result)

    def summary(self) -> Mapping[str, int | str]:
        """Return the progress of the curriculum."""
        return self._sampler.summary()

    def state_dict(self) -> State:
        """Return the state as JSON values."""
        return {"seed": self._seed, "number": self._number, "sampler": self._sampler.state_dict()}

    def load_state_dict(self, state: State) -> None:
        """Continue from a state returned by `state_dict`."""
        self._seed, self._number = state["seed"], state["number"]
        self._sampler.load_state_dict(state["sampler"])


class DatasetSource:
    """A source that samples the tasks of a dataset, each from an initial state with a witness."""

    def __init__(self, dataset: Dataset):
        self._dataset, self._count = dataset, dataset.count()
        if self._count == 0:
            raise QueryError(f"{dataset.folder}: there is no task; give another dataset")
        self.seed(0)

    def seed(self, seed: int) -> None:
        """Reset the sampler."""
        self._rng = np.random.default_rng(seed)

    def draw(self) -> Assignment:
        """Return a uniformly random task with at least one action, from one of its initial states.

        Raises:
            NotFound: `PATIENCE` samples in a row have no witness.
        """
        for rejected in range(PATIENCE):
            assignment = self._assignment(int(self._rng.integers(self._count)))
            if assignment.task.actions:
                return assignment._replace(probability=Fraction(1, self._count), rejected=rejected)
        raise NotFound(f"{self._dataset.folder}: {PATIENCE} tasks in a row have no action; choose another dataset")

    def ranked(self, rank: int) -> Assignment:
        """Return the task with a given number in the dataset.

        Raises:
            QueryError: the dataset has no task with this number.
        """
        return self._assignment(require_rank(rank, self._count))

    def update(self, result: EpisodeResult) -> None:
        """Do nothing."""

    def summary(self) -> Mapping[str, int | str]:
        """Return nothing."""
        return {}

    def state_dict(self) -> State:
        """Return the state as JSON values."""
        return {"rng": dict(self._rng.bit_generator.state)}

    def load_state_dict(self, state: State) -> None:
        """Continue from a state returned by `state_dict`."""
        self._rng.bit_generator.state = state["rng"]

    def _assignment(self, number: int) -> Assignment:
        entry = self._dataset.entry(number)
        if entry.starts == 0:
            raise QueryError(f"{self._dataset.folder}: its tasks have no witnesses; generate it with physics")
        start = int(self._rng.integers(entry.starts))
        scenario = self._dataset.scenario(number, start)
        return Assignment(
            entry.task, self._dataset.witness(number, start), entry.rank, texts=entry.texts, scenario=scenario
        )
