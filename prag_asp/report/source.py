"""The contents of a report as plain values: tasks, outcomes of physics and evaluations."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING

from prag_asp.dataset.jsonl import Record, read_tasks
from prag_asp.dataset.store.draw_results import TRIVIAL
from prag_asp.dataset.store.manifest import DATASET
from prag_asp.dataset.task_origin import foreign, named_domain
from prag_asp.errors import QueryError
from prag_asp.missing import require_gymnasium
from prag_asp.processes.progress_events import counted, stage

if TYPE_CHECKING:
    from prag_asp.dataset.store.dataset import Dataset
    from prag_asp.dataset.store.entry import DatasetEntry
    from prag_asp.domain.load import Domain
    from prag_asp.evaluation.results import Results
    from prag_asp.space.task_space import TaskSpace
    from prag_asp.task import Task

EVALUATION = "evaluation.json"
"""The file that identifies a folder as an evaluation, even without Gymnasium, which is needed to read one."""


@dataclass(frozen=True)
class ReportedTask:
    """A task in a report: its number in the source (from 0), its part or "", its plan, its entities, its instruction.

    `classes` maps each entity to its class. `task` is None if only the plan is known, as for episodes.
    """

    number: int
    part: str
    plan: tuple[str, ...]
    entities: tuple[str, ...]
    classes: Mapping[str, str]
    instruction: str
    task: Task | None = field(default=None, repr=False, compare=False)


@dataclass(frozen=True)
class PhysicsOutcome:
    """The outcome of physics for a sampled task; `restarts` is the number of initial states that were tried.

    `status` is ``feasible``, ``not_found`` or ``infeasible``, or ``trivial`` for a task that was excluded before
    simulation.
    """

    part: str
    length: int
    status: str
    budget: str = ""
    restarts: int = 0
    reason: str = ""
    causes: Mapping[str, int] = field(default_factory=dict)


@dataclass(frozen=True)
class ReportSource:
    """The contents of a report: tasks, the space from which they come, outcomes of physics, evaluations of policies.

    `space` is None if the domain is not known. `sizes` maps each part with a known size to the number of its tasks in
    the space.
    """

    title: str
    tasks: tuple[ReportedTask, ...]
    space: TaskSpace | None = None
    outcomes: tuple[PhysicsOutcome, ...] = ()
    sizes: Mapping[str, int] = field(default_factory=dict)
    evaluations: tuple[Results, ...] = ()
    dataset: Dataset | None = field(default=None, repr=False)
    notes: tuple[str, ...] = ()

    @cached_property
    def lengths(self) -> tuple[int, ...]:
        """All lengths of the tasks and of the space."""
        given = {len(each.plan) for each in self.tasks} | set(self.space.lengths if self.space is not None else ())
        return tuple(sorted(given))

    @cached_property
    def parts(self) -> tuple[str, ...]:
        """The parts to which the tasks belong, in order of first appearance."""
        return tuple(dict.fromkeys(each.part for each in self.tasks))


def read_source(*sources: str | Path, domain: Domain | None = None, trust: bool = False) -> ReportSource:
    """Read a dataset or a file of tasks, and any number of evaluations, for a report.

    `domain` is the domain of a file of tasks or of evaluations; by default, it is the one that the file of tasks names.

    Raises:
        QueryError: a source is none of these, is damaged or has no task, or two sources have tasks.
        DomainError: the domain of the tasks cannot be loaded.
        DatasetsMissingError: pyarrow is needed and not installed.
    """
    kinds = [(Path(each), _kind(Path(each))) for each in sources]
    with_tasks = [(path, kind) for path, kind in kinds if kind != "evaluation"]
    if len(with_tasks) > 1:
        (one, _), (other, _), *_ = with_tasks
        raise QueryError(f"{one} and {other} both have tasks; a report is on one dataset or file, and evaluations")
    evaluations = tuple(_evaluation(path) for path, kind in kinds if kind == "evaluation")
    if not kinds:
        raise QueryError("a report needs a dataset, a file of tasks, or an evaluation")
    if not with_tasks:
        return _of_evaluations(evaluations, domain)
    ((path, kind),) = with_tasks
    found = _of_dataset(path, trust) if kind == "dataset" else _of_file(path, domain, trust)
    if not found.tasks and not found.outcomes:
        raise QueryError(f"{path}: has no task; a report needs at least one")
    return replace(found, evaluations=evaluations)


def _kind(path: Path) -> str:
    """Return what a path is: ``dataset``, ``evaluation`` or ``tasks``.

    Raises:
        QueryError: the path does not exist, or is a folder with neither a dataset nor an evaluation.
    """
    if path.is_dir():
        if (path / DATASET.name).exists():
            return "dataset"
        if (path / EVALUATION).exists():
            return "evaluation"
        raise QueryError(
            f"{path}: is neither a dataset nor an evaluation, because it has no {DATASET.name} and no {EVALUATION}; "
            "give the folder of prag-asp generate -o or evaluate -o"
        )
    if not path.exists():
        raise QueryError(f"{path}: no such file or folder; give a dataset, a file of JSON lines, or an evaluation")
    return "tasks"


def _evaluation(path: Path) -> Results:
    require_gymnasium()
    from prag_asp.evaluation.results import Results  # noqa: PLC0415 - needs Gymnasium

    return Results.open(path)


def _of_dataset(path: Path, trust: bool) -> ReportSource:
    from prag_asp.dataset.store.dataset import Dataset  # noqa: PLC0415 - needs pyarrow
    from prag_asp.integers import number_of  # noqa: PLC0415
    from prag_asp.space.task_space import TaskSpace  # noqa: PLC0415

    stage("reading the dataset")
    dataset = Dataset.open(path, trust=trust)
    manifest = dataset.manifest
    space = TaskSpace(dataset.domain, manifest.lengths).where(*manifest.where)
    tasks: list[ReportedTask] = []
    outcomes: list[PhysicsOutcome] = []
    for entry in dataset.entries():
        tasks.append(_of_entry(len(tasks), entry))
        outcomes += [_outcome(entry)] if entry.verdict is not None else []
    if outcomes or manifest.spec.budget is not None:
        outcomes += [_outcome(entry) for entry in dataset.rejected()]
    notes = ("The tasks are sampled by weight, so their frequencies differ from uniform ones.",)
    return ReportSource(
        f"{dataset.domain.settings.title or dataset.domain.label}: {path.name}",
        tuple(tasks),
        space,
        tuple(outcomes),
        {part.name: number_of(part.size) for part in manifest.parts},
        dataset=dataset,
        notes=notes if manifest.spec.weights else (),
    )


def _of_entry(number: int, entry: DatasetEntry) -> ReportedTask:
    return _reported(number, entry.part, entry.task, entry.instruction.get("default", ""))


def _reported(number: int, part: str, task: Task, instruction: str) -> ReportedTask:
    named = {argument: None for action in task.actions for argument in action.arguments if argument in task.entities}
    return ReportedTask(number, part, tuple(map(str, task.actions)), tuple(named), task.entities, instruction, task)


def _outcome(entry: DatasetEntry) -> PhysicsOutcome:
    verdict, length = entry.verdict, len(entry.task)
    if verdict is None:
        return PhysicsOutcome(entry.part, length, "trivial", reason=TRIVIAL)
    return PhysicsOutcome(
        entry.part, length, verdict.status, str(verdict.budget), verdict.restarts, verdict.reason, verdict.causes
    )


def _of_file(path: Path, domain: Domain | None, trust: bool) -> ReportSource:
    from prag_asp.dataset.language import instruction_writer_of  # noqa: PLC0415
    from prag_asp.domain.load import load_domain  # noqa: PLC0415
    from prag_asp.space.task_space import TaskSpace  # noqa: PLC0415

    stage("reading the tasks")
    records = list(read_tasks(path))
    if not records:
        raise QueryError(f"{path}: has no task; write some with prag-asp sample --format jsonl -o {path}")
    first = records[0]
    if domain is None:
        name = named_domain(first.task.domain, first.place, path.parent)
        domain = load_domain(name, constants=dict(first.task.constants), trust=trust)
    for record in records:
        problem = foreign(record, domain)
        if problem:
            raise QueryError(f"{record.place}: {problem}; a report is on tasks of one domain")
    stage("writing instructions")
    writer = instruction_writer_of(domain)
    tasks = tuple(
        _reported(number, "", record.task, writer.instructions(record.task).default)
        for number, record in enumerate(counted(records, "tasks"))
    )
    lengths = sorted({len(each.plan) for each in tasks})
    outcomes = tuple(_outcome_of_record(record) for record in records if record.verdict is not None)
    return ReportSource(
        f"{domain.settings.title or domain.label}: {path.name}", tasks, TaskSpace(domain, lengths), outcomes
    )


def _outcome_of_record(record: Record) -> PhysicsOutcome:
    """Return the outcome of physics in the verdict of a record.

    Raises:
        QueryError: the verdict is malformed; the message gives the line and the field.
    """
    from prag_asp.physics.verdict import Verdict  # noqa: PLC0415

    try:
        verdict = Verdict.from_json({**(record.verdict or {}), "witness": None})
    except (QueryError, KeyError) as error:
        raise QueryError(f"{record.place}: {error}; sample the task again, or set its verdict to null") from None
    return PhysicsOutcome(
        "", len(record.task), verdict.status, str(verdict.budget), verdict.restarts, verdict.reason, verdict.causes
    )


def _of_evaluations(evaluations: Sequence[Results], domain: Domain | None) -> ReportSource:
    from prag_asp.space.task_space import TaskSpace  # noqa: PLC0415

    tasks = tuple(_tasks_of_episodes(evaluations))
    space = None if domain is None or not tasks else TaskSpace(domain, sorted({len(each.plan) for each in tasks}))
    names = ", ".join(dict.fromkeys(each.record.domain for each in evaluations))
    if not tasks:
        raise QueryError("the evaluations have no episode; evaluate on at least one scenario")
    return ReportSource(
        f"{names}: {', '.join(each.record.policy for each in evaluations)}", tasks, space, (), {}, tuple(evaluations)
    )


def _tasks_of_episodes(evaluations: Iterable[Results]) -> Iterator[ReportedTask]:
    """Yield each task of the episodes once."""
    from prag_asp.atom import parse_atom  # noqa: PLC0415

    seen: dict[tuple[str, tuple[str, ...]], None] = {}
    for results in evaluations:
        for episode in results.episodes:
            key = (episode.part, tuple(episode.task))
            if key not in seen:
                seen[key] = None
                arguments = [argument for action in episode.task for argument in parse_atom(action).arguments]
                named = tuple(dict.fromkeys(arguments))
                yield ReportedTask(len(seen) - 1, episode.part, key[1], named, {}, episode.instruction)
