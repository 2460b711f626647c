"""Revalidate the tasks in a file: check that the plans are valid and physically feasible."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Generator, Iterable, Iterator, Mapping, Sequence
from contextlib import closing
from dataclasses import dataclass, field
from itertools import chain, groupby
from pathlib import Path
from typing import TYPE_CHECKING, Any

from prag_asp.batches import growing_batches
from prag_asp.dataset.dataset_spec import budget_of, require_demonstrated
from prag_asp.dataset.episode_files import write_episode
from prag_asp.dataset.jsonl import Record, read_tasks
from prag_asp.dataset.scenes import scene_of
from prag_asp.dataset.task_origin import errors_with_place, foreign, index_of, named_domain, read_witness
from prag_asp.domain.load import load_domain
from prag_asp.errors import QueryError
from prag_asp.output import make_folder
from prag_asp.physics import Budget, Demonstration, Staging, Verdict, validate_numbered
from prag_asp.physics.validation import check_numbered
from prag_asp.space.task_space import TaskSpace

if TYPE_CHECKING:
    from prag_asp.domain.load import Domain
    from prag_asp.physics import Witness
    from prag_asp.scene.scene import Scene
    from prag_asp.task import Task

BATCH = 128
"""The maximum number of tasks that are read ahead; their states are computed together."""

CheckedRecord = tuple[Record, str]
"""A record, and the fault of its task, or "" if the task is valid."""


@dataclass(frozen=True)
class Outcome:
    """The outcome of checking a task: the status, the reason and the causes of failed attempts.

    `status` is feasible, not_found, infeasible, invalid or witness_fails. `detail` names the fact or the bodies
    responsible, if they are known.
    """

    record: Record
    status: str
    reason: str = ""
    causes: Mapping[str, int] = field(default_factory=dict)
    demonstration: Demonstration | None = None
    detail: str = ""


def recheck(
    tasks: str | Path | Iterable[Record],
    domain: Domain | None = None,
    *,
    where: Sequence[str] = (),
    seed: int = 0,
    workers: int = 1,
    budget: Budget | None = None,
    demonstrate: str | Path | None = None,
    staging: Staging | None = None,
    witness_only: bool = False,
    load: Callable[[Record, Path], Domain] | None = None,
    folder: Path = Path(),
) -> Generator[Outcome, None, None]:
    """Check that the plan of each task in a file, or in records, is valid and feasible, and yield the outcomes.

    Physics searches for new witnesses, with an outcome that does not depend on the position of the task; with
    `witness_only`, physics checks the witnesses in the file. Without a `domain`, each record names its own domain: a
    shipped domain, or a folder in the current folder or next to the file (for records, in `folder`); `load` replaces
    the default loader. Tasks have to satisfy the conditions `where`. With `demonstrate`, the robot executes each task,
    and recordings are written into that folder, with the cameras and variations of `staging`. Records are read a little
    ahead.

    Raises:
        QueryError: a line of the file is not a task, or its domain is not found; the message gives the line.
        SceneError: a domain has no scene.
        OutputError: a recording cannot be written.
    """
    if isinstance(tasks, (str, Path)):
        records, folder = read_tasks(tasks), Path(tasks).parent
    else:
        records = iter(tasks)
    if staging is not None:
        require_demonstrated(staging, demonstrate)
    number, episodes = 0, None if demonstrate is None else make_folder(demonstrate)
    options = {"seed": seed, "workers": workers, "budget": budget_of(budget, demonstrate), "staging": staging}
    load = load or _load
    for _, several in groupby(records, key=lambda record: (record.task.domain, record.task.constants)):
        group = iter(several)
        first = next(group)
        own = load(first, folder) if domain is None else domain
        checked = _with_faults(chain([first], group), TaskSpace(own, 0).where(*where))
        scene = scene_of(own)
        if staging is not None:
            staging.cameras_of(scene)
        for outcome in _outcomes(checked, scene, witness_only, options):
            number += 1
            write_episode(episodes, number, outcome.demonstration)
            yield outcome


def _load(record: Record, folder: Path) -> Domain:
    """Return the domain that a record names."""
    task = record.task
    return load_domain(named_domain(task.domain, record.place, folder), constants=task.constants)


def _with_faults(records: Iterable[Record], space: TaskSpace) -> Iterator[CheckedRecord]:
    """Yield records, each with the fault of its task."""
    for batch in growing_batches(records, BATCH):
        valid = [record.task in space.at(len(record.task)) for record in batch]
        plans = (tuple(map(str, r.task.actions)) for r, is_plan in zip(batch, valid, strict=True) if is_plan)
        expected = space.tasks_of_plans(plans)
        for record, is_plan in zip(batch, valid, strict=True):
            other = foreign(record, space.domain)
            fault = f"it is not a plan of {space.domain.name}{f'; {other}' if other else ''}"
            yield record, _fault(record.task, next(expected)) if is_plan else fault


def _fault(task: Task, expected: Task) -> str:
    """Return the fault of a task, or "" if the task equals the expected one."""
    parts = ("entities", "initial", "states", "subgoals", "goal")
    wrong = [
        part.replace("initial", "initial state") for part in parts if getattr(task, part) != getattr(expected, part)
    ]
    verb = "is" if wrong in (["initial state"], ["goal"]) else "are"
    return f"its {', '.join(wrong)} {verb} not what its actions make" if wrong else ""


def _outcomes(
    records: Iterator[CheckedRecord], scene: Scene, witness_only: bool, options: Mapping[str, Any]
) -> Iterator[Outcome]:
    """Yield the outcome of each task, in order, after a search for a new witness or a check of the given one."""
    waiting: deque[tuple[Record, Outcome | None]] = deque()

    def jobs() -> Iterator[tuple[int, Any]]:
        for record, fault in records:
            found: Witness | Outcome | None = None
            if fault:
                found = Outcome(record, "invalid", fault)
            elif witness_only:
                found = _witness_or_outcome(record, scene)
            waiting.append((record, found if isinstance(found, Outcome) else None))
            if not isinstance(found, Outcome):
                yield index_of(record), record.task if found is None else (record.task, found)

    run = check_numbered if witness_only else validate_numbered
    with closing(run(jobs(), scene, **options)) as results:
        for result in results:
            yield from _leading_outcomes(waiting)
            record, _ = waiting.popleft()
            if isinstance(result, Verdict):
                yield Outcome(record, result.status, result.reason, result.causes, result.demonstration, result.detail)
            elif result.fault is None:
                yield Outcome(record, "feasible", demonstration=result.demonstration)
            else:
                yield Outcome(record, "witness_fails", result.fault.text or result.fault.cause)
    yield from _leading_outcomes(waiting)


def _witness_or_outcome(record: Record, scene: Scene) -> Witness | Outcome:
    """Return the witness of a record, or its outcome if there is no witness to check."""
    if record.witness is None:
        return Outcome(record, "not_found", "the file has no witness for it")
    try:
        with errors_with_place(record):
            return read_witness(record, scene)
    except QueryError as error:
        return Outcome(record, "witness_fails", str(error))


def _leading_outcomes(waiting: deque[tuple[Record, Outcome | None]]) -> Iterator[Outcome]:
    """Yield the outcomes that precede the first record still to be checked."""
    while waiting and (outcome := waiting[0][1]) is not None:
        waiting.popleft()
        yield outcome
