"""Where an environment has its tasks from: what may be asked for, and the source that follows."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, is_dataclass
from typing import cast

from prag_asp.dataset.store.dataset import Dataset
from prag_asp.domain.load import Domain, load_domain
from prag_asp.errors import QueryError
from prag_asp.rl.curriculum.course import Plain, StageCurriculum, TaskCurriculum
from prag_asp.rl.curriculum.task_pool import Pool
from prag_asp.rl.tasks.task_sources import DatasetSource, Finder, Source, SpaceSource
from prag_asp.space.parts.ranked_tasks import RankedTasks
from prag_asp.space.task_space import TaskSpace
from prag_asp.task import Task

Curriculum = TaskCurriculum | StageCurriculum
Curricula = Curriculum | Sequence[Curriculum] | None


@dataclass(frozen=True)
class Origin:
    """What tasks come from: a space, or a part of one, a data set, or one task alone; and by which curricula.

    Raises:
        QueryError: it is none of them, or more than one, or a curriculum is none, or has nothing to choose from.
    """

    space: TaskSpace | None
    part: RankedTasks | None
    dataset: Dataset | None
    task: Task | None
    curriculum: Curricula

    def __post_init__(self) -> None:
        if sum(each is not None for each in (self.space, self.dataset, self.task)) != 1:
            raise QueryError("tasks come from one place: give a space, a data set, or a task")
        for given, kinds, told in (
            (self.space, TaskSpace, 'TaskSpace(load_domain("tabletop"), length=2)'),
            (self.dataset, Dataset, 'Dataset.open("DIR")'),
            (self.task, Task, "a Task, such as a space yields"),
            (self.part, RankedTasks, 'a part of the space, such as space.split({"train": 0.8, "test": 0.2})["train"]'),
        ):
            if given is not None and not isinstance(given, kinds):
                raise QueryError(f"{given!r:.80} is no place where tasks come from; give {told}")
        if self.part is not None and self.space is None:
            raise QueryError("a part is one of a space; give the space, too")
        if self.part is not None and isinstance(self.space, TaskSpace) and not self.space.same_tasks(self.part.space):
            raise QueryError(f"the part is one of {self.part.space!r}, and not of {self.space!r}; give a part of that")
        for each in self._curricula:
            if isinstance(each, type) or not (hasattr(each, "course") or hasattr(each, "walk")):
                raise QueryError(f"{each!r:.80} is no curriculum; give one of prag_asp.rl, such as Lengths()")
        if self.space is None and self._leading("course"):
            raise QueryError("a curriculum of tasks draws from a space; give that, or Backwards() alone")
        self._leading("walk")

    def domain(self, given: Domain | str | None) -> Domain:
        """Return the domain of the tasks; that of a single task may be `given`.

        Raises:
            QueryError: it is given for others, or is none.
            DomainError: there is no domain of the name.
        """
        if given is not None and (self.task is None or not isinstance(given, Domain | str)):
            raise QueryError(f"domain {given!r:.80}: give that of a task; a space and a data set have their own")
        if self.space is not None:
            return self.space.domain
        if self.dataset is not None:
            return self.dataset.domain
        assert self.task is not None
        if isinstance(given, Domain):
            return given
        return load_domain(given or self.task.domain, constants=dict(self.task.constants))

    def source(self, finder: Finder) -> Source:
        """Return what gives the tasks, where they are not one alone."""
        if self.dataset is not None:
            return DatasetSource(self.dataset)
        assert self.space is not None
        pool = Pool(self.space, None if self.part is None else self.part.ranks)
        leading = self._leading("course")
        course = cast(TaskCurriculum, leading).course(pool) if leading else Plain(pool)
        return SpaceSource(pool, course, finder)

    @property
    def title(self) -> str:
        """What it is in one line, the same in every process: by that, states of environments are told apart."""
        tasks = self.space or (f"{self.dataset.count()} tasks of data" if self.dataset is not None else self.task)
        part = "" if self.part is None else f", {self.part!r} of it"
        led = [repr(each) if is_dataclass(each) else type(each).__name__ for each in self._curricula]
        return f"{tasks}{part}, {' '.join(led) or 'no curriculum'}"

    @property
    def stages(self) -> StageCurriculum | None:
        """The curriculum of subgoals, if there is one."""
        return cast(StageCurriculum | None, self._leading("walk"))

    @property
    def _curricula(self) -> Sequence[Curriculum]:
        """All curricula."""
        given = self.curriculum
        if given is None:
            return ()
        return tuple(given) if isinstance(given, Sequence) else (given,)

    def _leading(self, what: str) -> Curriculum | None:
        """Return the one curriculum that has a `course` through tasks or a `walk` through subgoals, if there is one.

        Raises:
            QueryError: there are several.
        """
        found = [each for each in self._curricula if hasattr(each, what)]
        if len(found) > 1:
            raise QueryError(f"{len(found)} curricula of one kind: give one of tasks at most, and Backwards()")
        return found[0] if found else None
