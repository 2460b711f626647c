"""The options that define the origin of an environment's tasks, and the resulting source."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, is_dataclass
from typing import cast

from prag_asp.dataset.store.dataset import Dataset
from prag_asp.domain.load import Domain, load_domain
from prag_asp.errors import QueryError
from prag_asp.rl.curriculum.task_pool import RankedPart, TaskPool
from prag_asp.rl.curriculum.task_sampler import DomainWeightsSampler, StageCurriculum, TaskCurriculum
from prag_asp.rl.tasks.task_sources import DatasetSource, SpaceSource, TaskSource, WitnessFinder
from prag_asp.space.parts.ranked_tasks import RankedTasks
from prag_asp.space.task_space import TaskSpace
from prag_asp.space.without_replacement import Division, SpacePart, space_part
from prag_asp.task import Task

Curriculum = TaskCurriculum | StageCurriculum
Curricula = Curriculum | Sequence[Curriculum] | None


@dataclass(frozen=True)
class Split:
    """The part of a divided space to use; a dataset with the same division and seed has the same part."""

    part: str
    division: Division
    seed: int = 0

    def of(self, space: TaskSpace) -> SpacePart:
        """Return the part of a space.

        Raises:
            QueryError: there is no such part, or the space has a task without actions.
        """
        if not all(space.lengths):
            raise QueryError("tasks without actions have no subgoals; split a space of lengths from 1")
        return space_part(space, self.division, self.part, seed=self.seed)


@dataclass(frozen=True)
class TaskOrigin:
    """The origin of tasks: a space or a part of one, a dataset, or one task; and the curricula.

    Tasks of a space whose final state equals the initial state are excluded unless `trivial` is true.

    Raises:
        QueryError: no origin or more than one is given, or a curriculum is invalid or has nothing to choose from.
    """

    space: TaskSpace | None
    part: RankedTasks | None
    dataset: Dataset | None
    task: Task | None
    curriculum: Curricula
    split: Split | None = None
    trivial: bool = False

    def __post_init__(self) -> None:
        if sum(each is not None for each in (self.space, self.dataset, self.task)) != 1:
            raise QueryError("tasks have one origin; give a space, a dataset, or a task")
        for value, kinds, example in (
            (self.space, TaskSpace, 'TaskSpace(load_domain("tabletop"), length=2)'),
            (self.dataset, Dataset, 'Dataset.open("DIR")'),
            (self.task, Task, "a Task, such as a space yields"),
            (self.part, RankedTasks, 'a part of the space, such as space.split({"train": 0.8, "test": 0.2})["train"]'),
        ):
            if value is not None and not isinstance(value, kinds):
                raise QueryError(f"{value!r:.80} is not an origin of tasks; give {example}")
        if self.part is not None and self.space is None:
            raise QueryError("a part needs its space; give the space, too")
        if self.part is not None and isinstance(self.space, TaskSpace) and not self.space.same_tasks(self.part.space):
            raise QueryError(f"the part belongs to {self.part.space!r}, not {self.space!r}; give a part of the latter")
        if self.split is not None and (self.space is None or self.part is not None):
            raise QueryError("a split divides a whole space; give the space alone, or a part of it without a split")
        for each in self._curricula:
            if isinstance(each, type) or not (hasattr(each, "task_sampler") or hasattr(each, "subgoal_sampler")):
                raise QueryError(
                    f"{each!r:.80} is not a curriculum; give one of prag_asp.rl, such as LengthCurriculum()"
                )
        if self.space is None and self._curriculum_with("task_sampler"):
            raise QueryError("a curriculum of tasks needs a space; give a space, or ReverseCurriculum() alone")
        self._curriculum_with("subgoal_sampler")

    def domain(self, requested: Domain | str | None) -> Domain:
        """Return the domain of the tasks; `requested` is the domain of a single task, if it is given.

        Raises:
            QueryError: a domain is given with other tasks, or is invalid.
            DomainError: there is no domain with this name.
        """
        if requested is not None and (self.task is None or not isinstance(requested, Domain | str)):
            raise QueryError(f"domain {requested!r:.80}: give that of a task; a space and a dataset have their own")
        if self.space is not None:
            return self.space.domain
        if self.dataset is not None:
            return self.dataset.domain
        assert self.task is not None
        if isinstance(requested, Domain):
            return requested
        return load_domain(requested or self.task.domain, constants=dict(self.task.constants))

    def source(self, finder: WitnessFinder) -> TaskSource:
        """Return the source of tasks for a space or a dataset."""
        if self.dataset is not None:
            return DatasetSource(self.dataset)
        assert self.space is not None
        part = None if self.part is None else RankedPart(self.part, self.space)
        pool = TaskPool(self.space, part if self.split is None else self.split.of(self.space))
        curriculum = self._curriculum_with("task_sampler")
        sampler = cast(TaskCurriculum, curriculum).task_sampler(pool) if curriculum else DomainWeightsSampler(pool)
        return SpaceSource(pool, sampler, finder, trivial=self.trivial)

    @property
    def title(self) -> str:
        """A one-line description that distinguishes the checkpoints of environments, and is equal in every process."""
        tasks = self.space or (f"{self.dataset.count()} tasks of data" if self.dataset is not None else self.task)
        part = "".join(f", {part!r} of it" for part in (self.part, self.split) if part is not None)
        led = [repr(each) if is_dataclass(each) else type(each).__name__ for each in self._curricula]
        return f"{tasks}{part}, {' '.join(led) or 'no curriculum'}"

    @property
    def stages(self) -> StageCurriculum | None:
        """The curriculum of subgoals, if there is one."""
        return cast(StageCurriculum | None, self._curriculum_with("subgoal_sampler"))

    @property
    def _curricula(self) -> Sequence[Curriculum]:
        """All curricula."""
        curricula = self.curriculum
        if curricula is None:
            return ()
        return tuple(curricula) if isinstance(curricula, Sequence) else (curricula,)

    def _curriculum_with(self, method: str) -> Curriculum | None:
        """Return the one curriculum with a `task_sampler` or a `subgoal_sampler`, if there is one.

        Raises:
            QueryError: several curricula have the method.
        """
        curricula = [each for each in self._curricula if hasattr(each, method)]
        if len(curricula) > 1:
            raise QueryError(
                f"{len(curricula)} curricula of one kind: give one of tasks at most, and ReverseCurriculum()"
            )
        return curricula[0] if curricula else None
