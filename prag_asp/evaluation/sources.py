"""The scenarios to evaluate: from a dataset or a suite, from ids, or freshly sampled from a task space."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from itertools import count as numbers_from
from pathlib import Path
from typing import TYPE_CHECKING, Protocol

from prag_asp.dataset.scenario import Scenario, SearchStart
from prag_asp.dataset.scenarios import Scenarios
from prag_asp.dataset.store.dataset import Dataset
from prag_asp.dataset.strata.stratified_sampling import allocated
from prag_asp.dataset.suites.suite_manifest import SUITE, is_suite
from prag_asp.errors import QueryError
from prag_asp.evaluation.episode import EpisodeJob, JobGroup
from prag_asp.output.digests import digest
from prag_asp.space.without_replacement import with_tasks
from prag_asp.wording import unknown

if TYPE_CHECKING:
    from prag_asp.dataset.strata.stratum_figures import StratumFeed, StratumFigures
    from prag_asp.domain.load import Domain
    from prag_asp.physics import Budget
    from prag_asp.space.strata.allocation import Stratification
    from prag_asp.space.strata.stratum import Stratum
    from prag_asp.space.task_space import TaskSpace
    from prag_asp.task import Task


class ScenarioSource(Protocol):
    """Scenarios in a fixed order."""

    @property
    def domain(self) -> Domain:
        """The domain of all scenarios."""
        ...

    @property
    def lengths(self) -> tuple[int, ...]:
        """The lengths of the tasks."""
        ...

    @property
    def title(self) -> str:
        """A line that names the source of the scenarios."""
        ...

    @property
    def identity(self) -> str:
        """A string that two sources share only if they have the same scenarios in the same order."""
        ...

    @property
    def count(self) -> int:
        """The number of scenarios to evaluate."""
        ...

    def groups(self) -> list[JobGroup]:
        """Return the jobs, by stratum if there are strata; jobs without a witness are dropped later."""
        ...

    def strata(self, feed: StratumFeed[EpisodeJob]) -> list[StratumFigures]:
        """Return the figures of the strata after an evaluation, or nothing if there are no strata."""
        ...


@dataclass(frozen=True)
class FreshScenarios:
    """Distinct feasible tasks that satisfy `keep`, sampled uniformly without replacement from a space.

    Tasks whose final state equals the initial state are excluded unless `trivial` is true. With a `stratification`,
    tasks are sampled from each stratum.
    """

    space: TaskSpace
    count: int
    seed: int = 0
    budget: Budget | None = None
    keep: Callable[[Task], bool] | None = None
    excluded: str = ""
    trivial: bool = False
    stratification: Stratification | None = None

    @property
    def domain(self) -> Domain:
        """The domain of all scenarios."""
        return self.space.domain

    @property
    def lengths(self) -> tuple[int, ...]:
        """The lengths of the tasks."""
        return tuple(self.space.lengths)

    @property
    def title(self) -> str:
        """A line that names the source of the scenarios."""
        strata = "" if self.stratification is None else f" by {self.stratification.by} ({self.stratification})"
        return f"{self.space.title}, sampled{strata} with seed {self.seed}"

    @property
    def identity(self) -> str:
        """A digest of the space and the options for sampling."""
        scenarios = Scenarios(self.space.domain, self.space)
        return digest([scenarios.digest, self.title, self.count, str(self.budget), self.excluded, self.trivial])

    def groups(self) -> list[JobGroup]:
        """Return the sampled tasks, feasible or not, by stratum if there are strata.

        Raises:
            QueryError: the space is empty; or there are strata, and a stratum has too few tasks or `keep` is given.
        """
        if self.stratification is None:
            tasks = filter(self.keep, self.space.stream(seed=self.seed, weights={}, distinct=True))
            return [JobGroup("", self.space.count(), self.count, self._jobs("", tasks))]
        if self.keep is not None:
            raise QueryError("strata are sampled as a whole, so that no task can be left out of them")
        return [
            JobGroup(each.name, each.size, quota, self._jobs(each.name, self._tasks(each)))
            for each, quota in allocated(self.space, self.count, self.stratification, self.seed)
        ]

    def strata(self, feed: StratumFeed[EpisodeJob]) -> list[StratumFigures]:
        """Return the figures of the strata after an evaluation, or nothing if there are no strata."""
        return [] if self.stratification is None else feed.figures()

    def _tasks(self, stratum: Stratum) -> Iterator[Task]:
        """Yield the tasks of a stratum in the order of sampling without replacement."""
        return (task for _, task in with_tasks(self.space, stratum.order.pick(numbers_from(0))))

    def _jobs(self, name: str, tasks: Iterator[Task]) -> Iterator[tuple[int, EpisodeJob]]:
        """Yield the job for each task, with the task's index in the sample; trivial tasks are left out."""
        scenarios = Scenarios(self.space.domain, self.space)
        for index, task in enumerate(tasks):
            if self.trivial or not task.trivial:
                start = SearchStart.of(self.seed, index, self.budget)
                yield index, EpisodeJob(name, scenarios.of(self.space, task, start))


@dataclass(frozen=True)
class NamedScenarios:
    """The scenarios with given ids, in the order of the ids."""

    domain: Domain
    scenarios: Sequence[Scenario]

    def __post_init__(self) -> None:
        here = Scenarios(self.domain)
        for each in self.scenarios:
            here.check(each)
            if each.start is None:
                raise QueryError(f"scenario {each}: has no initial state; give one that physics found feasible")
        if not self.scenarios:
            raise QueryError("there are no scenarios to evaluate; give ids")

    @property
    def lengths(self) -> tuple[int, ...]:
        """The lengths of the tasks."""
        return tuple(sorted({each.length for each in self.scenarios}))

    @property
    def title(self) -> str:
        """A line that names the source of the scenarios."""
        return f"{len(self.scenarios)} scenarios of {self.domain.label}"

    @property
    def identity(self) -> str:
        """A digest of the ids."""
        return digest([str(each) for each in self.scenarios])

    @property
    def count(self) -> int:
        """The number of scenarios."""
        return len(self.scenarios)

    def groups(self) -> list[JobGroup]:
        """Return a job for each id."""
        jobs = enumerate(EpisodeJob("", each) for each in self.scenarios)
        return [JobGroup("", self.count, self.count, jobs)]

    def strata(self, feed: StratumFeed[EpisodeJob]) -> list[StratumFigures]:
        """Return no strata, because ids do not show how they were sampled."""
        return []


@dataclass(frozen=True)
class StoredScenarios:
    """The tasks in parts of datasets with their stored initial states, at most `most` tasks from each part."""

    parts: Sequence[tuple[str, Dataset]]
    most: int | None = None

    @classmethod
    def open(
        cls, folder: str | Path, parts: Sequence[str] = (), most: int | None = None, *, trust: bool = False
    ) -> StoredScenarios:
        """Open all or some of the parts of a dataset or a suite.

        Raises:
            QueryError: there is no dataset, no such part, or a part has no initial states.
        """
        path = Path(folder)
        suite = SUITE.read(path) if is_suite(path) else None
        if suite is not None:
            found = {part.name: Dataset.open(path / part.name, trust=trust) for part in suite.parts}
        else:
            dataset = Dataset.open(path, trust=trust)
            found = {name: dataset.part(name) for name in dataset.parts}
        for name in parts:
            if name not in found:
                raise QueryError(f"{path}: {unknown(name, found, 'part')}")
        chosen = [(name, found[name]) for name in (parts or found)]
        for name, each in chosen:
            if each.manifest.spec.budget is None:
                raise QueryError(f"{path}: the tasks of {name} have no initial states; generate it with physics")
        return cls(chosen, most)

    @property
    def domain(self) -> Domain:
        """The domain of all parts."""
        return self.parts[0][1].domain

    @property
    def lengths(self) -> tuple[int, ...]:
        """The lengths of the tasks."""
        return tuple(sorted({length for _, part in self.parts for length in part.manifest.lengths}))

    @property
    def title(self) -> str:
        """A line that names the source of the scenarios."""
        return f"{self.parts[0][1].folder}: {', '.join(name for name, _ in self.parts)}"

    @property
    def identity(self) -> str:
        """A digest of the files of the parts and of the maximum number of tasks."""
        files = [
            [
                name,
                [file.sha256 for part in each.manifest.parts for shard in part.shards for file in shard.files.values()],
            ]
            for name, each in self.parts
        ]
        return digest([files, self.most])

    @property
    def count(self) -> int:
        """The number of initial states."""
        return sum(1 for _ in self._starts())

    def groups(self) -> list[JobGroup]:
        """Return a job for each initial state of each task."""
        return [JobGroup("", self.count, self.count, enumerate(self.jobs()))]

    def strata(self, feed: StratumFeed[EpisodeJob]) -> list[StratumFigures]:
        """Return the strata of the dataset, or nothing if its parts are not strata or not all of them are evaluated."""
        dataset = self.parts[0][1]
        strata = dataset.manifest.strata
        whole = {name for name, each in self.parts if each.folder == dataset.folder}
        return strata if whole >= {each.name for each in strata} else []

    def jobs(self) -> Iterator[EpisodeJob]:
        """Yield a job for each initial state of each task."""
        for name, dataset, number, start in self._starts():
            given = dataset.task(number), dataset.witness(number, start)
            yield EpisodeJob(name, dataset.scenario(number, start), given, dataset.entry(number).texts)

    def _starts(self) -> Iterator[tuple[str, Dataset, int, int]]:
        """Yield the part, the dataset, the number of a task, and the number of one of its initial states."""
        for name, dataset in self.parts:
            number_of_tasks = dataset.count() if self.most is None else min(self.most, dataset.count())
            for number in range(number_of_tasks):
                for start in range(dataset.entry(number).starts):
                    yield name, dataset, number, start
